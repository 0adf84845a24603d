# SPDX-License-Identifier: BSD-3-Clause
"""The slave of a TosNet in a design: its nodes, and the words that they read and give."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from unitylink.errors import BindingError
from unitylink.interface.board_configuration import BoardConfiguration, TosnetConfiguration, TosnetNode
from unitylink.protocol import TOSNET_NODE_SHIFT
from unitylink.spec.model import Spec

from ..quoting import Vhdl
from .plan import NodePort, RingNode, Tosnet, Wire
from .words import WordMap, named_elements, tosnet_range, word_map

_NO_ADDRESSES = Vhdl("tosnet_no_addresses_c")
_SAMPLES_LEAST = 3  # of a bit on the line (tosnet_line_in)


def planned_tosnet(spec: Spec, configuration: BoardConfiguration, words: WordMap) -> Tosnet | None:
    """Return the slave, or None for a spec without a TOSNET. `words` are those of the design's ports.

    Raises BindingError for a line that is too fast for the clock.
    """
    tosnet, inside = configuration.tosnet, tosnet_range(configuration)
    if tosnet is None:
        return None
    if tosnet.ring == "pins" and configuration.clock_hz < _SAMPLES_LEAST * tosnet.line_baud_hz:
        raise BindingError(
            f"vhdl: the ring's line has {tosnet.line_baud_hz:,} bit/s, and a bit needs "
            f"{_SAMPLES_LEAST} clocks of {configuration.clock_hz:,} Hz; write a lower BAUD in TOSNET, "
            "or choose a faster clock"
        )
    if tosnet.ring == "pins":  # the ports do not have the words of the nodes
        words = word_map(spec, replace(configuration, tosnet=replace(tosnet, ring="")))
    reads, writes = ([one for one in indices if one in inside] for indices in (words.read, words.write))
    nodes = [Vhdl.of('(id => {}, registers => x"{:02X}")', node.id, node.registers) for node in tosnet.nodes]
    return Tosnet(
        number=0,
        configuration=tosnet,
        master_registers=Vhdl.of('x"{:02X}"', tosnet.master_registers),
        nodes=_aggregate(nodes, Vhdl("tosnet_no_nodes_c")),
        cycle_hz=round(1 / tosnet.cycle_s),
        read_addresses=_aggregate(_offsets(reads, tosnet.base), _NO_ADDRESSES),
        write_addresses=_aggregate(_offsets(writes, tosnet.base), _NO_ADDRESSES),
        reads=tuple(Wire(n, words.read[address], None) for n, address in enumerate(reads)),
        writes=tuple(Wire(n, None, words.write[address]) for n, address in enumerate(writes)),
        lines=() if tosnet.event_group is None else (tosnet.event_group,),
        ring=tuple(_node(number, node, tosnet, words, spec) for number, node in enumerate(tosnet.nodes, 1))
        if tosnet.ring
        else (),
    )


def _node(number: int, node: TosnetNode, tosnet: TosnetConfiguration, words: WordMap, spec: Spec) -> RingNode:
    first = tosnet.base + (node.id << TOSNET_NODE_SHIFT)
    own = range(first, first + (1 << TOSNET_NODE_SHIFT))
    takes = [address for address in words.write if address in own]
    gives = [address for address in words.read if address in own]
    safe = [(offset, word) for offset, word in tosnet.node_safe if tosnet.base + offset in takes]
    ports = tuple(
        NodePort(name, (takes if to_node else gives).index(element.address), len(element.addresses), to_node)
        for _, name, element in named_elements(spec)
        if element.link.kind == "tosnet" and element.address in own
        for to_node in [element.address in words.write]
    )
    return RingNode(
        number=number,
        id=node.id,
        registers=Vhdl.of('x"{:02X}"', node.registers),
        read_addresses=_aggregate(_offsets(takes, tosnet.base), _NO_ADDRESSES),
        write_addresses=_aggregate(_offsets(gives, tosnet.base), _NO_ADDRESSES),
        reads=tuple(Wire(n, None, words.write[address]) for n, address in enumerate(takes)),
        writes=tuple(Wire(n, words.read[address], None) for n, address in enumerate(gives)),
        ports=ports,
        safe_addresses=_aggregate(_offsets([offset for offset, _ in safe], 0), _NO_ADDRESSES),
        safe_values=_aggregate([Vhdl.of('x"{:08X}"', word) for _, word in safe], Vhdl("tosnet_no_words_c")),
    )


def _offsets(addresses: Iterable[int], base: int) -> list[Vhdl]:
    return [Vhdl.of("16#{:03X}#", address - base) for address in addresses]


def _aggregate(values: list[Vhdl], none: Vhdl) -> Vhdl:
    """Return an aggregate. If it has many values, each line has six."""
    named = [Vhdl.of("{} => {}", number, value) for number, value in enumerate(values)]
    rows = [Vhdl(", ").join(named[start : start + 6]) for start in range(0, len(named), 6)]
    return Vhdl.of("({})", Vhdl(",\n            ").join(rows)) if rows else none
