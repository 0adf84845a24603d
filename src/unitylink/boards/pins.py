# SPDX-License-Identifier: BSD-3-Clause
"""The pin of the board for each port of the design: chosen by the user, or else by the port's name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from unitylink.errors import BoardError
from unitylink.gateware import Port
from unitylink.spec.report.suggest import nearest

from .manifest import Board, Pin

CLOCKS = ("clock", "clk")
RESETS = ("reset", "rst")
RECEIVES = ("rx_line", "usb_rx", "rx", "uart_rx")
TRANSMITS = ("tx_line", "usb_tx", "tx", "uart_tx")
TRIPPED = "tripped"  # the dead-man's output: the name of the port and of its pin's role
OPEN = "-"  # in place of a pin: the line stays open on purpose
_SITE = "site:"  # stands before a pin of the chip that the manifest does not name
# A word of a port's name -> the role of its pins. With or without an s at the end.
_WORDS = {
    **dict.fromkeys(("led", "lamp", "light"), "leds"),
    **dict.fromkeys(("button", "key", "btn"), "buttons"),
    **dict.fromkeys(("pwm", "pdm", "servo", "motor"), "pwm"),
    **dict.fromkeys(("encoder", "quadrature"), "encoder"),
    **dict.fromkeys(("gpio", "pin", "switch", "io"), "io"),
}
_OUTPUTS = ("leds", "pwm")  # roles of pins for outputs
_WISH = re.compile(r"(\w+)(?:\[(\d+)\])?=(.*)", re.DOTALL)


@dataclass(frozen=True)
class Line:
    """A name at pins: one port, or the three ports (name_in, name_out, name_drive) of a two-way pin."""

    name: str
    direction: str  # "in", "out", "both"
    bits: int

    def bit(self, number: int) -> str:
        return f"{self.name}[{number}]" if self.bits > 1 else self.name


@dataclass
class Pinout:
    """`pins` has the pin of each bit of a line, or None."""

    lines: tuple[Line, ...]
    pins: dict[str, list[Pin | None]] = field(default_factory=dict)
    notices: list[str] = field(default_factory=list)

    def __iter__(self) -> Iterator[tuple[Line, int, Pin]]:
        for line in self.lines:
            for number, pin in enumerate(self.pins[line.name]):
                if pin is not None:
                    yield line, number, pin


def lines_of(ports: Sequence[Port]) -> tuple[Line, ...]:
    """Return those of `ports` that go to pins, without the clock, the reset and the link.

    >>> two_way = [Port("a_in", True, 2), Port("a_out", False, 2), Port("a_drive", False, 2)]
    >>> lines_of([Port("clock", True, 1), *two_way])
    (Line(name='a', direction='both', bits=2),)
    """
    known = {port.name: port for port in ports}
    both = {
        name.removesuffix("_drive")
        for name in known
        if name.endswith("_drive") and {name[:-5] + "in", name[:-5] + "out"} <= known.keys()
    }
    lines = []
    for port in ports:
        name, _, end = port.name.rpartition("_")
        if port.name in (*CLOCKS, *RESETS, *RECEIVES, *TRANSMITS) or (name in both and end != "drive"):
            continue
        if name in both:
            lines.append(Line(name, "both", port.bits))
        else:
            lines.append(Line(port.name, "in" if port.is_input else "out", port.bits))
    return tuple(lines)


def role_of(name: str, component: str = "", direction: str = "out") -> str | None:
    """Return the role of a port's pins, by its component or by a word of its name.

    An input does not get the pins of a LED or of a motor, whatever it is called.

    >>> role_of("motor_fault", "h_bridge", "in")
    'io'
    >>> role_of("left_motors"), role_of("drive_pins", "pwm"), role_of("limit_switch"), role_of("trips")
    ('pwm', 'pwm', 'io', None)
    >>> role_of("tripped")
    'tripped'
    """
    if name == TRIPPED:
        return TRIPPED
    for word in [*component.lower().split("_"), *name.lower().split("_")]:
        for known in (word, word.removesuffix("s")):
            if known in _WORDS:
                role = _WORDS[known]
                return "io" if direction == "in" and role in _OUTPUTS else role
    return None


def wished_names(wishes: Sequence[str]) -> set[str]:
    """Return the ports that `--pin PORT=PIN` options name."""
    return {_parsed(wish)[0] for wish in wishes}


def assign_pins(
    board: Board, lines: Sequence[Line], wishes: Sequence[str], components: Mapping[str, str] | None = None
) -> Pinout:
    """Give each line its pins. First come the `wishes` ("servos=P1A1,P1A2", "servos[1]=P1B1", "lamp=-").

    `components` maps a line to its component of the gateware library. Raises BoardError if the board does not
    have a pin, if two lines want the same one, if a line does not exist, if its name tells no pin, or if a
    wish names only some outputs of a line.
    """
    names = {line.name: line for line in lines}
    pinout = Pinout(tuple(lines), {line.name: [None] * line.bits for line in lines})
    taken = {board.pins[name].site: name for name in (*(pin for pin, _ in board.fixed_pins), *board.released)}
    wishes = [*(f"{port}={','.join(pins)}" for port, pins in board.link_pins.items()), *wishes]
    done: set[tuple[str, int]] = set()
    for wish in wishes:
        name, index, wanted = _parsed(wish)
        if name not in names:
            raise BoardError(f"--pin {wish}: the design has no port {name}; {_there_are(name, names)}")
        first = 0 if index is None else index
        if first + len(wanted) > names[name].bits:
            raise BoardError(f"--pin {wish}: {name} has {names[name].bits} bits")
        if index is None and len(wanted) < names[name].bits and wanted != [OPEN]:
            _refuse_part(names[name], wish, len(wanted))
        for number, pin_name in enumerate(wanted, first):
            done.add((name, number))
            if pin_name != OPEN:
                pinout.pins[name][number] = _take(board, pin_name, f"--pin {wish}", taken)
        if index is None:
            done.update((name, number) for number in range(names[name].bits))
    for line in lines:
        if {(line.name, number) for number in range(line.bits)} <= done:
            continue
        component = (components or {}).get(line.name, "")
        role = role_of(line.name, component, line.direction)
        free = [pin for pin in (board.roles[role] if role else ()) if board.pins[pin].site not in taken]
        open_bits = [number for number in range(line.bits) if (line.name, number) not in done]
        needed = len(open_bits) if component and line.direction == "out" else 1  # all gates, but not all LEDs
        if len(free) < needed:
            raise BoardError(_no_pin(board, line, role, taken))
        for number in open_bits:
            if free:
                pinout.pins[line.name][number] = _take(board, free.pop(0), line.name, taken)
    pinout.notices += [
        f"{pin}: nothing drives it, because the design has no port {TRIPPED}"
        for pin in board.roles.get(TRIPPED, ())
        if TRIPPED not in names
    ]
    pinout.notices += [text for line in lines if (text := _left_open(line, pinout.pins[line.name]))]
    return pinout


def _parsed(wish: str) -> tuple[str, int | None, list[str]]:
    found = _WISH.fullmatch(wish)
    if found is None or not found[3]:
        raise BoardError(
            f"--pin {wish}: write PORT=PIN, PORT=PIN,PIN,... or PORT[3]=PIN; {OPEN} is not a pin"
        )
    return found[1].lower(), int(found[2]) if found[2] else None, [pin.strip() for pin in found[3].split(",")]


def _refuse_part(line: Line, wish: str, given: int) -> None:
    """Refuse outputs of which some are forgotten. An input reads 0, and a notice says so."""
    if line.direction == "out":
        raise BoardError(
            f"--pin {wish}: {line.name} has {line.bits} outputs, and {given} are named; name all, "
            f"with {OPEN} for one that is not connected"
        )


def _take(board: Board, name: str, who: str, taken: dict[str, str]) -> Pin:
    if name.startswith(_SITE):
        site = name.removeprefix(_SITE)
        pin = next((one for one in board.pins.values() if one.site == site), None)
        io = board.pins[board.clock_pin].io
        pin = pin or Pin(f"SITE_{re.sub(r'[^A-Za-z0-9_]', '_', site)}", site, io=io)
    elif name in board.pins:
        pin = board.pins[name]
    else:
        raise BoardError(
            f"{who}: {board.name} has no pin {name}; {_there_are(name, board.pins)}; "
            f"{_SITE}B10 names one of the chip"
        )
    if pin.site in taken:
        raise BoardError(f"{who}: pin {name} (site {pin.site}) is taken by {taken[pin.site]}")
    taken[pin.site] = who
    return pin


def _no_pin(board: Board, line: Line, role: str | None, taken: Mapping[str, str]) -> str:
    free = [pin.name for pin in board.pins.values() if pin.site not in taken]
    few = any(board.pins[pin].site not in taken for pin in board.roles[role]) if role else False
    lacks = "too few free pins" if few else "no free pin"
    why = f"{board.name} has {lacks} for {role}" if role else "its name gives none"
    return (
        f"the port {line.name} has no pin: {why}; say --pin {line.name}=PIN "
        f"({OPEN} for none). Free: {', '.join(free)}"
    )


def _left_open(line: Line, pins: Sequence[Pin | None]) -> str:
    bits = [number for number, pin in enumerate(pins) if pin is None]
    if not bits:
        return ""
    what = "is not connected" if line.direction == "out" else "reads 0"
    if len(bits) == line.bits:
        return f"{line.name}: has no pin, {what}"
    shown = f"{bits[0]}" if len(bits) == 1 else f"{bits[0]} to {bits[-1]}" if _run(bits) else str(bits)[1:-1]
    return f"{line.name}[{shown}]: no pin, {what}"


def _run(numbers: Sequence[int]) -> bool:
    return list(numbers) == list(range(numbers[0], numbers[0] + len(numbers)))


def _there_are(name: str, among: Mapping[str, object]) -> str:
    near = nearest(name, among)
    return f"did you mean {near}?" if near else f"there are: {', '.join(among) or 'none'}"
