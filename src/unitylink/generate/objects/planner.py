# SPDX-License-Identifier: BSD-3-Clause
"""Plans the typed objects of a spec in one style, from the same shapes as the classes of Python."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass

from unitylink.spec.model import Element, Group, Instance, Member, Spec
from unitylink.values import Quantity

from ..quoting import file_name
from .documentation import places as said_places
from .documentation import sentences, shown, value_facts
from .facts import RobotFacts
from .names import Names, members
from .place import Place
from .plan import (
    ClassPlan,
    GroupPlan,
    ObjectsPlan,
    PartPlan,
    RobotPlan,
    SetMember,
    SetPlan,
    StreamPlan,
    ValuePlan,
)
from .sets import Sets
from .shapes import arrays, relative, shape
from .style import Style
from .types import Types

# What is named after a part of a robot, in C++ and in C.
_SETS = (
    *("_inputs", "_inputs_get", "_inputs_places", "_outputs", "_outputs_put", "_outputs_places"),
    *("_snapshot", "_write", "_initial", "_cycle", "_exchange"),
)
_PART = (("Inputs", "Outputs"), (*_SETS, "_begin", "_cycle_open", "_cycle_close"))
_TABLES = tuple(f"_tables_{name}" for name in ("links", "memories", "values", "robot"))
_ROBOT = (("Inputs", "Outputs", "Tables"), (*_PART[1], "_open", "_open_links", "_error", "_tables", *_TABLES))
_VALUE = ((), ("_read", "_write", "_clear", "_pulse"))
_STREAM = (("Stream",), ("_get", "_places", "_set", "_start", "_poll", "_wait", "_stop", "_lost"))


@dataclass(frozen=True)
class _Kind:
    """The names of a class and its sets, and its expansions."""

    name: str
    inputs: str
    outputs: str
    places: list[Place]


def plan_objects(spec: Spec, style: Style) -> ObjectsPlan:
    """Plan the header of a spec."""
    return _Planner(spec, style).plan()


class _Planner:
    def __init__(self, spec: Spec, style: Style) -> None:
        self.spec, self.style = spec, style
        self.code = style.dialect.code
        self.types = Types(spec, style)
        self.sets = Sets(self.types)
        self.facts = {root.name: RobotFacts(spec, root, style.dialect) for root in spec.roots}
        self.kinds: dict[Hashable, _Kind] = {}
        self.finished: dict[str, ClassPlan] = {}
        self.roots = [self._kind(root.name, root=True) for root in spec.roots]
        for kind, root in zip(self.roots, spec.roots, strict=True):
            place = Place(self.facts[root.name], root, 0)
            kind.places.append(place)
            self._collect(place)

    def plan(self) -> ObjectsPlan:
        for kind in self.roots:
            self._class(kind)
        robots = [
            self._robot(root, self.finished[kind.name])
            for root, kind in zip(self.spec.roots, self.roots, strict=True)
        ]
        own = {kind.name for kind in self.roots}
        return ObjectsPlan(
            self.style.prefix,
            self.code.text(self.spec.source),
            self.code.remark(file_name(self.spec.source)),
            self.spec.hash,
            tuple(self.types.enums.values()),
            tuple(self.types.bits.values()),
            tuple(self.sets.planned),
            tuple(plan for name, plan in self.finished.items() if name not in own),
            tuple(robots),
        )

    def _kind(self, name: str, *, root: bool = False) -> _Kind:
        claimed = self.style.robot(name, _ROBOT) if root else self.style.type(name, _PART)
        return _Kind(claimed, *self._sets_of(claimed), [])

    def _sets_of(self, name: str) -> tuple[str, str]:
        ends = ("_inputs", "_outputs") if self.style.plain else ("Inputs", "Outputs")
        return f"{name}{ends[0]}", f"{name}{ends[1]}"

    def _key(self, place: Place, part: Instance) -> Hashable:
        """Return the facts that choose the class. Words of the bus have its width, so this counts too."""
        return shape(part, place.instance.link), tuple(place.facts.width(e) for e in part.walk())

    def _collect(self, place: Place) -> None:
        for part, first in place.parts():
            key = self._key(place, part)
            if key not in self.kinds:
                self.kinds[key] = self._kind(part.constructor)
            inner = Place(place.facts, part, first)
            self.kinds[key].places.append(inner)
            self._collect(inner)

    def _reserved(self) -> set[str]:
        return {*self.style.reserved, *(() if self.style.plain else self.style.scope.taken)}

    def _class(self, kind: _Kind) -> ClassPlan:
        """Plan a class, and before it the classes of its parts."""
        if kind.name in self.finished:
            return self.finished[kind.name]
        place = kind.places[0]
        instance = place.instance
        found = arrays(instance)
        names = members([*found, *(group.name for group in instance.groups)], self._reserved())
        taken = Names({*names.values(), *self._reserved()})
        values: list[ValuePlan] = []
        parts: list[PartPlan] = []
        elements: dict[str, Element] = {}  # name of the member -> its first value
        for name, positions in found.items():
            own = [instance.members[position] for position in positions]
            if isinstance(own[0], Element):
                here = [one.instance.members[position] for one in kind.places for position in positions]
                values.append(self._value(kind, names[name], own, here))
                elements[names[name]] = own[0]
            else:
                instances = [part for part in own if isinstance(part, Instance)]
                parts += self._part_plans(place, names[name], instances, taken)
        sets = []
        for claimed, sampled in ((kind.inputs, True), (kind.outputs, False)):
            listed: list[SetMember | tuple[ValuePlan, Element]] = []
            for part in parts:
                inner = self.finished[part.type]
                chosen = inner.inputs if sampled else inner.outputs
                listed += [self.sets.of_part(part, chosen)] if chosen.values else []
            listed += [(value, elements[value.name]) for value in values]
            sets.append(self.sets.of_node(claimed, place, listed, sampled=sampled))
        groups = tuple(self._group(kind, place, names[group.name], group) for group in instance.groups)
        where = said_places([f"`{one.instance.path or one.instance.name}`" for one in kind.places])
        said = f"The constructor `{instance.constructor}`, expanded as {where}."
        remark = self.code.remark(sentences(instance.documentation, said))
        plan = ClassPlan(kind.name, remark, tuple(values), tuple(parts), groups, sets[0], sets[1])
        self.finished[kind.name] = plan
        return plan

    def _value(self, kind: _Kind, name: str, own: Sequence[Member], here: Sequence[Member]) -> ValuePlan:
        elements = [one for one in own if isinstance(one, Element)]
        place, element = kind.places[0], elements[0]
        quantity = Quantity.of(element)
        everywhere = [one for one in here if isinstance(one, Element)]
        said = sentences(element.documentation, value_facts(element, quantity, everywhere))
        return ValuePlan(
            name,
            self.style.within(kind.name, name, _VALUE) if self.style.plain else "",
            element.access,
            self.types.of(quantity, place.facts.width(element)),
            tuple(place.positions[one.path] for one in elements),
            len(elements) if element.array else 0,
            self.code.remark(said),
        )

    def _part_plans(
        self, place: Place, name: str, own: Sequence[Instance], taken: Names
    ) -> Iterator[PartPlan]:
        """Yield the parts of a name: one, or one for each item of an array whose items differ in shape."""
        planned = [self._class(self.kinds[self._key(place, part)]) for part in own]
        rows: list[tuple[str, Sequence[Instance], ClassPlan, int]]
        if len({plan.name for plan in planned}) == 1:
            rows = [(name, own, planned[0], len(own) if own[0].array else 0)]
        else:
            rows = [
                (taken.claim(f"{name}_{i}"), [part], plan, 0)
                for i, (part, plan) in enumerate(zip(own, planned, strict=True))
            ]
        for called, which, plan, count in rows:
            said = sentences(which[0].documentation, said_places([shown(part) for part in which]))
            paths = tuple(self.code.text(part.path) for part in which)
            firsts = tuple(place.firsts[part.path] for part in which)
            yield PartPlan(called, plan.name, firsts, paths, count, self.code.remark(said))

    def _group(self, kind: _Kind, place: Place, name: str, group: Group) -> GroupPlan:
        stem = self.style.within(kind.name, name, _PART)
        pairs = list(zip(relative(group, place.instance), group.elements, strict=True))
        sets: list[SetPlan] = []
        for claimed, sampled in zip(self._sets_of(stem), (True, False), strict=True):
            named = [(path, element) for path, element in pairs if place.takes(element, sampled=sampled)]
            made = self.sets.flat(claimed, place, named, sampled=sampled, reserved=self._reserved())
            sets.append(made)
        listed = said_places([path for path, _ in pairs])
        said = sentences(group.documentation, f"{len(pairs)} words together: {listed}")
        return GroupPlan(name, stem, self.code.text(group.path), sets[0], sets[1], self.code.remark(said))

    def _robot(self, root: Instance, plan: ClassPlan) -> RobotPlan:
        facts = self.facts[root.name]
        memories = facts.memories()
        return RobotPlan(
            plan,
            self.code.text(root.name),
            f"{plan.name}{'_tables' if self.style.plain else 'Tables'}",
            facts.links(),
            memories,
            tuple(facts.value(element, self.types.table_of(element.type)) for element in facts.elements),
            sum(memory.count for memory in memories),
            tuple(self._streams(root, plan, facts)),
        )

    def _streams(self, root: Instance, plan: ClassPlan, facts: RobotFacts) -> Iterator[StreamPlan]:
        """Yield what the gateware of each link publishes. Its groups have members of the robot's class."""
        own = {member.name for kind in (plan.values, plan.parts, plan.groups) for member in kind}
        scope = Names({*self._reserved(), *own})
        place = Place(facts, root, 0)
        devices = [device for device in self.spec.devices if device.root == root.name]
        for group in (group for device in devices for group in device.groups):
            name = scope.claim(f"published_{group.name.replace(' ', '_').lower()}")
            stem = self.style.within(plan.name, name, _STREAM)
            named = [(element.path, element) for element in group.elements]
            rate = f" at {group.rate_hz:g} Hz" if group.rate_hz else f" on {group.event or group.trigger}"
            said = f"What the gateware publishes{rate}, as `{group.name}`."
            made = self.sets.flat(stem, place, named, sampled=True, reserved=self._reserved())
            yield StreamPlan(name, stem, self.code.text(name), group.divisor, made, self.code.remark(said))
