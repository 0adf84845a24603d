# SPDX-License-Identifier: BSD-3-Clause
"""The functions of a header of C: which there are, and the lines that fill and read structs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..objects.names import members
from ..objects.plan import ClassPlan, ObjectsPlan, RobotPlan, SetMember, SetPlan, ValuePlan
from ..quoting import Code, Cpp

# Access in the spec -> functions: the ending of the name, and whether it gets or puts a value.
_FUNCTIONS = {
    "READ": (("read", "get"),),
    "WRITE": (("write", "put"),),
    "READWRITE": (("read", "get"), ("write", "put")),
    "READCLEAR": (("read", "get"),),
    "W1C": (("read", "get"), ("clear", "put")),
    "PULSE": (("pulse", "put"),),
}
_OUTPUTS = Cpp("outputs->")


@dataclass(frozen=True)
class Node:
    """A part or a group, with what is read, written and exchanged together. `owner` is the part's type."""

    stem: str
    owner: str
    path: Code
    inputs: SetPlan
    outputs: SetPlan
    remark: Code


def _classes(plan: ObjectsPlan) -> Iterator[ClassPlan]:
    yield from plan.classes
    yield from (robot.plan for robot in plan.robots)


def functions(value: ValuePlan) -> tuple[tuple[str, str], ...]:
    return _FUNCTIONS[value.access]


def values(plan: ObjectsPlan) -> Iterator[tuple[str, ValuePlan]]:
    """Yield each value with the type of the part that has it."""
    for one in _classes(plan):
        for value in one.values:
            yield one.name, value


def nodes(plan: ObjectsPlan) -> Iterator[Node]:
    for one in _classes(plan):
        own = Cpp("part->part.path")
        yield Node(one.name, one.name, own, one.inputs, one.outputs, one.remark)
        for group in one.groups:
            yield Node(group.stem, one.name, group.path, group.inputs, group.outputs, group.remark)


def read(plan: ObjectsPlan) -> set[str]:
    """Return the names of the sets that are read or published. The others are written."""
    named = {node.inputs.name for node in nodes(plan)}
    return named | {stream.set.name for robot in plan.robots for stream in robot.streams}


def get_lines(member: SetMember) -> Iterator[Cpp]:
    """Yield the statements that decode a member, one for each of its values or parts."""
    for place, target in _targets(member):
        if member.part is not None:
            call = Cpp.of(
                "{}_get(objects, first + {}, raws, &values->{}, failure)", member.type.name, place, target
            )
        else:
            call = Cpp.of(
                "{}(&objects->facts->values[first + {}], *raws, &values->{}, failure)",
                member.type.get,
                place,
                target,
            )
        yield from _next(member, call)


def put_lines(member: SetMember) -> Iterator[Cpp]:
    """Yield the statements that encode a member."""
    for place, target in _targets(member):
        if member.part is not None:
            call = Cpp.of(
                "{}_put(objects, first + {}, &values->{}, raws, failure)", member.type.name, place, target
            )
        else:
            call = Cpp.of(
                "{}(&objects->facts->values[first + {}], values->{}, raws, failure)",
                member.type.put,
                place,
                target,
            )
        yield from _next(member, call)


def _next(member: SetMember, call: Cpp) -> Iterator[Cpp]:
    count = len(member.part.values) if member.part is not None else 1
    yield Cpp.of("if (status == UL_OK) status = {};", call)
    yield Cpp.of("raws += {};", count)


def _targets(member: SetMember) -> Iterator[tuple[int, Cpp]]:
    for item, place in enumerate(member.places):
        yield place, Cpp.of("{}[{}]" if member.count else "{}", member.name, item)


def initial_lines(plan: SetPlan, above: Cpp = _OUTPUTS) -> Iterator[Cpp]:
    """Yield the statements that give each value its INITIAL, which memset has not done."""
    for member in plan.members:
        for _, target in _targets(member):
            whole = Cpp.of("{}{}", above, target)
            if member.part is not None:
                yield from initial_lines(member.part, Cpp.of("{}.", whole))
            elif member.initial.startswith("{"):
                kind = member.type.name
                yield Cpp.of("{{ const {} initial = {}; {} = initial; }}", kind, member.initial, whole)
            elif member.initial:
                yield Cpp.of("{} = {};", whole, member.initial)


def begin_lines(plan: ClassPlan, *, robot: bool) -> Iterator[Cpp]:
    """Yield the statements that begin the parts of a part. A robot begins at the place 0 of its table."""
    for part in plan.parts:
        for item, (place, path) in enumerate(zip(part.places, part.paths, strict=True)):
            target = Cpp.of("{}[{}]" if part.count else "{}", part.name, item)
            if robot:
                yield Cpp.of("{}_begin(&robot->{}, &robot->robot, {}, {});", part.type, target, place, path)
            else:
                yield Cpp.of("{}_begin(&part->{}, robot, first + {}, {});", part.type, target, place, path)


def link_names(robot: RobotPlan) -> list[str]:
    return list(members([link.parameter for link in robot.links], {"robot"}).values())


def parameters(robot: RobotPlan) -> Cpp:
    return Cpp(", ").join(Cpp.of("ul_link* {}", name) for name in link_names(robot))
