# SPDX-License-Identifier: BSD-3-Clause
"""A header of typed objects in C++20."""

from __future__ import annotations

from pathlib import Path

from ..objects import ObjectsPlan, Style, members, plan_objects, snake
from ..spec_plan import SpecPlan
from ..templates import environment
from . import class_members

__all__ = ["cpp_files"]

_HERE = Path(__file__).parent
# Names of the base classes, and of what the generated classes have themselves.
_RESERVED = frozenset(
    {
        "Checked",
        "Cycle",
        "Link",
        "Part",
        "Robot",
        "Self",
        "Stream",
        "Visit",
        "checked",
        "cycle",
        "decode",
        "encode",
        "link",
        "objects",
        "on",
        "snapshot",
        "spec_hash",
        "unverified",
        "write",
    }
)


def cpp_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of the header with a class for each constructor of the spec."""
    planned = plan.part(_planned)
    template = environment(_HERE).get_template("header.hpp.jinja")
    return {f"{planned.name}.hpp": template.render(plan=planned, cpp=class_members)}


def _planned(plan: SpecPlan) -> ObjectsPlan:
    spec = plan.spec
    (name,) = members([snake(spec.name) or "robot"], {"std", "unitylink"}).values()
    return plan_objects(spec, Style(name, plain=False, reserved=_RESERVED))
