# SPDX-License-Identifier: BSD-3-Clause
"""The slave of a TosNet in a design: its nodes, and the words that they read and give."""

from __future__ import annotations

from collections.abc import Iterable

from unitylink.interface.board_configuration import BoardConfiguration

from ..quoting import Vhdl
from .plan import Tosnet, Wire
from .words import WordMap, tosnet_range


def planned_tosnet(configuration: BoardConfiguration, words: WordMap) -> Tosnet | None:
    """Return the slave, or None for a spec without a TOSNET."""
    tosnet, inside = configuration.tosnet, tosnet_range(configuration)
    if tosnet is None:
        return None
    reads, writes = ([one for one in indices if one in inside] for indices in (words.read, words.write))
    nodes = [Vhdl.of('(id => {}, registers => x"{:02X}")', node.id, node.registers) for node in tosnet.nodes]
    return Tosnet(
        number=0,
        configuration=tosnet,
        master_registers=Vhdl.of('x"{:02X}"', tosnet.master_registers),
        nodes=_aggregate(nodes, Vhdl("tosnet_no_nodes_c")),
        cycle_hz=round(1 / tosnet.cycle_s),
        read_addresses=_aggregate(_offsets(reads, tosnet.base), Vhdl("tosnet_no_addresses_c")),
        write_addresses=_aggregate(_offsets(writes, tosnet.base), Vhdl("tosnet_no_addresses_c")),
        reads=tuple(Wire(n, words.read[address], None) for n, address in enumerate(reads)),
        writes=tuple(Wire(n, None, words.write[address]) for n, address in enumerate(writes)),
        lines=() if tosnet.event_group is None else (tosnet.event_group,),
    )


def _offsets(addresses: Iterable[int], base: int) -> list[Vhdl]:
    return [Vhdl.of("16#{:03X}#", address - base) for address in addresses]


def _aggregate(values: list[Vhdl], none: Vhdl) -> Vhdl:
    """Return an aggregate. If it has many values, each line has six."""
    named = [Vhdl.of("{} => {}", number, value) for number, value in enumerate(values)]
    rows = [Vhdl(", ").join(named[start : start + 6]) for start in range(0, len(named), 6)]
    return Vhdl.of("({})", Vhdl(",\n            ").join(rows)) if rows else none
