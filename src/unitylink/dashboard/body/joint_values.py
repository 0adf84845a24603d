# SPDX-License-Identifier: BSD-3-Clause
"""Which value of the spec moves which joint of the body: by name and unit, or as somebody says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches

from unitylink.errors import UnityLinkError, shown
from unitylink.interface.joint_names import names_of, plain
from unitylink.spec.model import Element, Instance
from unitylink.spec.units import unit

from .body import Body, Joint, Moved

RAD, METRE = "rad", "m"


def with_values(body: Body, root: Instance, given: Mapping[str, str] | None = None) -> Body:
    """Return the body with the values that move its joints. Its notes name joints that nothing moves.

    `given` says by the name of a joint the path of an item. Raises UnityLinkError if one of them is not
    there, or if its unit does not fit. The others are found by name. The joint `shoulder` moves with an angle
    that has this name, or whose part has it. So does `shoulder_joint`. A published value goes before one that
    is read. A measured value goes before a set-point.
    """
    elements = list(root.walk())
    paths = {element.path: number for number, element in enumerate(elements)}
    joints = {joint.name: joint for joint in body.joints if joint.moves and joint.mimic is None}
    moved, notes = {}, list(body.notes)
    for name, path in (given or {}).items():
        joint = joints.get(name)
        if joint is None:
            near = ", ".join(get_close_matches(name, joints, 3, 0.3) or list(joints)[:3]) or "none"
            raise UnityLinkError(f"--joint {name}={path}: no joint {shown(name)} moves; there are {near}")
        if path not in paths:
            near = ", ".join(get_close_matches(path, paths, 3, 0.3)) or "none like it"
            raise UnityLinkError(
                f"--joint {name}={path}: the robot has no item {shown(path)}; nearest: {near}"
            )
        factor = _factor(elements[paths[path]], joint)
        if factor is None:
            has = elements[paths[path]].unit or "no unit"
            raise UnityLinkError(f"--joint {name}={path}: {path} has {has}, but the joint is {joint.kind}")
        moved[name] = Moved(paths[path], path, factor)
    names = names_of(root)
    for name, joint in joints.items():
        if name in moved:
            continue
        fitting = [one for one in elements if _factor(one, joint) is not None and one.readable | one.writable]
        own = [one for one in fitting if plain(name) in names[one.path]]
        best = [one for one in own if _rank(one) == min(map(_rank, own))] if own else []
        if len(best) == 1:
            factor = _factor(best[0], joint)
            assert factor is not None
            moved[name] = Moved(paths[best[0].path], best[0].path, factor)
        elif best:
            choices = ", ".join(one.path for one in best[:4])
            notes.append(f"joint {name} could move with {choices}; choose one with --joint {name}=ITEM")
        else:
            notes.append(f"no value moves joint {name}; {_nearest(name, fitting, names)}")
    return replace(body, moved=moved, notes=tuple(notes))


def _nearest(name: str, fitting: Sequence[Element], names: Mapping[str, set[str]]) -> str:
    by_name = {one: element.path for element in reversed(fitting) for one in names[element.path]}
    near = dict.fromkeys(by_name[one] for one in get_close_matches(plain(name), by_name, 6, 0.3))
    if near:
        return f"nearest: {', '.join(list(near)[:3])} (--joint {name}=ITEM)"
    if fitting:
        return f"there are {', '.join(one.path for one in fitting[:3])} (--joint {name}=ITEM)"
    return "the spec has no value with a unit that fits"


def _rank(element: Element) -> tuple[bool, bool]:
    return element.writable, element.publish is None


def _factor(element: Element, joint: Joint) -> float | None:
    """Return the factor from a value to rad or m, or None if it cannot be the position of the joint."""
    own, si = unit(element.unit), unit(RAD if joint.turns else METRE)
    if not element.type.numeric or own is None or si is None or own.dimension != si.dimension or own.offset:
        return None
    return float(own.factor / si.factor)
