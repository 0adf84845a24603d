# SPDX-License-Identifier: BSD-3-Clause
"""Every decision about the generated VHDL: the templates only lay it out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from unitylink import protocol
from unitylink.board_configuration import BoardConfiguration, TosnetConfiguration
from unitylink.errors import BindingError
from unitylink.spec.model import Element, Spec

from . import records
from .blocks import Block, blocks
from .names import Names, identifier, remark
from .words import WordMap, tosnet_range, word_map

# What a virtual board can have and a generated design has not: means of testing, slaves that no spec names.
_ONLY_ON_THE_TWIN = ("bench_memory", "bus_error_ranges", "silent_ranges", "fifos", "double_buffers")
# Of the UART, where the configuration does not say.
_BAUD_HZ = 3_000_000
_FIFO_BYTES = 16


@dataclass(frozen=True)
class Constant:
    name: str
    type: str
    value: str
    remark: str


@dataclass(frozen=True)
class Wire:
    """A word of a slave: its offset there, and its index in each port of the design, None where not there."""

    offset: int
    read: int | None
    write: int | None


@dataclass(frozen=True)
class Registers:
    """A register_slave."""

    number: int  # of the slave on the bus
    span: str
    words: int
    writable: str
    snapshot: bool
    wires: tuple[Wire, ...]
    holes: tuple[int, ...]


@dataclass(frozen=True)
class Tosnet:
    """A tosnet_slave; nodes and addresses are aggregates."""

    number: int
    configuration: TosnetConfiguration
    master_registers: str
    nodes: str
    cycle_hz: int
    read_addresses: str
    write_addresses: str
    reads: tuple[Wire, ...]
    writes: tuple[Wire, ...]


@dataclass(frozen=True)
class Range:
    """A line of the interconnect's address map."""

    number: int
    base: str
    words: int
    remark: str


@dataclass(frozen=True)
class Function:
    """Turns a record into a vector or back, a line a word."""

    name: str
    parameter: str
    takes: str
    gives: str
    result: str
    variable: str
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    name: str
    source: str
    hash: str
    configuration: BoardConfiguration
    baud_hz: int
    fifo_bytes: int
    generics: tuple[Constant, ...]
    addresses: tuple[Constant, ...]
    words: WordMap
    ranges: tuple[Range, ...]
    registers: tuple[Registers, ...]
    tosnet: Tosnet | None
    to_pc: records.Tree
    from_pc: records.Tree
    written: records.Tree
    functions: tuple[Function, ...]

    @property
    def generic_width(self) -> int:
        """Characters of the longest generic's name."""
        return max(len(generic.name) for generic in self.generics)

    @property
    def address_width(self) -> int:
        """Characters of the longest address's name."""
        return max(len(address.name) for address in self.addresses)

    @property
    def trees(self) -> tuple[records.Tree, ...]:
        return self.to_pc, self.from_pc, self.written


def plan(spec: Spec, configuration: BoardConfiguration | None = None) -> Plan:
    """Plan the design of a spec on the gateware of `configuration`, by default what the spec asks for."""
    return _Planner(spec, configuration or BoardConfiguration.for_spec(spec)).plan()


