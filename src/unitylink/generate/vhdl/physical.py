# SPDX-License-Identifier: BSD-3-Clause
"""Physical layers that a generated top level can have: their pins, generics and instance."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.protocol import RS485_NODES_MAX

from ..quoting import Vhdl

_BUS_FIFO_BYTES = 256  # a chip moves bytes in bursts
_LINE_FIFO_BYTES = 16
_DEPTHS = Vhdl("rx_depth => fifo_bytes, tx_depth => fifo_bytes")


@dataclass(frozen=True)
class Item:
    """A generic or a port: its name, the rest of its declaration, and the port of the entity to which it
    goes.
    """

    name: str
    declaration: Vhdl
    to: str = ""


@dataclass(frozen=True)
class PhysicalLayer:
    """What the template needs to know about a layer.

    An instance has the name of its entity in gateware/physical.
    """

    entity: str
    what: Vhdl  # "a UART"
    generics: tuple[Item, ...]  # generics of the top level; clock_hz is always there
    generic_map: Vhdl  # generic map of the entity
    ports: tuple[Item, ...]
    more: tuple[Vhdl, ...]  # lines of the entity's port map for ports that do not go directly to pins
    generics_manual: Vhdl
    ports_manual: Vhdl
    example: Vhdl  # a port map in a user's design
    example_generics: str = ""
    signals: tuple[Vhdl, ...] = ()
    statements: tuple[Vhdl, ...] = ()

    @property
    def port_map(self) -> tuple[Vhdl, ...]:
        return (*(Vhdl.of("{} => {}", item.to, item.name) for item in self.ports if item.to), *self.more)


def physical_layer(configuration: BoardConfiguration, baud_hz: int) -> PhysicalLayer:
    """Return the layer that `configuration` names. `baud_hz` is the rate of a serial line."""
    if configuration.physical == "uart":
        return _uart(configuration.fifo or _LINE_FIFO_BYTES, baud_hz)
    if configuration.physical == "rs485":
        return _rs485(configuration, baud_hz)
    if configuration.physical == "spi":
        return _spi(configuration.fifo or _BUS_FIFO_BYTES)
    return _ft245(configuration, synchronous=configuration.physical == "ft245_sync")


def _fifo(fifo_bytes: int) -> Item:
    return Item("fifo_bytes", Vhdl.of("positive := {}", fifo_bytes))


def _fifo_manual(fifo_bytes: int, before: str = "") -> Vhdl:
    return Vhdl.of(
        "{}fifo_bytes: buffers each way,\n"
        "--           a power of two; tell the PC (link option fifo=) if it is not {}.",
        before,
        fifo_bytes,
    )


def _uart(fifo_bytes: int, baud_hz: int) -> PhysicalLayer:
    return PhysicalLayer(
        entity="uart",
        what=Vhdl("a UART"),
        generics=(Item("baud_hz", Vhdl.of("positive := {}", baud_hz)), _fifo(fifo_bytes)),
        generic_map=Vhdl.of("clock_hz => clock_hz, baud_hz => baud_hz, {}", _DEPTHS),
        ports=(
            Item("rx_line", Vhdl("in  std_ulogic"), "rx_line"),
            Item("tx_line", Vhdl("out std_ulogic"), "tx_line"),
        ),
        more=(Vhdl("line_break => open"), Vhdl("rx_error => rx_error")),
        generics_manual=_fifo_manual(
            fifo_bytes, Vhdl("baud_hz: of the line, 8 data bits, 1 stop bit, no parity. ")
        ),
        ports_manual=Vhdl("rx_line, tx_line: asynchronous, idle high."),
        example=Vhdl("rx_line => usb_rx, tx_line => usb_tx"),
        example_generics=Vhdl(", baud_hz => 3_000_000"),
    )


def _rs485(configuration: BoardConfiguration, baud_hz: int) -> PhysicalLayer:
    fifo_bytes = configuration.fifo or _BUS_FIFO_BYTES
    return PhysicalLayer(
        entity="rs485",
        what=Vhdl("an RS-485 transceiver, as one of many nodes"),
        generics=(
            Item("baud_hz", Vhdl.of("positive := {}", baud_hz)),
            Item("rs485_node", Vhdl.of("positive range 1 to {} := {}", RS485_NODES_MAX, configuration.node)),
            _fifo(fifo_bytes),
        ),
        generic_map=Vhdl.of("clock_hz => clock_hz, baud_hz => baud_hz, {}", _DEPTHS),
        ports=(
            Item("rs485_rx", Vhdl("in  std_ulogic"), "rx_line"),
            Item("rs485_tx", Vhdl("out std_ulogic"), "tx_line"),
            Item("rs485_drive", Vhdl("out std_ulogic"), "drive"),
        ),
        more=(
            Vhdl("node => std_ulogic_vector(ieee.numeric_std.to_unsigned(rs485_node, 6))"),
            Vhdl("rx_error => rx_error"),
            Vhdl("tx_last => tx_last"),
        ),
        generics_manual=_fifo_manual(
            fifo_bytes, Vhdl("baud_hz: of the pair. rs485_node: this one's number on it. ")
        ),
        ports_manual=Vhdl("rs485_rx, rs485_tx: RO and DI of the transceiver; rs485_drive: its DE and RE#."),
        example=Vhdl("rs485_rx => ro, rs485_tx => di, rs485_drive => de"),
        example_generics=Vhdl.of(", baud_hz => 3_000_000, rs485_node => {}", configuration.node),
    )


def _spi(fifo_bytes: int) -> PhysicalLayer:
    names = {"sck": "in", "cs_n": "in", "mosi": "in", "miso": "out", "miso_drive": "out", "waiting": "out"}
    ports = tuple(Item(f"spi_{name}", Vhdl.of("{:<3} std_ulogic", way), name) for name, way in names.items())
    return PhysicalLayer(
        entity="spi_slave",
        what=Vhdl("an SPI master"),
        generics=(_fifo(fifo_bytes),),
        generic_map=_DEPTHS,
        ports=ports,
        more=(Vhdl("rx_error => rx_error"), Vhdl("tx_last => tx_last")),
        generics_manual=_fifo_manual(fifo_bytes),
        ports_manual=Vhdl("spi_*: mode 0; spi_waiting is high while there is something for the PC."),
        example=_as_named(ports),
    )


def _ft245(configuration: BoardConfiguration, *, synchronous: bool) -> PhysicalLayer:
    entity = configuration.physical
    fifo_bytes = configuration.fifo or _BUS_FIFO_BYTES
    inputs = ["rxf_n", "txe_n"]
    outputs = ["rd_n", "wr_n", "siwu_n"]
    if synchronous:
        inputs.insert(0, "clkout")
        outputs.insert(0, "oe_n")
    clock = Vhdl("" if synchronous else "clock_hz => clock_hz, ")
    entity_names = {"clkout": "chip_clock"}
    pins = [Item(f"ft245_{name}", Vhdl("in  std_ulogic"), entity_names.get(name, name)) for name in inputs]
    pins += [Item(f"ft245_{name}", Vhdl("out std_ulogic"), name) for name in outputs]
    pins += [
        Item("ft245_data_in", Vhdl("in  std_ulogic_vector(7 downto 0)"), "data_in"),
        Item("ft245_data_out", Vhdl("out std_ulogic_vector(7 downto 0)"), "data_out"),
        Item("ft245_data_drive", Vhdl("out std_ulogic_vector(7 downto 0)")),
    ]
    mode = Vhdl("synchronous") if synchronous else Vhdl("asynchronous")
    return PhysicalLayer(
        entity=entity,
        what=Vhdl.of("an FTDI chip in {} FT245 mode", mode),
        generics=(
            Item("send_immediate", Vhdl.of("send_immediate_t := {}", configuration.send_immediate)),
            _fifo(fifo_bytes),
        ),
        generic_map=Vhdl.of("{}send_immediate => send_immediate, {}", clock, _DEPTHS),
        ports=tuple(pins),
        more=(
            Vhdl("data_drive => data_drive"),
            Vhdl("tx_last => tx_last"),
            Vhdl("tx_publish => tx_publish"),
        ),
        generics_manual=Vhdl.of("send_immediate: see {}.vhd. {}", entity, _fifo_manual(fifo_bytes)),
        ports_manual=Vhdl(
            "ft245_*: the chip's pins; data pin i belongs to ft245_data_out(i) while "
            "ft245_data_drive(i) is high.\n--          "
        ),
        example=_as_named(pins),
        signals=(Vhdl("data_drive : std_ulogic"),),
        statements=(
            Vhdl("ft245_data_drive <= (others => data_drive);"),
            Vhdl("rx_error <= no_receive_error;"),
        ),
    )


def _as_named(items: Iterable[Item]) -> Vhdl:
    """Return a port map in which each signal has the name of its port."""
    return Vhdl(", ").join(Vhdl.of("{} => {}", item.name, item.name) for item in items)
