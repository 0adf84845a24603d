# SPDX-License-Identifier: BSD-3-Clause
"""The top module of a bitstream: Verilog around the netlist (PLL, polarity, two-way pins), and constraints.

Only here are there cells of a vendor. No file of the user's has them, and no simulation sees them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from unitylink.errors import BoardError
from unitylink.gateware import Port

from .families import FAMILIES
from .manifest import CHIP_CLOCK_HZ, Board, Pin
from .pins import CLOCKS, RECEIVES, RESETS, TRANSMITS, Line, Pinout
from .pll import Pll

NAME = "unitylink_board"
# After the configuration and the PLL's lock, the design is held in reset for so long. The block RAMs of an
# iCE40 read zeros at first (github.com/YosysHQ/icestorm/issues/76), and the core's programs are in them.
RESET_S = 15e-6


def wrapper(board: Board, top: str, ports: Sequence[Port], pinout: Pinout, pll: Pll | None) -> str:
    """Return the module `unitylink_board`.

    Its ports have the names of the board's pins. Raises BoardError.
    """
    known = {port.name for port in ports}
    clock = _one_of(known, CLOCKS, top, "clock")
    heads = [f"  {'input' if is_input else 'output'} {pin}" for pin, is_input in board.fixed_pins]
    body = ["  wire locked_, clock_;", *_clock(board, pll), *_reset(pll.hz if pll else board.clock_hz)]
    links = [(clock, "clock_")]
    if board.physical == "uart":
        links.append((_one_of(known, RECEIVES, top, "receive line of the link"), board.rx))
        links.append((_one_of(known, TRANSMITS, top, "transmit line of the link"), board.tx))
    links += [(name, "reset_") for name in RESETS if name in known]
    for name in board.released:
        heads.append(f"  inout {name}")
        body.append(_two_way(board, board.pins[name], "1'b0", "1'b0", ""))
    for line in pinout.lines:
        pins = pinout.pins[line.name]
        for pin in pins:
            if pin is not None:
                way = {"in": "input", "out": "output", "both": "inout"}[line.direction]
                heads.append(f"  {way} {pin.name}")
        more, made = _line(board, line, pins)
        body += more
        links += made
    connections = ",\n".join(f"    .{name}({value})" for name, value in links)
    return "\n".join(
        [
            f"module {NAME}(",
            ",\n".join(heads),
            ");",
            *body,
            f"  {top.lower()} design_(",
            connections,
            "  );",
            "endmodule",
            "",
        ]
    )


def has_reset(ports: Sequence[Port]) -> bool:
    """Tell whether the design can be held in reset until clock and block RAMs are ready."""
    return any(port.name in RESETS for port in ports)


def constraints(board: Board, pinout: Pinout) -> str:
    """Return the constraint file of the family: where each port of the wrapper is, and how it is driven."""
    pins = [(board.pins[name], is_input) for name, is_input in board.fixed_pins]
    pins += [(board.pins[name], True) for name in board.released]
    pins += [(pin, line.direction != "out") for line, _, pin in pinout]
    lines = []
    if board.link_clock:
        lines.append(FAMILIES[board.family].clock_line.format(pin=board.link_clock, mhz=CHIP_CLOCK_HZ / 1e6))
    for pin, is_input in pins:
        pull = pin.pull if is_input else "none"
        if board.family == "ice40":
            # A two-way pin is a cell of its own, and its pull-up is a parameter of this cell.
            lines.append(f"set_io{' -pullup yes' if pull == 'up' else ''} {pin.name} {pin.site}")
        else:
            lines.append(f'LOCATE COMP "{pin.name}" SITE "{pin.site}";')
            lines.append(f'IOBUF PORT "{pin.name}" IO_TYPE={pin.io} PULLMODE={pull.upper()};')
    return "\n".join(lines) + "\n"


def _one_of(known: set[str], names: Sequence[str], top: str, what: str) -> str:
    found = [name for name in names if name in known]
    if len(found) != 1:
        raise BoardError(
            f"{top} needs one port for the {what}, called {' or '.join(names)}; it has {found or 'none'}"
        )
    return found[0]


def _clock(board: Board, pll: Pll | None) -> list[str]:
    if pll is None:
        return [f"  assign clock_ = {board.clock_pin};", "  assign locked_ = 1'b1;"]
    parameters = ", ".join(f".{name}({value})" for name, value in pll.parameters)
    if board.family == "ice40":
        cell, pin = (
            ("SB_PLL40_PAD", "PACKAGEPIN") if board.pll == "pad" else ("SB_PLL40_CORE", "REFERENCECLK")
        )
        wires = (
            f".{pin}({board.clock_pin}), .PLLOUTGLOBAL(clock_), .LOCK(locked_), .RESETB(1'b1), .BYPASS(1'b0)"
        )
    else:
        cell = "EHXPLLL"
        wires = f".CLKI({board.clock_pin}), .CLKFB(clock_), .CLKOP(clock_), .LOCK(locked_), .RST(1'b0)"
        wires += ", .STDBY(1'b0)"
        wires += (
            ", .PHASESEL0(1'b0), .PHASESEL1(1'b0), .PHASEDIR(1'b1), .PHASESTEP(1'b1), .PHASELOADREG(1'b1)"
        )
        wires += ", .PLLWAKESYNC(1'b0), .ENCLKOP(1'b0)"
    return [f"  {cell} #({parameters}) pll_({wires});"]


def _reset(clock_hz: float) -> list[str]:
    """Return a counter. It starts at zero after the configuration, and again if the PLL loses its lock."""
    # it counts until its highest bit is set, which is a little later
    bits = math.ceil(clock_hz * RESET_S).bit_length()
    return [
        "  reg [1:0] steady_ = 0;",  # the lock is not synchronous to the clock
        f"  reg [{bits}:0] waited_ = 0;",
        f"  wire reset_ = ~waited_[{bits}];",
        "  always @(posedge clock_) begin",
        "    steady_ <= {steady_[0], locked_};",
        "    if (~steady_[1]) waited_ <= 0;",
        "    else if (reset_) waited_ <= waited_ + 1;",
        "  end",
    ]


def _line(board: Board, line: Line, pins: Sequence[Pin | None]) -> tuple[list[str], list[tuple[str, str]]]:
    """Return the statements around a line's ports, and the connections of its ports."""
    if line.direction == "in":
        return [], [(line.name, _reading(pins, {}))]
    wires = f"[{line.bits - 1}:0]"
    if line.direction == "out":
        net = f"{line.name}_out_"
        body = [f"  wire {wires} {net};"]
        body += [f"  assign {p.name} = {_turned(p)}{net}[{n}];" for n, p in enumerate(pins) if p is not None]
        return body, [(line.name, net)]
    net, drive = f"{line.name}_out_", f"{line.name}_drive_"
    body = [f"  wire {wires} {net}, {drive};"]
    reads = {}
    for number, pin in enumerate(pins):
        if pin is not None:
            reads[pin.name] = f"{pin.name}_in_"
            body.append(f"  wire {reads[pin.name]};")
            value = f"{_turned(pin)}{net}[{number}]"
            body.append(_two_way(board, pin, value, f"{drive}[{number}]", reads[pin.name]))
    ports = [
        (f"{line.name}_in", _reading(pins, reads)),
        (f"{line.name}_out", net),
        (f"{line.name}_drive", drive),
    ]
    return body, ports


def _two_way(board: Board, pin: Pin, value: str, drive: str, read: str) -> str:
    """Return the family's cell of a pin. It drives `value` while `drive` is high."""
    if board.family == "ice40":
        pull = f", .PULLUP(1'b{int(pin.pull == 'up')})"
        wired = f".PACKAGE_PIN({pin.name}), .OUTPUT_ENABLE({drive}), .D_OUT_0({value}), .D_IN_0({read})"
        return f"  SB_IO #(.PIN_TYPE(6'b101001){pull}) {pin.name}_io_({wired});"
    return f"  BB {pin.name}_io_(.B({pin.name}), .I({value}), .T(~{drive}), .O({read}));"


def _reading(pins: Sequence[Pin | None], nets: dict[str, str]) -> str:
    """Return the bits of an input, the highest first. A bit without a pin is 0."""
    bits = ["1'b0" if p is None else f"{_turned(p)}{nets.get(p.name, p.name)}" for p in reversed(pins)]
    return "{" + ", ".join(bits) + "}"


def _turned(pin: Pin) -> str:
    return "~" if pin.active_low else ""