class _Planner:
    def __init__(self, spec: Spec, configuration: BoardConfiguration) -> None:
        _check(configuration)
        self.spec = spec
        self.configuration = configuration
        self.words = word_map(spec, configuration)
        self.in_tosnet = tosnet_range(configuration)
        for path, element in spec.walk():
            if element.address >> configuration.address_bits:
                bits = configuration.address_bits
                raise BindingError(f"vhdl: {path} lies at 0x{element.address:X}; address_bits is {bits}")

    def plan(self) -> Plan:
        slaves = 1 if self.in_tosnet else 0
        addresses = {element.address for _, element in self.spec.walk()} - set(self.in_tosnet)
        plain = blocks(addresses, self.in_tosnet)
        names = Names()
        to_pc = records.to_pc(self.spec, self.words, names, self._word)
        from_pc = records.from_pc(self.spec, self.words, names, self._word)
        written = records.written(self.spec, self.words, names)
        return Plan(
            name=identifier(self.spec.name),
            source=remark(self.spec.source),
            hash=self.spec.hash,
            configuration=self.configuration,
            baud_hz=self.configuration.baud_hz or _BAUD_HZ,
            fifo_bytes=self.configuration.fifo or _FIFO_BYTES,
            generics=_generics(self.configuration),
            addresses=self._address_constants(),
            words=self.words,
            ranges=(*self._tosnet_range(), *(_range(n, block) for n, block in enumerate(plain, slaves))),
            registers=tuple(self._registers(number, block) for number, block in enumerate(plain, slaves)),
            tosnet=self._tosnet(),
            to_pc=to_pc,
            from_pc=from_pc,
            written=written,
            functions=tuple(
                make(tree, width, self.configuration.data_bits)
                for make, tree, width in (
                    (_to_words, to_pc, 32 * len(self.words.read)),
                    (_from_words, from_pc, 32 * len(self.words.write)),
                    (_from_strobes, written, len(self.words.write)),
                )
                if tree.leaves
            ),
        )

    def _word(self, element: Element) -> str:
        kind = "signed" if element.signed else "unsigned"
        return f"{kind}({self.configuration.data_bits - 1} downto 0)"

    def _address_constants(self) -> tuple[Constant, ...]:
        names = Names()
        return tuple(
            Constant(
                f"{names.claim(path)}_address",
                "unsigned(31 downto 0)",
                _hex(element.address),
                _facts(element),
            )
            for path, element in self.spec.walk()
        )

    def _registers(self, number: int, block: Block) -> Registers:
        offsets = [address - block.base for address in block.addresses]
        return Registers(
            number=number,
            span=_span(block.base, block.words),
            words=block.words,
            writable=block.writable(self.words),
            snapshot=any(address in self.words.read for address in block.addresses),
            wires=tuple(self._wire(block.base, offset) for offset in offsets),
            holes=tuple(offset for offset in range(block.words) if offset not in offsets),
        )

    def _wire(self, base: int, offset: int) -> Wire:
        address = base + offset
        return Wire(offset, self.words.read.get(address), self.words.write.get(address))

    def _tosnet_range(self) -> tuple[Range, ...]:
        inside = self.in_tosnet
        return (Range(0, _hex(inside.start), len(inside), "TosNet"),) if inside else ()

    def _tosnet(self) -> Tosnet | None:
        tosnet = self.configuration.tosnet
        if tosnet is None:
            return None
        reads = self._inside_tosnet(self.words.read)
        writes = self._inside_tosnet(self.words.write)
        nodes = [f'(id => {node.id}, registers => x"{node.registers:02X}")' for node in tosnet.nodes]
        return Tosnet(
            number=0,
            configuration=tosnet,
            master_registers=f'x"{tosnet.master_registers:02X}"',
            nodes=_aggregate(nodes, "tosnet_no_nodes_c"),
            cycle_hz=round(1 / tosnet.cycle_s),
            read_addresses=_aggregate(_offsets(reads, tosnet.base), "tosnet_no_addresses_c"),
            write_addresses=_aggregate(_offsets(writes, tosnet.base), "tosnet_no_addresses_c"),
            reads=tuple(Wire(n, self.words.read[address], None) for n, address in enumerate(reads)),
            writes=tuple(Wire(n, None, self.words.write[address]) for n, address in enumerate(writes)),
        )

    def _inside_tosnet(self, indices: Mapping[int, int]) -> list[int]:
        return [address for address in indices if address in self.in_tosnet]


def _check(configuration: BoardConfiguration) -> None:
    plain = BoardConfiguration()
    for field in _ONLY_ON_THE_TWIN:
        if getattr(configuration, field) != getattr(plain, field):
            raise BindingError(f"vhdl: {field} of a board configuration is for virtual boards; leave it out")
    limits = {
        "address_bits": (1, protocol.ADDRESS_BITS_MAX),
        "data_bits": (protocol.DATA_BITS_MIN, protocol.DATA_BITS_MAX),
        "groups": (1, protocol.GROUPS_MAX),
        "group_size": (1, protocol.GROUP_SIZE_MAX),
        "read_many": (0, protocol.READ_MANY_MAX),
        "rate_bytes": (1, protocol.RATE_BYTES_MAX),
        "publish_mode": (0, 2),
        "polynomial": (0, 255),
    }
    for field, (least, most) in limits.items():
        value = getattr(configuration, field)
        if not least <= value <= most:
            raise BindingError(f"vhdl: {field} is {value}; the gateware takes {least} to {most}")


