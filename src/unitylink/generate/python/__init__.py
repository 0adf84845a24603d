# SPDX-License-Identifier: BSD-3-Clause
"""Python proxies from a spec."""

from __future__ import annotations

from pathlib import Path

from ..spec_plan import SpecPlan
from ..templates import environment
from .planner import plan_module

__all__ = ["plan_module", "python_files", "python_text"]

_HERE = Path(__file__).parent


def python_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of the module with one class per constructor of the spec."""
    return {plan.part(plan_module).file: plan.part(python_text)}


def python_text(plan: SpecPlan) -> str:
    """Return the text of the module, which the packages of ROS hold too."""
    return environment(_HERE).get_template("proxies.py.jinja").render(module=plan.part(plan_module))
