# SPDX-License-Identifier: BSD-3-Clause
"""A header of typed values in C11, with the same names as the objects of C++."""

from __future__ import annotations

from pathlib import Path

from ..objects import C, ObjectsPlan, Style, members, plan_objects, snake
from ..spec_plan import SpecPlan
from ..templates import environment
from . import functions

__all__ = ["c_files", "plan_c"]

_HERE = Path(__file__).parent
_RESERVED = frozenset({"part", "robot"})  # members that each struct of a part has


def c_files(plan: SpecPlan) -> dict[str, str]:
    """Return {file name: text} of the header with a struct for each constructor of the spec."""
    planned = plan.part(plan_c)
    guard = f"UNITYLINK_GENERATED_{planned.name.upper()}_H"
    template = environment(_HERE).get_template("header.h.jinja")
    return {f"{planned.name}.h": template.render(plan=planned, c=functions, guard=guard)}


def plan_c(plan: SpecPlan) -> ObjectsPlan:
    """Plan the header of a spec."""
    spec = plan.spec
    (name,) = members([snake(spec.name) or "robot"], {"ul", "std", "unitylink"}).values()
    return plan_objects(spec, Style(name, plain=True, reserved=_RESERVED, dialect=C))
