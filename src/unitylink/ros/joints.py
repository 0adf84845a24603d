# SPDX-License-Identifier: BSD-3-Clause
"""Which values of an instance are joints: by `@ros(type="JointState", ..)`, or by units and names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from unitylink.spec.model import Element, Instance

from .names import joint_name
from .notes import Note

# unit -> (dimension, factor to the unit of REP 103)
_UNITS = {
    **dict.fromkeys(("rad",), ("position", 1.0)),
    **dict.fromkeys(("deg", "°"), ("position", math.pi / 180)),
    **dict.fromkeys(("m",), ("position", 1.0)),
    **dict.fromkeys(("mm",), ("position", 1e-3)),
    **dict.fromkeys(("rad/s",), ("velocity", 1.0)),
    **dict.fromkeys(("deg/s", "°/s"), ("velocity", math.pi / 180)),
    **dict.fromkeys(("rpm",), ("velocity", math.pi / 30)),
    **dict.fromkeys(("m/s",), ("velocity", 1.0)),
    **dict.fromkeys(("mm/s",), ("velocity", 1e-3)),
    **dict.fromkeys(("N·m", "Nm", "N*m", "N"), ("effort", 1.0)),
}
PARTS = ("position", "velocity", "effort")


@dataclass(frozen=True)
class JointValues:
    """A joint with its measured values and its set-points, by part ("position", ..)."""

    name: str
    measured: dict[str, Element] = field(default_factory=dict)
    set: dict[str, Element] = field(default_factory=dict)


def factor(element: Element) -> float:
    """Return the factor from a value to rad, m, rad/s, m/s, N·m or N. Return 1 for an unknown unit."""
    return _UNITS.get(element.unit, ("", 1.0))[1]


def is_angle(element: Element) -> bool:
    """Is it an angle, in rad or deg?"""
    return element.unit in ("rad", "deg", "°")


def joints_of(instance: Instance, note: Note) -> list[JointValues]:
    """Return the joints among the values that belong directly to an instance.

    Without annotations, a published READ in rad, deg, m or mm is a joint's position if a WRITE of the same
    dimension sets it. This is the only one of each, or one whose name begins with the READ's (`hip`,
    `hip_sp`). Of arrays, the values with the same index belong together: `position[1]`, `target[1]`.
    """
    if note.text("type") == "JointState":
        return [_told(instance, note)]
    measured = [e for e in instance.elements if e.publish is not None and e.type.numeric]
    settable = [e for e in instance.elements if e.access in ("WRITE", "READWRITE") and e.type.numeric]
    found = []
    for index in dict.fromkeys(_index(element) for element in measured):
        mine = [element for element in measured if _index(element) == index]
        set_by = [element for element in settable if _index(element) == index]
        found += _by_units(instance, note, index, mine, set_by)
    return found


def _by_units(
    instance: Instance, note: Note, index: str, measured: Sequence[Element], settable: Sequence[Element]
) -> list[JointValues]:
    """Return the joints among values with the same index."""
    positions = [e for e in measured if _dimension(e) == "position"]
    found = []
    for position in positions:
        target = _partner(position, settable, "position", len(positions))
        if target is None or target is position:
            continue
        own = len(positions) == 1 and instance.path
        path = instance.path + index if own else position.path
        name = f"{note.text('joint')}{joint_name(index)}" if note.text("joint") else joint_name(path)
        joint = JointValues(name, {"position": position}, {"position": target})
        for part in ("velocity", "effort"):
            for side, elements in ((joint.measured, measured), (joint.set, settable)):
                other = _partner(position, elements, part, len(positions))
                if other is not None:
                    side[part] = other
        found.append(joint)
    return found


def _index(element: Element) -> str:
    """Return "[1]" of `position[1]`, and "" of a value that is not in an array."""
    return element.name.removeprefix(element.array) if element.array else ""


def _told(instance: Instance, note: Note) -> JointValues:
    elements = {element.name: element for element in instance.elements}
    joint = JointValues(note.text("joint") or joint_name(instance.path or instance.name))
    for suffix, side in (("", joint.measured), ("_sp", joint.set)):
        usable = [e for e in instance.elements if (e.publish is not None if not suffix else e.writable)]
        for part in PARTS:
            name = note.text(part + suffix)
            if name:
                if name not in elements or elements[name] not in usable:
                    what = "published value" if not suffix else "WRITE"
                    choices = ", ".join(e.name for e in usable) or "none"
                    raise note.wrong(f"{part}{suffix}={name!r} is no {what}; there are: {choices}")
                side[part] = elements[name]
            else:
                # a preset of what is measured is no set-point
                fitting = [e for e in usable if _dimension(e) == part and e not in joint.measured.values()]
                if len(fitting) == 1:
                    side[part] = fitting[0]
    if not joint.measured and not joint.set:
        raise note.wrong(
            'no value has a unit of a joint; name them: position="..", velocity="..", position_sp=".."'
        )
    return joint


def _dimension(element: Element) -> str:
    return _UNITS.get(element.unit, ("", 1.0))[0]


def _partner(position: Element, among: Sequence[Element], part: str, joints: int) -> Element | None:
    fitting: Iterable[Element] = [e for e in among if _dimension(e) == part]
    named = [e for e in fitting if e.name.startswith(f"{position.name}_")]
    if len(named) == 1:
        return named[0]
    others = list(fitting)
    return others[0] if joints == 1 and len(others) == 1 else None
