# SPDX-License-Identifier: BSD-3-Clause
"""The slave of a TosNet in a design: its nodes, and the words that they read and give."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from unitylink.interface.board_configuration import BoardConfiguration, TosnetConfiguration, TosnetNode
from unitylink.interface.components import constant_words
from unitylink.protocol import TOSNET_IN_BIT, TOSNET_NODE_SHIFT, TOSNET_REGISTER_SHIFT
from unitylink.spec.model import Spec

from ..quoting import Vhdl
from .names import Names
from .plan import NodeConstant, NodeParts, NodePort, Placed, Range, RingNode, Tosnet, Wire
from .ring_line import samples_a_clock
from .words import (
    PlacedComponent,
    WordMap,
    named_elements,
    node_components_of,
    tosnet_range,
    wires_of,
    word_map,
)

Placer = Callable[[int, PlacedComponent, Mapping[tuple[str, str], int]], Placed]

# What else is in the entity of a node, and in its architecture.
_NODE_NAMES = """
    clock reset ring_in ring_out running strobe exchange time_valid time_bits clock_hz line_baud_hz
    line_clocks entry ring_time inputs outputs address_map slaves_m2s slaves_s2m master_m2s master_s2m
    given taken wires ring_synchroniser node carrier interconnect std_ulogic_vector unsigned word_vector_t
    wishbone_m2s_vector_t wishbone_s2m_vector_t wishbone_m2s_t wishbone_s2m_t address_map_t wire_vector_t
