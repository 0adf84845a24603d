# SPDX-License-Identifier: BSD-3-Clause
"""The members of a class in C++: how they are declared, and how its constructor makes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..objects.names import members
from ..objects.plan import ClassPlan, RobotPlan, SetMember
from ..quoting import Code, Cpp

# Access in the spec -> class of unitylink/objects.hpp.
_CLASSES = {
    "READ": "ReadValue",
    "WRITE": "WriteValue",
    "READWRITE": "ReadWriteValue",
    "READCLEAR": "ReadClearValue",
    "W1C": "ClearValue",
    "PULSE": "PulseValue",
}


def declarations(plan: ClassPlan) -> Iterator[tuple[Cpp, Code]]:
    """Yield the declaration of each member, and the remark about it."""
    for part in plan.parts:
        yield _declared(Cpp.of("{}", part.type), part.count, part.name), part.remark
    for value in plan.values:
        kind = Cpp.of("unitylink::{}<{}>", _CLASSES[value.access], value.type.name)
        yield _declared(kind, value.count, value.name), value.remark
    for group in plan.groups:
        kind = Cpp.of("unitylink::Part<{}, {}>", group.inputs.name, group.outputs.name)
        yield _declared(kind, 0, group.name), group.remark


def initialisers(plan: ClassPlan, *, robot: bool) -> Iterator[Cpp]:
    """Yield the initialiser of each member. A robot begins at the place 0 of its table."""
    objects = Cpp("objects()") if robot else Cpp("ul_of")
    first = Cpp("0") if robot else Cpp("ul_first")
    for part in plan.parts:
        kind = Cpp.of("{}", part.type)
        made = [
            Cpp.of("{}, {} + {}, {}", objects, first, place, path)
            for place, path in zip(part.places, part.paths, strict=True)
        ]
        yield _made(part.name, kind, part.count, made)
    for value in plan.values:
        kind = Cpp.of("unitylink::{}<{}>", _CLASSES[value.access], value.type.name)
        made = [Cpp.of("{}, {} + {}", objects, first, place) for place in value.places]
        yield _made(value.name, kind, value.count, made)
    for group in plan.groups:
        yield Cpp.of("{}({}, {}, {})", group.name, objects, first, group.path)


def filled(member: SetMember) -> Cpp:
    """Return the initialiser of a member of a set: each value has the INITIAL of the spec, or is 0."""
    if not member.initial:
        return Cpp("{}")
    if member.count:
        return Cpp.of(" = {{{{{}}}}}", Cpp(", ").join([member.initial] * member.count))
    return Cpp.of(" = {}", member.initial)


def link_names(robot: RobotPlan) -> list[str]:
    return list(members([link.parameter for link in robot.links], {"link"}).values())


def handles(robot: RobotPlan, *, one: bool) -> Cpp:
    """Return the handles of the links. `one`: all are the same link."""
    names = ["link"] * len(robot.links) if one else link_names(robot)
    return Cpp(", ").join(Cpp.of("{}.handle()", name) for name in names)


def parameters(robot: RobotPlan) -> Cpp:
    return Cpp(", ").join(Cpp.of("const unitylink::Link& {}", name) for name in link_names(robot))


def _declared(kind: Cpp, count: int, name: str) -> Cpp:
    return Cpp.of("std::array<{}, {}> {};", kind, count, name) if count else Cpp.of("{} {};", kind, name)


def _made(name: str, kind: Cpp, count: int, arguments: Sequence[Cpp]) -> Cpp:
    if not count:
        return Cpp.of("{}({})", name, arguments[0])
    return Cpp.of("{}{{{{{}}}}}", name, Cpp(", ").join(Cpp.of("{}({})", kind, one) for one in arguments))
