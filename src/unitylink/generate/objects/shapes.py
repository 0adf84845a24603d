# SPDX-License-Identifier: BSD-3-Clause
"""Which expansions of a constructor share a class, in every language with typed objects."""

from __future__ import annotations

from collections.abc import Hashable

from unitylink.layer4_data.names import attribute_of
from unitylink.spec.model import Element, Group, Instance, LinkBinding
from unitylink.values import Quantity


def camel(name: str) -> str:
    """Return a class name: `servo_left` -> ServoLeft, `_2nd` -> N2nd."""
    joined = "".join(step[:1].upper() + step[1:] for step in name.split("_"))
    return joined if joined.isidentifier() else f"N{joined}"


def arrays(instance: Instance) -> dict[str, list[int]]:
    """Return the positions of the members by attribute. The parts of an array have several."""
    found: dict[str, list[int]] = {}
    for position, member in enumerate(instance.members):
        if not isinstance(member, Group):
            found.setdefault(attribute_of(member), []).append(position)
    return found


def shape(instance: Instance, above: LinkBinding) -> Hashable:
    """Return the facts on which the class depends. Two expansions with the same facts share a class."""
    members: list[Hashable] = []
    for member in instance.members:
        if isinstance(member, Instance):
            members.append((member.name, member.array, member.documentation, shape(member, instance.link)))
        elif isinstance(member, Element):
            facts = (
                member.access,
                Quantity.of(member),
                member.words,
                member.checked,
                member.publish,
                member.documentation,
                member.array,
            )
            members.append((member.name, facts))
        else:
            members.append((member.name, relative(member, instance)))
    own = instance.link if instance.link != above else None
    return (instance.constructor, own, tuple(members))


def relative(group: Group, instance: Instance) -> tuple[str, ...]:
    start = len(instance.path) + 1 if instance.path else 0
    return tuple(element.path[start:] for element in group.elements)
