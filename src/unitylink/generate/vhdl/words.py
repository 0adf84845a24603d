# SPDX-License-Identifier: BSD-3-Clause
"""The words of a design, and which side drives each of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.protocol import (
    TOSNET_ADDRESS_BITS,
    TOSNET_IN_BIT,
    TOSNET_MEMORY_WORDS,
    TOSNET_NODE_SHIFT,
)
from unitylink.spec.model import Component, Element, Instance, Spec

from .names import Names

# The user's logic drives these for the PC to read. A READWRITE is a word that the PC writes, and reads back.
USER_GIVES = ("READ", "W1C", "READCLEAR")


@dataclass(frozen=True)
class WordMap:
    """The words of a design: {address: index} in rising order.

    The index is the word's place in the ports of `NAME_design`.

    Word i of `read` is bits 32*i+31 to 32*i of `read_words`. The same holds for `write` and `write_words`. A
    word that one element reads and another one writes is in both. A TosNet word is in one of them, whatever
    the spec does with it. The PC writes IN words and the OUT words of its own node. The user's logic plays
    the other nodes.

    >>> from unitylink.spec import compile_text
    >>> spec = compile_text("public lamp() { @led = 0x10: WRITE(); @key = 0x08: READ(); }", "lamp.ul").spec
    >>> word_map(spec)
    WordMap(read=mappingproxy({8: 0}), write=mappingproxy({16: 0}))
    """

    read: Mapping[int, int]  # words that the PC reads and the user's logic drives
    write: Mapping[int, int]  # words that the PC writes

    def drives(self, element: Element) -> bool:
        """Tell whether the user's logic drives this element for the PC to read."""
        return element.access in USER_GIVES and element.address in self.read

    def sees(self, element: Element) -> bool:
        """Tell whether the user's logic sees what the PC writes to this element."""
        return element.writable and element.address in self.write


def word_map(spec: Spec, configuration: BoardConfiguration | None = None) -> WordMap:
    """Return the words of the design that `generate_vhdl(spec, configuration)` makes."""
    configuration = configuration or BoardConfiguration.for_spec(spec)
    read: set[int] = set()
    write: set[int] = set()
    components = {address for component in components_of(spec) for address in component.range}
    if configuration.tosnet and configuration.tosnet.ring:
        parts = node_components_of(spec)
        components |= {word.address for part in parts for word in part.component.carried}
    for _, element in spec.walk():
        if element.link.kind not in ("memory", "tosnet"):
            continue  # the user's logic reaches these through ports of their own
        if element.link.kind == "tosnet" and configuration.tosnet and configuration.tosnet.ring == "pins":
            continue  # the nodes behind the line have these
        for address in element.addresses:
            if address not in components:
                gives, takes = _directions(element, address, configuration)
                read |= {address} if gives else set()
                write |= {address} if takes else set()
    return WordMap(read=_indices(read), write=_indices(write))


@dataclass(frozen=True)
class PlacedComponent:
    """A component of the gateware library and its place in the spec."""

    root: str
    local: str  # its path below the root
    path: str  # the same, qualified as in `Spec.walk`
    component: Component

    @property
    def range(self) -> range:
        """Its addresses."""
        return range(self.component.base, self.component.base + self.component.words)


def components_of(spec: Spec) -> tuple[PlacedComponent, ...]:
    """Return the components on the PC's bus, in the order of the spec."""
    return tuple(one for one in _all_components(spec) if one.component.node is None)


def node_components_of(spec: Spec) -> tuple[PlacedComponent, ...]:
    """Return the components in the nodes of a ring, in the order of the spec."""
    return tuple(one for one in _all_components(spec) if one.component.node is not None)


def _all_components(spec: Spec) -> tuple[PlacedComponent, ...]:
    several = len(spec.roots) > 1

    def below(instance: Instance, root: str) -> Iterator[PlacedComponent]:
        for part in instance.instances:
            if part.component is not None:
                path = f"{root}.{part.path}" if several else part.path
                yield PlacedComponent(root, part.path, path, part.component)
            yield from below(part, root)

    return tuple(one for root in spec.roots for one in below(root, root.name))


def wires_of(parts: Iterable[PlacedComponent]) -> dict[tuple[str, str], int]:
    """Return the number of the wire of each port, (path, port), that has one. An output has one wire."""
    numbers: dict[tuple[str, str], int] = {}
    for part in parts:
        prefix = part.path.removesuffix(part.local)
        for port, way, other, its_port in part.component.connections:
            own, its = (part.path, port), (prefix + other, its_port)
            source, sink = (its, own) if way == "in" else (own, its)
            numbers[sink] = numbers.setdefault(source, len(set(numbers.values())))
    return numbers


def named_elements(spec: Spec) -> Iterator[tuple[str, str, Element]]:
    """Yield the path, the name in VHDL and the element of each value, in the spec's order.

    >>> from unitylink.spec import compile_text
    >>> spec = compile_text("public lamp() { @led[2] = i: WRITE(); }", "lamp.ul").spec
    >>> [(path, name) for path, name, _ in named_elements(spec)]
    [('led[0]', 'led_0'), ('led[1]', 'led_1')]
    """
    names = Names()
    for path, element in spec.walk():
        yield path, names.claim(path), element


def tosnet_range(configuration: BoardConfiguration) -> range:
    """Return the addresses at which TosNet's slave answers."""
    if configuration.tosnet is None:
        return range(0)
    return range(configuration.tosnet.base, configuration.tosnet.base + (1 << TOSNET_ADDRESS_BITS))


def _directions(element: Element, address: int, configuration: BoardConfiguration) -> tuple[bool, bool]:
    """Tell two things: does the user's logic give the word to the PC, and does the PC give it to the user's
    logic?
    """
    if configuration.tosnet is None or address not in tosnet_range(configuration):
        return element.access in USER_GIVES, element.writable
    word = address - configuration.tosnet.base
    if word >= TOSNET_MEMORY_WORDS:  # TosNet's own registers
        return False, False
    own = word >> TOSNET_NODE_SHIFT == configuration.tosnet.master_id
    if own or word >> TOSNET_IN_BIT & 1:
        return False, True
    return not element.writable, False  # TosNet refuses a write here


def _indices(addresses: Iterable[int]) -> Mapping[int, int]:
    return MappingProxyType({address: index for index, address in enumerate(sorted(addresses))})
