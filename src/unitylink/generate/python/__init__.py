# SPDX-License-Identifier: BSD-3-Clause
"""Python proxies from a spec."""

from __future__ import annotations

from pathlib import Path

from unitylink.spec.model import Spec

from ..kept import kept
from ..templates import environment
from .planner import plan

__all__ = ["generate_python"]

_HERE = Path(__file__).parent


def generate_python(spec: Spec) -> dict[str, str]:
    """Return {file name: text} of the module with one class per constructor of the spec."""
    return {plan(spec).file: _text(spec)}


@kept
def _text(spec: Spec) -> str:
    return environment(_HERE).get_template("proxies.py.jinja").render(module=plan(spec))
