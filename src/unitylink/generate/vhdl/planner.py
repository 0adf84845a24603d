# SPDX-License-Identifier: BSD-3-Clause
"""Every decision about the generated VHDL is made here. The templates only lay it out."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Union

from unitylink.errors import BindingError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.engine import sizes_of
from unitylink.protocol import DATA_BITS_MAX
from unitylink.spec.model import Element, Spec
from unitylink.spec.types import Number
from unitylink.values import Codec, Quantity

from ..quoting import Vhdl, file_name
from .blocks import Block, blocks
from .functions import from_strobes, from_words, to_words
from .link_slaves import LinkSlave, link_slaves
from .names import Names, identifier
from .physical import physical_layer
from .placing import place, span
from .plan import Change, Constant, EventSource, Placed, Plan, Port, Range, Registers, Wire
from .records import Tree, records
from .settings import safe_values_of, settings_of
from .tosnet import planned_tosnet
from .value_types import IEEE_NAMES, FieldType, Part, ValueTypes, width_of
from .words import PlacedComponent, components_of, named_elements, tosnet_range, wires_of, word_map

# Settings that a virtual board can have and a generated design cannot: means of testing, and slaves that no
# spec names.
_ONLY_ON_THE_TWIN = ("bus_error_ranges", "silent_ranges")
# For a UART, if neither the configuration nor the spec names a rate.
_BAUD_HZ = 3_000_000
# Ports that every design or top level may have. Names in their templates cannot be names of ports either.
_PORTS = ["clock", "reset", "user_reset", "events", "clock_hz", "baud_hz", "fifo_bytes", "rx_line", "tx_line"]
_PORTS += ["send_immediate", "ft245_clkout", "ft245_rxf_n", "ft245_txe_n", "ft245_oe_n", "ft245_rd_n"]
_PORTS += ["ft245_wr_n", "ft245_siwu_n", "ft245_data_in", "ft245_data_out", "ft245_data_drive"]
_PORTS += ["spi_sck", "spi_cs_n", "spi_mosi", "spi_miso", "spi_miso_drive", "spi_waiting"]
_PORTS += ["rs485_rx", "rs485_tx", "rs485_drive", "rs485_node"]
_PORTS += ["rx_valid", "rx_ready", "rx_data", "rx_error"]
_PORTS += ["tx_valid", "tx_ready", "tx_data", "tx_last", "tx_publish"]
_PORTS += ["read_words", "write_words", "written", "was_read", "to_pc", "from_pc", "tripped"]
RING_CUT = "ring_cut"  # in a simulation, the lines that are cut; the first is that of the PC's own node
_TEMPLATES = ("design.vhd.jinja", "node.vhd.jinja", "component.vhd.jinja", "top.vhd.jinja")
_STROBE = FieldType(Vhdl("std_ulogic"), (Part(Vhdl(""), "std_ulogic", 0, 0),))
_FieldOf = Callable[[Element], Union[FieldType, None]]


def plan_design(spec: Spec, configuration: BoardConfiguration | None = None) -> Plan:
    """Plan the design of a spec on `configuration`.

    By default this is what the spec needs, with both protocols.
    """
    return _Planner(spec, configuration or BoardConfiguration.for_spec(spec)).plan()


class _Planner:
    def __init__(self, spec: Spec, configuration: BoardConfiguration) -> None:
        _check(configuration)
        self.spec = spec
        self.configuration = configuration
        self.words = word_map(spec, configuration)
        self.in_tosnet = tosnet_range(configuration)
        self.parts = components_of(spec)
        self.slaves = link_slaves(spec)
        _check_slaves(self.slaves, configuration)
        self.ports: list[Port] = []
        self.wires = wires_of(self.parts)
        self.initialised = [
            (path, element, element.initial)
            for path, element in spec.walk()
            if element.initial is not None and element.writable
        ]
        self.accesses: dict[int, set[str]] = {}  # there are several if a PULSE shares its word with a READ
        for _, element in spec.walk():
            for address in element.addresses:
                self.accesses.setdefault(address, set()).add(element.access)
        for path, element in spec.walk():
            last, bits = element.addresses[-1], configuration.address_bits
            if last >> bits:
                raise BindingError(f"vhdl: {path} lies at 0x{last:X}; address_bits is {bits}")
        for slave in self.slaves:
            if slave.range.stop - 1 >> configuration.address_bits:
                raise BindingError(
                    f"vhdl: {slave.path} ends at 0x{slave.range.stop - 1:X}; "
                    f"address_bits is {configuration.address_bits}"
                )
            if slave.kind == "fifo" and slave.size >> configuration.data_bits:
                raise BindingError(
                    f"vhdl: {slave.path} holds {slave.size} words, a number that does not fit its words of "
                    f"{configuration.data_bits} bits; give it a smaller DEPTH"
                )

    def plan(self) -> Plan:
        first = 1 if self.in_tosnet else 0
        parts = [part for part in self.parts if part.component.words]
        others = [self.in_tosnet, *(part.range for part in parts), *(one.range for one in self.slaves)]
        taken = {address for other in others for address in other}
        addresses = {a for _, element in self.spec.walk() for a in element.addresses} - taken
        plain = blocks(addresses, others)
        numbered = list(enumerate(parts, first + len(plain)))
        slaves = list(enumerate(self.slaves, first + len(plain) + len(parts)))
        ports = Names([*_reserved_ports(), *(name for _, name, _ in named_elements(self.spec))])
        components = (
            *(self._component(number, part, ports) for number, part in numbered),
            *(self._link_slave(number, slave, ports) for number, slave in slaves),
        )
        tosnet = planned_tosnet(
            self.spec,
            self.configuration,
            self.words,
            lambda number, part, wires: self._node_component(number, part, wires, ports),
        )
        if tosnet is not None and tosnet.configuration.ring == "pins":
            self.ports += [
                Port("ring_in", "in", tosnet.line_in),
                Port("ring_out", "out", tosnet.line_out),
            ]
        elif tosnet is not None and tosnet.here:
            kind = Vhdl.of(
                "std_ulogic_vector(0 to {})", len(tosnet.lines_here) * tosnet.configuration.rings - 1
            )
            self.ports.append(Port(RING_CUT, "in", kind))
        inside = _inside(components) | set(tosnet.lines if tosnet else ())
        baud_hz = self.configuration.baud_hz or self._told_baud_hz() or _BAUD_HZ
        return Plan(
            name=identifier(self.spec.name),
            source=file_name(self.spec.source),
            hash=self.spec.hash,
            configuration=self.configuration,
            baud_hz=baud_hz,
            layer=physical_layer(self.configuration, baud_hz),
            settings=settings_of(self.configuration),
            safe_values=safe_values_of(self.configuration),
            addresses=self._address_constants(),
            words=self.words,
            ranges=(
                *self._tosnet_range(),
                *(_range(n, block.base, block.words) for n, block in enumerate(plain, first)),
                *(_range(n, part.component.base, part.component.words) for n, part in numbered),
                *(_range(n, one.base, one.words) for n, one in slaves),
            ),
            registers=tuple(self._registers(number, block) for number, block in enumerate(plain, first)),
            tosnet=tosnet,
            components=components,
            ports=tuple(self.ports),
            lines=self._event_lines(inside),
            event_sources=self._event_sources(inside),
            changes=self._changes(),
            **self._records(),
        )

    def _told_baud_hz(self) -> int | None:
        """Return the baud rate of the spec's links, or None if they name none."""
        told = {device.link.baud_hz for device in self.spec.devices}
        return told.pop() if len(told) == 1 else None

    def _records(self) -> dict[str, Any]:
        """Return the fields of the plan that make the user's package."""
        names, bits = Names(IEEE_NAMES), self.configuration.data_bits
        types = ValueTypes(names, bits)
        read, write = self.words.read, self.words.write
        # Elements of several devices may share an address. Then the word has one field, that of the first
        # one.
        first: dict[int, Element] = {}
        for _, element in self.spec.walk():
            if self.words.drives(element):
                first.setdefault(element.address, element)
        drivers = {id(element) for element in first.values()}

        def given(element: Element) -> FieldType | None:
            return types.of(element) if id(element) in drivers else None

        def seen(element: Element) -> FieldType | None:
            return types.of(element) if self.words.sees(element) else None

        def strobe(element: Element) -> FieldType | None:
            return _STROBE if self.words.sees(element) else None

        def taken(element: Element) -> FieldType | None:
            return _STROBE if element.access == "READCLEAR" and id(element) in drivers else None

        def place(direction: str, index_of: Callable[[Element], int], field: _FieldOf) -> Tree:
            return records(self.spec, direction, names, index_of, field, array_of=types.array_of)

        to_pc = place("to_pc", lambda e: read[e.address], given)
        from_pc = place("from_pc", lambda e: write[e.address], seen)
        written = place("written", lambda e: write[e.addresses[-1]], strobe)
        was_read = place("was_read", lambda e: read[e.address], taken)
        functions = (
            to_words(to_pc, len(read), bits),
            from_words(from_pc, len(write), bits),
            from_strobes("from_strobes", written, len(write)),
            from_strobes("from_reads", was_read, len(read)),
        )
        return {
            "types": tuple(types.declarations),
            "to_pc": to_pc,
            "from_pc": from_pc,
            "written": written,
            "was_read": was_read,
            "functions": tuple(function for function in functions if function.lines and function.takes),
        }

    def _component(self, number: int, part: PlacedComponent, ports: Names) -> Placed:
        events = self._lines_of(part.root, {port: f"{part.local}.{port}" for port in part.component.events})
        placed = place(number, part, self.wires, ports, data_width=self._data_width(), events=events)
        self.ports += placed.ports
        return placed

    def _node_component(
        self, number: int, part: PlacedComponent, wires: Mapping[tuple[str, str], int], ports: Names
    ) -> Placed:
        """Place a component in a node of a ring. Its pins are those of the design only in a simulation."""
        placed = place(number, part, wires, ports, data_width=Vhdl.of("{}", DATA_BITS_MAX))
        if self.configuration.tosnet is not None and self.configuration.tosnet.ring == "inside":
            self.ports += placed.ports
        return placed

    def _data_width(self) -> Vhdl:
        return Vhdl.of("{}_config_pkg.settings.data_bits", identifier(self.spec.name))

    def _link_slave(self, number: int, slave: LinkSlave, ports: Names) -> Placed:
        pins: list[tuple[str, str]] = []
        for pin in slave.pins(self.configuration.data_bits):
            name = ports.claim(f"{slave.path}_{pin.name}") if pin.used else pin.default
            pins.append((pin.name, name))
            if pin.used:
                kind = Vhdl.of("{} := {}" if pin.default else "{}", pin.type, pin.default)
                self.ports.append(Port(name, pin.direction, kind, pin=False))
        return Placed(
            number=number,
            path=slave.path,
            span=span(slave.base, slave.words),
            library="unitylink",
            entity=slave.entity,
            generics=tuple({**slave.generics(), "data_width": self._data_width()}.items()),
            pins=tuple(pins),
            events=self._lines_of(slave.root, slave.events()),
        )

    def _lines_of(self, root: str, events: Mapping[str, str]) -> tuple[tuple[str, tuple[int, ...]], ...]:
        """Return the event lines of each port that has any. `events` has the spec's names of the ports."""
        devices = [device for device in self.spec.devices if device.root == root]
        lines = {
            port: tuple(g.number for device in devices for g in device.groups if g.event == event)
            for port, event in events.items()
        }
        return tuple((port, numbers) for port, numbers in lines.items() if numbers)

    def _changes(self) -> tuple[Change, ...]:
        changes = []
        for device in self.spec.devices:
            for group in device.groups:
                if group.trigger == "change":
                    others = [element.path for element in group.elements if not self.words.drives(element)]
                    if others:
                        raise BindingError(
                            f"vhdl: {others[0]} is published on change, but your logic does not drive it; "
                            "publish it at a rate"
                        )
                    changes.append(Change(group.number, tuple(self.words.read[a] for a in group.addresses)))
        return tuple(changes)

    def _event_sources(self, inside: set[int]) -> tuple[EventSource, ...]:
        """Return the lines from outside, with one assignment for each range."""
        inside = inside | {change.number for change in self._changes()}
        runs = _runs(set(range(self.configuration.groups)) - inside)
        spans = [Vhdl.of("{} downto {}", run.stop - 1, run.start) for run in runs]
        return tuple(EventSource(span, Vhdl.of("events({})", span)) for span in spans)

    def _event_lines(self, inside: set[int]) -> tuple[Constant, ...]:
        """Return a constant for every event line that the user's logic drives, and for none in `inside`."""
        names = Names()
        kind, about = Vhdl("natural"), "index in events"
        return tuple(
            Constant(f"{names.claim(group.event)}_event", kind, Vhdl.of("{}", group.number), about)
            for device in self.spec.devices
            for group in device.groups
            if group.trigger == "event" and "." not in group.event and group.number not in inside
        )

    def _address_constants(self) -> tuple[Constant, ...]:
        """Return the address of each element, and its raw initial and SAFE values."""
        constants, kind = [], Vhdl("unsigned(31 downto 0)")
        for path, name, element in named_elements(self.spec):
            constants.append(Constant(f"{name}_address", kind, _hex(element.address), _facts(element)))
            for which, value in (("initial", element.initial), ("safe", element.safe)):
                if value is not None:
                    width = width_of(element, self.configuration.data_bits)
                    bits = Vhdl.of('"{}"', format(self._raw(path, element, value), f"0{width}b"))
                    vector = Vhdl.of("std_ulogic_vector({} downto 0)", width - 1)
                    constants.append(Constant(f"{name}_{which}", vector, bits, f"raw, of {value:g}"))
        return tuple(constants)

    def _raw(self, path: str, element: Element, value: Number) -> int:
        """Return the raw number of an engineering value."""
        if not element.type.numeric:
            return int(value)
        return Codec(path, Quantity.of(element), self.configuration.data_bits).encode(value)

    def _initial(self, block: Block) -> tuple[Vhdl, ...]:
        """Return the initial words of a block of registers as `offset => word`.

        There are none if all are zero.
        """
        words = {}
        for path, element, initial in self.initialised:
            if element.address in block.addresses:
                raw, bits = self._raw(path, element, initial), self.configuration.data_bits
                for number, address in enumerate(element.addresses):
                    words[address - block.base] = raw >> number * bits & (1 << bits) - 1
        given = sorted((offset, word) for offset, word in words.items() if word)
        return tuple(Vhdl.of('{} => x"{:08X}"', offset, word) for offset, word in given)

    def _registers(self, number: int, block: Block) -> Registers:
        offsets = [address - block.base for address in block.addresses]
        return Registers(
            number=number,
            span=span(block.base, block.words),
            words=block.words,
            writable=block.writable(self.words),
            initial=self._initial(block),
            snapshot=any(address in self.words.read for address in block.addresses),
            wires=tuple(self._wire(block.base, offset) for offset in offsets),
            holes=_runs(set(range(block.words)) - set(offsets)),
        )

    def _wire(self, base: int, offset: int) -> Wire:
        address = base + offset
        accesses = self.accesses.get(address, set())
        return Wire(
            offset,
            self.words.read.get(address),
            self.words.write.get(address),
            pulse="PULSE" in accesses,
            taken="READCLEAR" in accesses,
        )

    def _tosnet_range(self) -> tuple[Range, ...]:
        inside = self.in_tosnet
        return (Range(0, _hex(inside.start), len(inside), "TosNet"),) if inside else ()


