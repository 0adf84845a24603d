# SPDX-License-Identifier: BSD-3-Clause
"""The components of a spec, as a virtual board needs them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from unitylink.errors import ValueRangeError
from unitylink.protocol import DATA_BITS_MAX
from unitylink.spec.model import Component, Instance, Spec
from unitylink.values import Codec, Quantity


@dataclass(frozen=True)
class ComponentConfiguration:
    """A component at `base`: its entity, its generics and its ports beside the bus.

    `pins` are (port, "in" | "out" | "inout", bits; 0 for a single signal). `event_groups` has, for each of
    `events`, the publish group that it triggers, or None. `clock_least_hz` is the slowest clock that will do.
    `wires` are (port, "in" | "out") of values for other components. `connections` lead to inputs among them:
    (number among the inputs, number of the other component, number among its outputs).

    With a `node`, it is on the bus of this node of a ring. `carried` are (word, address on the PC's bus, is
    it an IN word?), and `constants` are (word, value, value while the ring does not run).
    """

    path: str
    entity: str
    base: int
    words: int
    generics: tuple[tuple[str, int | str], ...] = ()
    pins: tuple[tuple[str, str, int], ...] = ()
    events: tuple[str, ...] = ()
    event_groups: tuple[int | None, ...] = ()
    clock_least_hz: int = 0
    wires: tuple[tuple[str, str], ...] = ()
    connections: tuple[tuple[int, int, int], ...] = ()
    node: int | None = None
    carried: tuple[tuple[int, int, bool], ...] = ()
    constants: tuple[tuple[int, int, int], ...] = ()

    @property
    def addresses(self) -> Sequence[int]:
        """Its addresses on the PC's bus."""
        if self.node is not None:
            return tuple(address for _, address, _ in self.carried)
        return range(self.base, self.base + self.words)

    def wire_number(self, port: str) -> int:
        """Return the place of a wire among those of its direction."""
        way = dict(self.wires)[port]
        return [name for name, its_way in self.wires if its_way == way].index(port)


def components_of(spec: Spec, clock_hz: int) -> tuple[ComponentConfiguration, ...]:
    """Return the components of a spec in the order of the text, at a design's clock.

    >>> from unitylink.spec import compile_text
    >>> spec = compile_text("public a() { pad: gpio(pins=4); }").spec
    >>> [(one.path, one.entity, one.words) for one in components_of(spec, 50_000_000)]
    [('pad', 'gpio', 6)]
    """
    groups = {
        (device.root, group.event): group.number
        for device in spec.devices
        for group in device.groups
        if group.trigger == "event"
    }
    found: list[ComponentConfiguration] = []
    leads: list[tuple[tuple[str, str], tuple[str, str]]] = []  # (path, port) of an output and of its input
    several = len(spec.roots) > 1
    for root in spec.roots:
        for instance, one in _placed(root):
            generics = {name: clock_hz if name == "clock_hz" else value for name, value in one.generics}
            triggered = tuple(groups.get((root.name, f"{instance.path}.{event}")) for event in one.events)
            path = f"{root.name}.{instance.path}" if several else instance.path
            told = (path, one.entity, one.base, one.words, tuple(generics.items()), one.pins)
            wires = tuple((port, way) for port, way, _ in one.wires)
            made = ComponentConfiguration(*told, one.events, triggered, one.clock_least_hz, wires)
            found.append(made if one.node is None else _in_node(made, one))
            for port, way, other, its_port in one.connections:
                own, its = (path, port), (f"{root.name}.{other}" if several else other, its_port)
                leads.append((its, own) if way == "in" else (own, its))
    numbers = {one.path: number for number, one in enumerate(found)}

    def leading_to(one: ComponentConfiguration) -> Iterator[tuple[int, int, int]]:
        for (path, port), (sink, its_port) in leads:
            if sink == one.path:
                number = numbers[path]
                yield one.wire_number(its_port), number, found[number].wire_number(port)

    return tuple(replace(one, connections=tuple(leading_to(one))) for one in found)


def _in_node(made: ComponentConfiguration, one: Component) -> ComponentConfiguration:
    carried = tuple((word.offset, word.address, word.inward) for word in one.carried)
    return replace(made, node=one.node, carried=carried, constants=constant_words(one))


def constant_words(component: Component) -> tuple[tuple[int, int, int], ...]:
    """Return what a node of a ring writes to a component: (word, value, value while the ring does not run).

    They are the INITIAL and the SAFE value of each element that does not travel. One that is missing is the
    other one.
    """
    found: list[tuple[int, int, int]] = []
    for element in component.constants:
        codec = Codec(element.path, Quantity.of(element), DATA_BITS_MAX)
        given = [value for value in (element.initial, element.safe) if value is not None]
        first, last = (codec.split(codec.encode(value)) for value in (given[0], given[-1]))
        found += zip(element.addresses, first, last, strict=True)
    return tuple(found)


def check_clock(components: Iterable[ComponentConfiguration], clock_hz: int) -> None:
    """Raise ValueRangeError for a component that needs a faster clock than that of the design."""
    for one in components:
        if clock_hz < one.clock_least_hz:
            raise ValueRangeError(
                f"component {one.path} ({one.entity}) needs a clock of at least {one.clock_least_hz:,} Hz, "
                f"and the design has {clock_hz:,} Hz: choose a faster clock (clock_hz), or slower parameters"
            )


def placed_components(spec: Spec) -> Iterator[Component]:
    """Yield what each instance of a component stands for, in the order of the text."""
    for root in spec.roots:
        for _, component in _placed(root):
            yield component


def _placed(instance: Instance) -> Iterator[tuple[Instance, Component]]:
    for inner in instance.instances:
        if inner.component is not None:
            yield inner, inner.component
        yield from _placed(inner)