"""
_NO_ADDRESSES = Vhdl("tosnet_no_addresses_c")
_NOTHING = Vhdl("(1 to 0 => 0)")


def planned_tosnet(
    spec: Spec, configuration: BoardConfiguration, words: WordMap, placed: Placer
) -> Tosnet | None:
    """Return the slave, or None for a spec without a TOSNET. `words` are those of the design's ports.

    `placed` places a component of a node, as this slave of its bus and with these wires. Raises BindingError
    for a line that does not suit the clock.
    """
    tosnet, inside = configuration.tosnet, tosnet_range(configuration)
    if tosnet is None:
        return None
    on_pins = tosnet.ring == "pins"
    samples = samples_a_clock(configuration.clock_hz, tosnet.line_baud_hz) if on_pins else 1
    # what travels, also where the design's ports do not have it
    travels = word_map(spec, replace(configuration, tosnet=replace(tosnet, ring="")))
    reads, writes = ([one for one in indices if one in inside] for indices in (travels.read, travels.write))
    nodes = [Vhdl.of('(id => {}, registers => x"{:02X}")', node.id, node.registers) for node in tosnet.nodes]
    return Tosnet(
        number=0,
        configuration=tosnet,
        master_registers=Vhdl.of('x"{:02X}"', tosnet.master_registers),
        nodes=_aggregate(nodes, Vhdl("tosnet_no_nodes_c")),
        cycle_hz=round(1 / tosnet.cycle_s),
        read_addresses=_aggregate(_offsets(reads, tosnet.base), _NO_ADDRESSES),
        write_addresses=_aggregate(_offsets(writes, tosnet.base), _NO_ADDRESSES),
        spec_word=Vhdl.of('x"{:08X}"', configuration.spec_hash & 0xFFFFFFFF or 1),
        reads=() if tosnet.ring else tuple(Wire(n, words.read[one], None) for n, one in enumerate(reads)),
        writes=() if tosnet.ring else tuple(Wire(n, None, words.write[one]) for n, one in enumerate(writes)),
        samples=samples,
        lines=() if tosnet.event_group is None else (tosnet.event_group,),
        ring=tuple(
            _node(number, node, tosnet, (travels, words), spec=spec, placed=placed)
            for number, node in enumerate(tosnet.nodes, 1)
        )
        if tosnet.ring
        else (),
    )


def _node(
    number: int,
    node: TosnetNode,
    tosnet: TosnetConfiguration,
    words: tuple[WordMap, WordMap],
    *,
    spec: Spec,
    placed: Placer,
) -> RingNode:
    travels, shown = words
    first = tosnet.base + (node.id << TOSNET_NODE_SHIFT)
    own = range(first, first + (1 << TOSNET_NODE_SHIFT))
    takes = [address for address in travels.write if address in own]
    if not takes:  # GHDL's synthesis fails with empty vectors; each register has IN words, used or not
        lowest = (node.registers & -node.registers).bit_length() - 1
        takes = [first + (lowest << TOSNET_REGISTER_SHIFT) + (1 << TOSNET_IN_BIT)]
    gives = [address for address in travels.read if address in own]
    safe = [(offset, word) for offset, word in tosnet.node_safe if tosnet.base + offset in takes]
    parts = [part for part in node_components_of(spec) if part.component.node == node.id]
    carried = {word.address for part in parts for word in part.component.carried}
    names = Names(_NODE_NAMES.split())
    ports = tuple(
        NodePort(
            names.claim(name),
            (takes if to_node else gives).index(element.address),
            len(element.addresses),
            to_node,
            (shown.write if to_node else shown.read).get(element.address),
        )
        for _, name, element in named_elements(spec)
        if element.link.kind == "tosnet" and element.address in own and element.address not in carried
        for to_node in [element.address in travels.write]
    )
    return RingNode(
        number=number,
        id=node.id,
        registers=Vhdl.of('x"{:02X}"', node.registers),
        read_addresses=_aggregate(_offsets(takes, tosnet.base), _NO_ADDRESSES),
        write_addresses=_aggregate(_offsets(gives, tosnet.base), _NO_ADDRESSES),
        takes=len(takes),
        gives=len(gives),
        ports=ports,
        safe_addresses=_aggregate(_offsets([offset for offset, _ in safe], 0), _NO_ADDRESSES),
        safe_values=_aggregate([Vhdl.of('x"{:08X}"', word) for _, word in safe], Vhdl("tosnet_no_words_c")),
        parts=_parts(parts, takes, gives, placed) if parts else None,
    )


def _parts(parts: Sequence[PlacedComponent], takes: list[int], gives: list[int], placed: Placer) -> NodeParts:
    """Return the components of a node, and what its carrier moves."""
    wires = wires_of(parts)
    constants, writes, reads = [], [], []
    for part in parts:
        base = part.component.base
        for offset, value, safe in constant_words(part.component):
            words = Vhdl.of('x"{:08X}"', value), Vhdl.of('x"{:08X}"', safe)
            constants.append((base + offset, NodeConstant(*words)))
        for word in part.component.carried:
            if word.inward:
                writes.append((base + word.offset, takes.index(word.address)))
            else:
                reads.append((base + word.offset, gives.index(word.address)))
    written = [address for address, _ in constants] + [address for address, _ in writes]
    return NodeParts(
        components=tuple(placed(number, part, wires) for number, part in enumerate(parts)),
        ranges=tuple(
            Range(number, Vhdl.of('x"{:08X}"', part.component.base), part.component.words, part.path)
            for number, part in enumerate(parts)
        ),
        wires=len(set(wires.values())),
        constants=tuple(constant for _, constant in constants),
        carried_in=tuple(index for _, index in writes),
        carried_out=tuple(index for _, index in reads),
        write_addresses=_aggregate([Vhdl.of("{}", one) for one in written], _NOTHING),
        read_addresses=_aggregate([Vhdl.of("{}", one) for one, _ in reads], _NOTHING),
    )


def _offsets(addresses: Iterable[int], base: int) -> list[Vhdl]:
    return [Vhdl.of("16#{:03X}#", address - base) for address in addresses]


def _aggregate(values: list[Vhdl], none: Vhdl) -> Vhdl:
    """Return an aggregate. If it has many values, each line has six."""
    named = [Vhdl.of("{} => {}", number, value) for number, value in enumerate(values)]
    rows = [Vhdl(", ").join(named[start : start + 6]) for start in range(0, len(named), 6)]
    return Vhdl.of("({})", Vhdl(",\n            ").join(rows)) if rows else none
