# SPDX-License-Identifier: BSD-3-Clause
"""Physical layers a generated top level can have: their pins, generics and instance."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink.board_configuration import BoardConfiguration
from unitylink.protocol import RS485_NODES_MAX

_BUS_FIFO_BYTES = 256  # a chip gives and takes bursts
_LINE_FIFO_BYTES = 16
_DEPTHS = "rx_depth => fifo_bytes, tx_depth => fifo_bytes"


@dataclass(frozen=True)
class Item:
    """A generic or a port: its name, the rest of its declaration, and the port of the entity it goes to."""

    name: str
    declaration: str
    to: str = ""


@dataclass(frozen=True)
class PhysicalLayer:
    """What the template says of a layer; an instance has the name of its entity in gateware/physical."""

    entity: str
    what: str  # "a UART"
    generics: tuple[Item, ...]  # of the top level; clock_hz is there anyway
    generic_map: str  # of the entity
    ports: tuple[Item, ...]
    more: tuple[str, ...]  # of the entity's port map: what does not go to pins as it is
    generics_manual: str
    ports_manual: str
    example: str  # a port map of a user's
    example_generics: str = ""
    signals: tuple[str, ...] = ()
    statements: tuple[str, ...] = ()

    @property
    def port_map(self) -> tuple[str, ...]:
        return (*(f"{item.to} => {item.name}" for item in self.ports if item.to), *self.more)


def physical_layer(configuration: BoardConfiguration, baud_hz: int) -> PhysicalLayer:
    """Return the layer that `configuration` names; `baud_hz` is that of a line."""
    if configuration.physical == "uart":
        return _uart(configuration.fifo or _LINE_FIFO_BYTES, baud_hz)
    if configuration.physical == "rs485":
        return _rs485(configuration, baud_hz)
    if configuration.physical == "spi":
        return _spi(configuration.fifo or _BUS_FIFO_BYTES)
    return _ft245(configuration, synchronous=configuration.physical == "ft245_sync")


def _fifo(fifo_bytes: int) -> Item:
    return Item("fifo_bytes", f"positive := {fifo_bytes}")


def _fifo_manual(fifo_bytes: int) -> str:
    told = f"a power of two; tell the PC (link option fifo=) if it is not {fifo_bytes}."
    return f"fifo_bytes: buffers each way,\n--           {told}"


def _uart(fifo_bytes: int, baud_hz: int) -> PhysicalLayer:
    return PhysicalLayer(
        entity="uart",
        what="a UART",
        generics=(Item("baud_hz", f"positive := {baud_hz}"), _fifo(fifo_bytes)),
        generic_map=f"clock_hz => clock_hz, baud_hz => baud_hz, {_DEPTHS}",
        ports=(
            Item("rx_line", "in  std_ulogic", "rx_line"),
            Item("tx_line", "out std_ulogic", "tx_line"),
        ),
        more=("line_break => open", "rx_error => rx_error"),
        generics_manual="baud_hz: of the line, 8 data bits, 1 stop bit, no parity. "
        + _fifo_manual(fifo_bytes),
        ports_manual="rx_line, tx_line: asynchronous, idle high.",
        example="rx_line => usb_rx, tx_line => usb_tx",
        example_generics=", baud_hz => 3_000_000",
    )


def _rs485(configuration: BoardConfiguration, baud_hz: int) -> PhysicalLayer:
    fifo_bytes = configuration.fifo or _BUS_FIFO_BYTES
    return PhysicalLayer(
        entity="rs485",
        what="an RS-485 transceiver, as one of many nodes",
        generics=(
            Item("baud_hz", f"positive := {baud_hz}"),
            Item("rs485_node", f"positive range 1 to {RS485_NODES_MAX} := {configuration.node}"),
            _fifo(fifo_bytes),
        ),
        generic_map=f"clock_hz => clock_hz, baud_hz => baud_hz, {_DEPTHS}",
        ports=(
            Item("rs485_rx", "in  std_ulogic", "rx_line"),
            Item("rs485_tx", "out std_ulogic", "tx_line"),
            Item("rs485_drive", "out std_ulogic", "drive"),
        ),
        more=(
            "node => std_ulogic_vector(ieee.numeric_std.to_unsigned(rs485_node, 6))",
            "rx_error => rx_error",
            "tx_last => tx_last",
        ),
        generics_manual="baud_hz: of the pair. rs485_node: this one's number on it. "
        + _fifo_manual(fifo_bytes),
        ports_manual="rs485_rx, rs485_tx: RO and DI of the transceiver; rs485_drive: its DE and RE#.",
        example="rs485_rx => ro, rs485_tx => di, rs485_drive => de",
        example_generics=f", baud_hz => 3_000_000, rs485_node => {configuration.node}",
    )


def _spi(fifo_bytes: int) -> PhysicalLayer:
    names = {"sck": "in", "cs_n": "in", "mosi": "in", "miso": "out", "miso_drive": "out", "waiting": "out"}
    ports = tuple(Item(f"spi_{name}", f"{way:<3} std_ulogic", name) for name, way in names.items())
    return PhysicalLayer(
        entity="spi_slave",
        what="an SPI master",
        generics=(_fifo(fifo_bytes),),
        generic_map=_DEPTHS,
        ports=ports,
        more=("rx_error => rx_error", "tx_last => tx_last"),
        generics_manual=_fifo_manual(fifo_bytes),
        ports_manual="spi_*: mode 0; spi_waiting is high while there is something for the PC.",
        example=", ".join(f"{port.name} => {port.name}" for port in ports),
    )


def _ft245(configuration: BoardConfiguration, *, synchronous: bool) -> PhysicalLayer:
    entity = configuration.physical
    fifo_bytes = configuration.fifo or _BUS_FIFO_BYTES
    inputs = ["rxf_n", "txe_n"]
    outputs = ["rd_n", "wr_n", "siwu_n"]
    if synchronous:
        inputs.insert(0, "clkout")
        outputs.insert(0, "oe_n")
    clock = "" if synchronous else "clock_hz => clock_hz, "
    entity_names = {"clkout": "chip_clock"}
    pins = [Item(f"ft245_{name}", "in  std_ulogic", entity_names.get(name, name)) for name in inputs]
    pins += [Item(f"ft245_{name}", "out std_ulogic", name) for name in outputs]
    byte = "std_ulogic_vector(7 downto 0)"
    pins += [
        Item("ft245_data_in", f"in  {byte}", "data_in"),
        Item("ft245_data_out", f"out {byte}", "data_out"),
        Item("ft245_data_drive", f"out {byte}"),
    ]
    return PhysicalLayer(
        entity=entity,
        what=f"an FTDI chip in {'synchronous' if synchronous else 'asynchronous'} FT245 mode",
        generics=(
            Item("send_immediate", f"send_immediate_t := {configuration.send_immediate}"),
            _fifo(fifo_bytes),
        ),
        generic_map=f"{clock}send_immediate => send_immediate, {_DEPTHS}",
        ports=tuple(pins),
        more=("data_drive => data_drive", "tx_last => tx_last", "tx_publish => tx_publish"),
        generics_manual=f"send_immediate: see {entity}.vhd. {_fifo_manual(fifo_bytes)}",
        ports_manual="ft245_*: the chip's pins; data pin i belongs to ft245_data_out(i) while "
        "ft245_data_drive(i) is high.\n--          ",
        example=", ".join(f"{pin.name} => {pin.name}" for pin in pins),
        signals=("data_drive : std_ulogic",),
        statements=("ft245_data_drive <= (others => data_drive);", "rx_error <= no_receive_error;"),
    )