def _generics(configuration: BoardConfiguration) -> tuple[Constant, ...]:
    """Return the generics of the core, under their own names."""
    edges = sum(1 << group for group in configuration.edge_event_groups)
    events = f'x"{edges:064X}"' if edges else "(others => '0')"
    switch = str(configuration.configuration_command).lower()
    modes = "0 none, 1 requests first, 2 publishes first"
    return (
        Constant("address_width", "positive", str(configuration.address_bits), "bits"),
        Constant("data_width", "positive", str(configuration.data_bits), "bits"),
        Constant("base_hz", "positive", str(configuration.base_hz), "of publishing"),
        Constant("groups", "positive", str(configuration.groups), "of publishing"),
        Constant("group_size", "positive", str(configuration.group_size), "addresses a group can have"),
        Constant("rate_bytes", "positive", str(configuration.rate_bytes), "of a group's divisor"),
        Constant("read_many", "natural", str(configuration.read_many), "most words of a read-many"),
        Constant("publish_mode", "natural", str(configuration.publish_mode), modes),
        Constant("configuration_command", "boolean", switch, "RLC exists"),
        Constant("checksum", "string", f'"{configuration.checksum}"', ""),
        Constant("polynomial", "natural", f"16#{configuration.polynomial:02X}#", "of crc8"),
        Constant(
            "edge_events", "std_ulogic_vector(255 downto 0)", events, "bit g: group g by edge, not level"
        ),
    )


def _to_words(tree: records.Tree, width: int, bits: int) -> Function:
    lines = ["words := (others => '0');"]
    lines += [f"words({_slice(leaf, bits)}) := std_ulogic_vector(to_pc.{leaf.path});" for leaf in tree.leaves]
    return Function(
        "to_words", "to_pc", tree.type, "std_ulogic_vector", "words", _vector(width), tuple(lines)
    )


def _from_words(tree: records.Tree, width: int, bits: int) -> Function:
    lines = tuple(f"from_pc.{leaf.path} := {leaf.kind}(words({_slice(leaf, bits)}));" for leaf in tree.leaves)
    return Function("from_words", "words", _vector(width), tree.type, "from_pc", tree.type, lines)


def _from_strobes(tree: records.Tree, width: int, bits: int) -> Function:
    lines = tuple(f"written.{leaf.path} := strobes({leaf.index});" for leaf in tree.leaves)
    return Function("from_strobes", "strobes", _vector(width), tree.type, "written", tree.type, lines)


def _vector(width: int) -> str:
    return f"std_ulogic_vector({width - 1} downto 0)"


def _slice(leaf: records.Leaf, bits: int) -> str:
    return f"{32 * leaf.index + bits - 1} downto {32 * leaf.index}"


def _range(number: int, block: Block) -> Range:
    return Range(number, _hex(block.base), block.words, _span(block.base, block.words))


def _hex(address: int) -> str:
    return f'x"{address:08X}"'


def _span(base: int, words: int) -> str:
    return f"0x{base:03X}" if words == 1 else f"0x{base:03X} to 0x{base + words - 1:03X}"


def _offsets(addresses: Iterable[int], base: int) -> list[str]:
    return [f"16#{address - base:03X}#" for address in addresses]


def _aggregate(values: list[str], none: str) -> str:
    """Return an aggregate, eight values a line where they are many."""
    rows = [values[start : start + 8] for start in range(0, len(values), 8)]
    lines = [
        ", ".join(f"{8 * row + n} => {value}" for n, value in enumerate(rows[row]))
        for row in range(len(rows))
    ]
    return f"({(',' + chr(10) + ' ' * 12).join(lines)})" if values else none


def _facts(element: Element) -> str:
    """Say what an element is; texts of the spec stand behind words of ours."""
    facts = [element.access, "signed" if element.signed else "unsigned"]
    facts += [f"in {element.unit}"] if element.unit else []
    facts += [f"published at the base rate / {element.publish.divisor}"] if element.publish else []
    shown = f": {element.display}" if element.display != element.path else ""
    return remark(", ".join(facts) + shown)
