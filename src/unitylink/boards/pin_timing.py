# SPDX-License-Identifier: BSD-3-Clause
"""The timing of a design's pins, as constraints (SDC) that the tools of vendors read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from unitylink.gateware import Port
from unitylink.generate.quoting import Tcl

from .manifest import CHIP_CLOCK_HZ

SPI_HZ = 25_000_000  # the highest clock that spi_slave.md promises


@dataclass(frozen=True)
class PinTiming:
    """The pins of a physical layer. Times are in nanoseconds, seen from the FPGA.

    With a `clock` pin, the signals of `given` come between the two times of `given_ns` after its edge. The
    edge is falling if `falling`. Those of `wanted` must be stable before its next rising edge and after it,
    by the two times of `wanted_ns`. Without a clock, the times are the longest delays within the FPGA.
    """

    source: str
    given: tuple[str, ...]
    wanted: tuple[str, ...]
    given_ns: tuple[float, ...]
    wanted_ns: tuple[float, ...]
    clock: str = ""
    clock_hz: int = 0
    falling: bool = False


PIN_TIMING = {
    "ft245_sync": PinTiming(
        "DS_FT232H 2.1, table 4.1: the chip gives 0 to 9 ns after CLKOUT, and wants 7.5 ns before it",
        clock="ft245_clkout",
        clock_hz=CHIP_CLOCK_HZ,
        given=("ft245_rxf_n", "ft245_txe_n", "ft245_data_in", "ft245_data"),
        given_ns=(0, 9),
        wanted=("ft245_oe_n", "ft245_rd_n", "ft245_wr_n", "ft245_data_out", "ft245_data_drive", "ft245_data"),
        wanted_ns=(7.5, 0),
    ),
    "spi": PinTiming(
        "Mode 0: MOSI changes at falling edges. No standard has times; 5 ns each way are assumed",
        clock="spi_sck",
        clock_hz=SPI_HZ,
        falling=True,
        given=("spi_mosi",),
        given_ns=(-5, 5),
        wanted=("spi_miso",),
        wanted_ns=(5, 0),
    ),
    "ft245_async": PinTiming(
        "Generic pad_ns of ft245_async: 6 ns for a strobe and its answer, of which 4 ns on the way out",
        given=("ft245_rxf_n", "ft245_txe_n", "ft245_data_in", "ft245_data"),
        given_ns=(2,),
        wanted=("ft245_rd_n", "ft245_wr_n", "ft245_data_out", "ft245_data_drive", "ft245_data"),
        wanted_ns=(4,),
    ),
}


def pin_constraints(
    ports: Sequence[Port],
    clock: str,
    clock_hz: int,
    physical: str,
    *,
    datapath_only: bool = False,
    all_registers: bool = True,
) -> list[Tcl]:
    """Return constraints for the clocks of a design, and for its pins relative to these clocks.

    The path of a pin without a clock is not checked.

    A two-way pin is in `ports` twice. With `datapath_only`, the tool can leave out the clock's own delay, as
    Vivado can. Without `all_registers`, a path has no inner end, for tools that do not know this word. Only
    pins of the design are named, because a user's logic may keep the layer inside.
    """
    inputs = {port.name: port for port in ports if port.is_input}
    outputs = {port.name: port for port in ports if not port.is_input}
    lines = [_clock(inputs[clock], clock_hz)]
    timing = PIN_TIMING.get(physical)
    bound = {clock}
    if timing is not None and {timing.clock, *timing.given} & inputs.keys():
        given = [inputs[name] for name in timing.given if name in inputs]
        wanted = [outputs[name] for name in timing.wanted if name in outputs]
        bound |= {timing.clock, *(port.name for port in (*given, *wanted))}
        lines.append(Tcl.of("# {}.", Tcl.remark(timing.source)))
        if timing.clock in inputs:
            lines += _clocked(timing, inputs[timing.clock], given, wanted)
        elif not timing.clock:
            inner = Tcl("[all_registers]") if all_registers else None
            lines += _unclocked(timing, given, wanted, inner, datapath_only=datapath_only)
    free = [(way, ports) for way, ports in (("from", inputs), ("to", outputs)) if ports.keys() - bound]
    if free:
        lines.append(Tcl("# These go with no clock outside of the FPGA; inputs pass a synchroniser."))
    for way, known in free:
        lines += [
            Tcl.of("set_false_path -{} {}", way, _ports([port]))
            for name, port in known.items()
            if name not in bound
        ]
    return lines


def clock_pins(ports: Sequence[Port], clock: str, clock_hz: int, physical: str) -> list[tuple[str, int]]:
    """Return the clocks at the pins, each with its Hz: that of the design, and that of its physical layer."""
    timing = PIN_TIMING.get(physical)
    inputs = {port.name for port in ports if port.is_input}
    more = [(timing.clock, timing.clock_hz)] if timing is not None and timing.clock in inputs else []
    return [(clock, clock_hz), *more]


def _clocked(timing: PinTiming, clock: Port, given: Iterable[Port], wanted: Iterable[Port]) -> list[Tcl]:
    edge = Tcl(" -clock_fall") if timing.falling else Tcl("")
    (least, most), (before, after) = timing.given_ns, timing.wanted_ns
    delays = (
        ("input", edge, "min", least, given),
        ("input", edge, "max", most, given),
        ("output", Tcl(""), "min", -after, wanted),
        ("output", Tcl(""), "max", before, wanted),
    )
    return [_clock(clock, timing.clock_hz)] + [
        Tcl.of("set_{}_delay -clock {}{} -{} {:g} {}", way, timing.clock, turned, bound, ns, _ports(ports))
        for way, turned, bound, ns, ports in delays
    ]


def _unclocked(
    timing: PinTiming,
    given: Iterable[Port],
    wanted: Iterable[Port],
    inner: Tcl | None,
    *,
    datapath_only: bool,
) -> list[Tcl]:
    only = Tcl(" -datapath_only") if datapath_only else Tcl("")
    to, from_ = (Tcl.of(" -{} {}", way, inner) if inner else Tcl("") for way in ("to", "from"))
    (inwards,), (outwards,) = timing.given_ns, timing.wanted_ns
    return [
        Tcl.of("set_max_delay{} -from {}{} {:g}", only, _ports(given), to, inwards),
        Tcl.of("set_max_delay{}{} -to {} {:g}", only, from_, _ports(wanted), outwards),
    ]


def _clock(port: Port, hz: int) -> Tcl:
    return Tcl.of("create_clock -name {} -period {:.3f} {}", port.name, 1e9 / hz, _ports([port]))


def _ports(ports: Iterable[Port]) -> Tcl:
    """Return a Tcl expression for these ports with all their bits."""
    names = [Tcl.of("{}[*]", port.name) if port.bits > 1 else Tcl.of("{}", port.name) for port in ports]
    return Tcl.of("[get_ports {{{}}}]", Tcl(" ").join(names))
