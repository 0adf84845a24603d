# SPDX-License-Identifier: BSD-3-Clause
"""The members of a struct in Rust: how they are declared, and how its constructor makes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..objects import ObjectsPlan
from ..objects.names import members
from ..objects.plan import ClassPlan, RobotPlan, SetMember
from ..quoting import Code, Rust

# Access in the spec -> struct of the crate `unitylink`.
_STRUCTS = {
    "READ": "ReadValue",
    "WRITE": "WriteValue",
    "READWRITE": "ReadWriteValue",
    "READCLEAR": "ReadClearValue",
    "W1C": "ClearValue",
    "PULSE": "PulseValue",
}


def all_classes(plan: ObjectsPlan) -> Iterator[ClassPlan]:
    yield from plan.classes
    yield from (robot.plan for robot in plan.robots)


def declarations(plan: ClassPlan) -> Iterator[tuple[str, Rust, Code]]:
    """Yield the name and the type of each member, and the remark about it."""
    for part in plan.parts:
        yield part.name, _array(Rust.of("{}", part.type), part.count), part.remark
    for value in plan.values:
        kind = Rust.of("::unitylink::{}<{}>", _STRUCTS[value.access], value.type.name)
        yield value.name, _array(kind, value.count), value.remark
    for group in plan.groups:
        yield (
            group.name,
            Rust.of("::unitylink::Part<{}, {}>", group.inputs.name, group.outputs.name),
            group.remark,
        )


def initialisers(plan: ClassPlan) -> Iterator[Rust]:
    """Yield the initialiser of each member."""
    for part in plan.parts:
        made = [
            Rust.of("{}::ul_new(ul_core, ul_first + {}, {})", part.type, place, path)
            for place, path in zip(part.places, part.paths, strict=True)
        ]
        yield _made(part.name, part.count, made)
    for value in plan.values:
        kind = _STRUCTS[value.access]
        made = [
            Rust.of("::unitylink::{}::new(ul_core, ul_first + {})", kind, place) for place in value.places
        ]
        yield _made(value.name, value.count, made)
    for group in plan.groups:
        yield Rust.of("{}: ::unitylink::Part::new(ul_core, ul_first, {})", group.name, group.path)


def kind(member: SetMember) -> Rust:
    return _array(Rust.of("{}", member.type.name), member.count)


def decoded(member: SetMember) -> Rust:
    """Return the expression that gives a member of a set."""
    one = (
        Rust.of("<{} as ::unitylink::Set>::decode(ul_from)?", member.type.name)
        if member.part is not None
        else None
    )
    one = one or Rust("ul_from.value()?")
    return Rust.of("[{}]", Rust(", ").join([one] * member.count)) if member.count else one


def encoded(member: SetMember) -> Iterator[Rust]:
    """Yield the statements that give a member of a set away."""
    for item in range(member.count or 1):
        value = Rust.of("self.{}[{}]" if member.count else "self.{}", member.name, item)
        if member.part is not None:
            yield Rust.of("::unitylink::Set::encode(&{}, ul_to)?;", value)
        else:
            yield Rust.of("ul_to.value({})?;", value)


def has_default(plan: ObjectsPlan, name: str) -> bool:
    """Return whether a type has a value to begin with: a closed enumeration without a 0 has none."""
    for enum in plan.enums:
        if enum.name == name:
            return enum.open or any(member.value == 0 for member in enum.members)
    for bits in plan.bits:
        if bits.name == name:
            return all(has_default(plan, field.type.name) for field in bits.fields)
    for one in plan.sets:
        if one.name == name:
            return all(member.initial or has_default(plan, member.type.name) for member in one.members)
    return True


def filled(member: SetMember) -> Rust:
    """Return the value of a member to begin with: the INITIAL of the spec, or 0."""
    one = member.initial or Rust("::core::default::Default::default()")
    return Rust.of("[{}; {}]", one, member.count) if member.count else Rust.of("{}", one)


def link_names(robot: RobotPlan) -> list[str]:
    return list(members([link.parameter for link in robot.links], {"link"}).values())


def parameters(robot: RobotPlan) -> Rust:
    return Rust(", ").join(Rust.of("{}: &::unitylink::Link", name) for name in link_names(robot))


def clones(robot: RobotPlan, *, one: bool) -> Rust:
    """Return clones of the links. `one`: all are the same link."""
    names = ["link"] * len(robot.links) if one else link_names(robot)
    return Rust(", ").join(Rust.of("{}.clone()", name) for name in names)


def _array(kind: Rust, count: int) -> Rust:
    return Rust.of("[{}; {}]", kind, count) if count else kind


def _made(name: str, count: int, made: Sequence[Rust]) -> Rust:
    return Rust.of("{}: [{}]" if count else "{}: {}", name, Rust(", ").join(made))
