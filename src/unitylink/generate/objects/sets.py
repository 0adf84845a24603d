# SPDX-License-Identifier: BSD-3-Clause
"""Plans the structs of values that are read, written or published together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Union

from unitylink.spec.model import Element
from unitylink.values import Quantity

from .documentation import value_facts
from .names import Names
from .place import Place
from .plan import PartPlan, SetMember, SetPlan, TypeName, ValuePlan
from .types import Types

Named = Iterable[tuple[str, Element]]  # name of the member, and the value

Listed = Union[SetMember, tuple[ValuePlan, Element]]  # the set of a part, or a value of its own


class Sets:
    """All sets of a header, in an order in which each one comes after those it needs."""

    def __init__(self, types: Types) -> None:
        self.types = types
        self.code = types.dialect.code
        self.planned: list[SetPlan] = []

    def of_node(
        self,
        name: str,
        place: Place,
        members: Sequence[SetMember | tuple[ValuePlan, Element]],
        *,
        sampled: bool,
    ) -> SetPlan:
        """Plan the set of a class. `members` are the sets of its parts, and its own values."""
        made: list[SetMember] = []
        for member in members:
            if isinstance(member, SetMember):
                made.append(member)
                continue
            plan, element = member
            if place.takes(element, sampled=sampled):
                made.append(self._member(place, plan.name, element, (plan.places, plan.count), sampled))
        return self._kept(name, place, made)

    def of_part(self, plan: PartPlan, inner: SetPlan) -> SetMember:
        """Return the set of a part as a member of the set that contains it."""
        kind = TypeName(self.code.of("{}", inner.name))
        return SetMember(plan.name, kind, plan.count, plan.places, inner, self.code(""), plan.remark)

    def flat(self, name: str, place: Place, named: Named, *, sampled: bool, reserved: set[str]) -> SetPlan:
        """Plan the set of a group, or of what is published: all values side by side."""
        scope = Names(reserved)
        made = [
            self._member(place, scope.claim(path), element, ((place.positions[element.path],), 0), sampled)
            for path, element in named
        ]
        return self._kept(name, place, made)

    def _member(
        self, place: Place, name: str, element: Element, where: tuple[tuple[int, ...], int], sampled: bool
    ) -> SetMember:
        quantity, width = Quantity.of(element), place.facts.width(element)
        initial = self.code("")
        if not sampled and element.initial is not None:
            initial = self.types.literal(quantity, width, element.initial)
        said = self.code.remark(value_facts(element, quantity, [element]))
        places, count = where
        return SetMember(name, self.types.of(quantity, width), count, places, None, initial, said)

    def _kept(self, name: str, place: Place, made: Sequence[SetMember]) -> SetPlan:
        values: list[int] = []
        for member in made:
            for first in member.places:
                values += [first + inner for inner in member.part.values] if member.part else [first]
        elements = place.facts.elements
        words = sum(elements[place.first + value].words for value in values)
        plan = SetPlan(name, tuple(made), tuple(values), words)
        self.planned.append(plan)
        return plan