@cache
def _reserved_ports() -> frozenset[str]:
    """Return the names that no port of a component may have: signals, labels and types of the design around
    it.
    """
    texts = [(Path(__file__).parent / name).read_text(encoding="utf-8") for name in _TEMPLATES]
    return frozenset([*_PORTS, *(word for text in texts for word in re.findall(r"[a-z]\w*", text))])


def _check(configuration: BoardConfiguration) -> None:
    for field in _ONLY_ON_THE_TWIN:
        if getattr(configuration, field):
            raise BindingError(f"vhdl: {field} of a board configuration is for virtual boards; leave it out")
    for name, fixed in sizes_of(configuration.engine).items():
        value = getattr(configuration, name)
        if value != fixed:
            raise BindingError(f"vhdl: {name} is {value}; gateware has {fixed}: leave it out")
    if wrong := configuration.beyond_frames() or configuration.strobes_too_near():
        raise BindingError(f"vhdl: {wrong}")


def _check_slaves(slaves: Sequence[LinkSlave], configuration: BoardConfiguration) -> None:
    """Check that the configuration has the slaves of the spec, because only the spec decides about them."""
    fifos = {("fifo", one.base, one.depth) for one in configuration.fifos}
    buffers = {("double_buffer", one.base, one.size) for one in configuration.double_buffers}
    if fifos | buffers != {(one.kind, one.base, one.size) for one in slaves}:
        raise BindingError(
            "vhdl: the FIFOs and double buffers of a design are those of its spec; "
            "make the board configuration with BoardConfiguration.for_spec"
        )


