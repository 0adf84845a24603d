# SPDX-License-Identifier: BSD-3-Clause
"""The plan of a generated design. It has every decision, and the templates only lay it out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from unitylink.interface.board_configuration import BoardConfiguration, TosnetConfiguration
from unitylink.interface.engine import byte_clocks_min

from ..quoting import Part, Vhdl
from .functions import Function
from .physical import PhysicalLayer
from .records import Tree
from .value_types import Declaration
from .words import WordMap


@dataclass(frozen=True)
class Constant:
    name: str
    type: Vhdl
    value: Vhdl
    remark: str


@dataclass(frozen=True)
class Given:
    """A setting of the core."""

    name: str
    value: Vhdl
    remark: str


@dataclass(frozen=True)
class Wire:
    """A word of a slave: its offset in the slave, and its index in each port of the design.

    None means that it is not in that port.
    """

    offset: int
    read: int | None
    write: int | None
    pulse: bool = False  # the user's logic sees it for one clock
    taken: bool = False  # a read clears it, and the user's logic gets a strobe


@dataclass(frozen=True)
class Registers:
    """A register_slave."""

    number: int  # number of the slave on the bus
    span: str
    words: int
    writable: str
    initial: tuple[Vhdl, ...]
    snapshot: bool
    wires: tuple[Wire, ...]
    holes: tuple[range, ...]

    @property
    def taken(self) -> bool:
        return any(wire.taken for wire in self.wires)


@dataclass(frozen=True)
class NodePort:
    """A value of the spec as a port of its node's entity.

    `offset` is its word in the node's map. `index` is its first word in the ports of a design with this node.
    """

    name: str
    offset: int
    words: int
    to_node: bool
    index: int | None = None


@dataclass(frozen=True)
class NodeConstant:
    """A word that a node writes to a register of a component, and the one while the ring does not run."""

    value: Vhdl
    safe: Vhdl


@dataclass(frozen=True)
class NodeParts:
    """The components in a node. `carried_in` and `carried_out` are words of its map, in their order."""

    components: tuple[Placed, ...]
    ranges: tuple[Range, ...]
    wires: int
    constants: tuple[NodeConstant, ...]
    carried_in: tuple[int, ...]
    carried_out: tuple[int, ...]
    write_addresses: Vhdl
    read_addresses: Vhdl


@dataclass(frozen=True)
class RingNode:
    """A node behind the line of a TosNet. It `takes` so many words of the PC, and `gives` so many."""

    number: int  # its place in the ring; the PC's own node is 0
    id: int
    registers: Vhdl
    read_addresses: Vhdl
    write_addresses: Vhdl
    takes: int
    gives: int
    ports: tuple[NodePort, ...]
    safe_addresses: Vhdl
    safe_values: Vhdl
    parts: NodeParts | None

    @property
    def pins(self) -> tuple[Port, ...]:
        """The pins of its components."""
        components = self.parts.components if self.parts else ()
        return tuple(port for component in components for port in component.ports)

    @property
    def port_width(self) -> int:
        """Characters of the longest name of a port."""
        names = [port.name for port in self.ports] + [port.name for port in self.pins]
        return max([8, *map(len, names)])


@dataclass(frozen=True)
class Tosnet:
    """A tosnet_slave. Nodes and addresses are VHDL aggregates."""

    number: int
    configuration: TosnetConfiguration
    master_registers: Vhdl
    nodes: Vhdl
    cycle_hz: int
    read_addresses: Vhdl
    write_addresses: Vhdl
    spec_word: Vhdl  # from which spec bridge and nodes were built
    reads: tuple[Wire, ...]
    writes: tuple[Wire, ...]
    samples: int  # of the line in each clock; more than one come from a DDR or SERDES input
    lines: tuple[int, ...]  # the event lines that are the network cycle
    ring: tuple[RingNode, ...]  # the other nodes, in the order of the ring

    @property
    def line_in(self) -> Vhdl:
        """The type of the lines' input."""
        return _bits(self.samples * self.configuration.rings)

    @property
    def line_out(self) -> Vhdl:
        """The type of the lines' output."""
        return _bits(self.configuration.rings)

    @property
    def timed(self) -> bool:
        """Do its nodes share a clock?"""
        return self.configuration.time is not None

    @property
    def options(self) -> tuple[tuple[str, Vhdl], ...]:
        """What is beyond the published network, as generics."""
        one = self.configuration
        given = (
            ("rings", Vhdl.of("{}", one.rings), one.rings > 1),
            ("check_bytes", Vhdl.of("{}", one.check_bytes), one.check_bytes > 1),
            ("exact_hops", Vhdl("true"), one.exact_hops),
            ("time_address", Vhdl.of("16#{:03X}#", one.time or 0), self.timed),
        )
        return tuple((name, value) for name, value, used in given if used)

    @property
    def lines_here(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """Of each node in the design, from which line each of its rings comes, and to which it goes.

        The first is the PC's own. The second ring goes the other way round.
        """
        count = 1 + len(self.here)
        ways = range(self.configuration.rings)
        return tuple(
            tuple((way * count + (place + 2 * way - 1) % count, way * count + place) for way in ways)
            for place in range(count)
        )

    @property
    def here(self) -> tuple[RingNode, ...]:
        """The nodes that are in the design, too: in a simulation."""
        return self.ring if self.configuration.ring == "inside" else ()


def _bits(count: int) -> Vhdl:
    """Return the type of one bit or more."""
    plain = Vhdl("std_ulogic")
    return plain if count == 1 else Vhdl.of("{}_vector({} downto 0)", plain, count - 1)


@dataclass(frozen=True)
class Range:
    """A line of the interconnect's address map."""

    number: int
    base: Vhdl
    words: int
    remark: str


@dataclass(frozen=True)
class Port:
    """A port of a component or a link's slave, as a port of the design.

    `pin` means that it leaves the chip.
    """

    name: str
    direction: str
    type: Vhdl
    pin: bool = True


@dataclass(frozen=True)
class Placed:
    """A component: an instance of its entity, of the gateware or of the user."""

    number: int  # number of the slave on the bus
    path: str
    span: str
    library: str  # "unitylink", or "work" for VHDL of the user
    entity: str
    generics: tuple[tuple[str, Part], ...]
    pins: tuple[tuple[str, str], ...]  # (its port, the design's port)
    events: tuple[tuple[str, tuple[int, ...]], ...]  # (its port, the event lines)
    wires: tuple[tuple[str, int], ...] = ()  # (its port, the number of the wire)
    ports: tuple[Port, ...] = ()  # of the design, or of the node in which it is


@dataclass(frozen=True)
class EventSource:
    """Event lines that are driven from outside. `number` is an index or a range."""

    number: Vhdl
    source: Vhdl


@dataclass(frozen=True)
class Change:
    """A publish group whose event is a change of one of its words, given by their indices in `read_words`."""

    number: int
    words: tuple[int, ...]


@dataclass(frozen=True)
class Plan:
    name: str
    source: str
    hash: str
    configuration: BoardConfiguration
    baud_hz: int
    layer: PhysicalLayer
    settings: tuple[Given, ...]
    safe_values: Constant
    addresses: tuple[Constant, ...]
    words: WordMap
    ranges: tuple[Range, ...]
    registers: tuple[Registers, ...]
    tosnet: Tosnet | None
    components: tuple[Placed, ...]
    ports: tuple[Port, ...]
    lines: tuple[Constant, ...]  # names of event lines
    event_sources: tuple[EventSource, ...]
    changes: tuple[Change, ...]
    types: tuple[Declaration, ...]
    to_pc: Tree
    from_pc: Tree
    written: Tree
    was_read: Tree
    functions: tuple[Function, ...]

    @property
    def byte_clocks_min(self) -> int:
        """The fewest clocks that a byte may take on the line. It is 0 if there is no line, or no limit."""
        line = any(item.name == "baud_hz" for item in self.layer.generics)
        small = line and self.configuration.engine == "small"
        return byte_clocks_min(self.configuration.publish_mode) if small else 0

    @cached_property
    def setting_width(self) -> int:
        """Characters of the longest setting's name."""
        return max(len(setting.name) for setting in self.settings)

    @cached_property
    def address_width(self) -> int:
        """Characters of the longest address's name."""
        return max(len(address.name) for address in self.addresses)

    @property
    def wires(self) -> int:
        """How many wires there are between components."""
        numbers = [number for component in self.components for _, number in component.wires]
        return max(numbers, default=-1) + 1

    @property
    def pins(self) -> tuple[Port, ...]:
        """The ports of components that leave the chip. The others are for the user's logic."""
        return tuple(port for port in self.ports if port.pin)

    @property
    def declarations(self) -> tuple[Declaration, ...]:
        """The declarations of the user's package, each after those that it uses."""
        trees = (self.to_pc, self.from_pc, self.written, self.was_read)
        return (*self.types, *(one for tree in trees for one in tree.declarations))