def _range(number: int, base: int, words: int) -> Range:
    return Range(number, _hex(base), words, span(base, words))


def _inside(components: Iterable[Placed]) -> set[int]:
    """Return the event lines that parts of the design drive."""
    return {line for component in components for _, lines in component.events for line in lines}


def _runs(numbers: set[int]) -> tuple[range, ...]:
    """Return the numbers as ranges without gaps.

    >>> _runs({1, 2, 5})
    (range(1, 3), range(5, 6))
    """
    starts = sorted(n for n in numbers if n - 1 not in numbers)
    ends = sorted(n + 1 for n in numbers if n + 1 not in numbers)
    return tuple(range(start, end) for start, end in zip(starts, ends, strict=True))


def _hex(address: int) -> Vhdl:
    return Vhdl.of('x"{:08X}"', address)


def _facts(element: Element) -> str:
    """Describe an element for a comment. Texts of the spec come after words of ours."""
    facts = [element.access, "signed" if element.signed else "unsigned"]
    facts += [f"in {element.unit}"] if element.unit else []
    if element.publish is not None:
        rate = f"at the base rate / {element.publish.divisor}"
        on = f"on {element.publish.event or element.publish.trigger}"
        facts.append(f"published {rate if element.publish.trigger == 'rate' else on}")
    shown = f": {element.display}" if element.display != element.path else ""
    return ", ".join(facts) + shown
