# SPDX-License-Identifier: BSD-3-Clause
"""What is at the pins of an unpacked bitstream: the PC's end of the serial line, and bits of words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count

from unitylink import _native
from unitylink.boards import Board
from unitylink.errors import BoardError
from unitylink.spec.report.suggest import nearest

from .chip import CELLS, Chip

TOP = "unitylink_pins"
_POWER_UP_S = 0.0005  # a real chip needs longer for its configuration
_LAST = 0xFFFFFFFF  # bits of the words from here downwards are the pins that no word of the spec has
_BITS = 32
_SHOWN = re.compile(r"\w+ \(site (\w+)(, active low)?\)")


@dataclass(frozen=True)
class Place:
    """A bit of a word, at a pin. `inverted` says that a 1 in the word is a low pin."""

    address: int
    bit: int
    inverted: bool = False


@dataclass(frozen=True)
class PinMap:
    """The places of a board's pins, by site: what is put on them, their levels, and who drives them."""

    inputs: Mapping[str, Place]
    levels: Mapping[str, Place]
    drives: Mapping[str, Place]

    @property
    def read_addresses(self) -> tuple[int, ...]:
        return tuple(sorted({place.address for place in self.inputs.values()}))

    @property
    def write_addresses(self) -> tuple[int, ...]:
        return tuple(sorted({place.address for place in (*self.levels.values(), *self.drives.values())}))


def pin_map(
    chip: Chip, board: Board, shown: Mapping[str, str], words: Mapping[str, tuple[int, int]]
) -> PinMap:
    """Return the places of the pins of `chip`.

    `shown` is that of a build's report: which port is at which pin. `words` says for ports that are words of
    the spec which address and bit they are. The pins of the line have no place.
    """
    known = {
        found[1]: Place(*words[port], inverted=found[2] is not None)
        for port, text in shown.items()
        if port in words and (found := _SHOWN.fullmatch(text))
    }
    line = _line(board)
    taken = {place.address for place in known.values()}
    inputs, outputs = ([site for site in sites if site not in line] for sites in (chip.inputs, chip.outputs))
    free = _free_places(taken)
    given = {site: known.get(site) or next(free) for site in inputs}
    free = _free_places(taken | {place.address for place in given.values()})  # a word has one way
    return PinMap(
        inputs=given,
        levels={site: known.get(site) or next(free) for site in outputs},
        drives={site: next(free) for site in outputs},
    )


def _line(board: Board) -> tuple[str, str]:
    return board.pins[board.rx].site, board.pins[board.tx].site


def _free_places(taken: set[int]) -> Iterator[Place]:
    for address in count(_LAST, -1):
        if address not in taken:
            yield from (Place(address, bit) for bit in range(_BITS))


def wired(chip: Chip, board: Board, baud_hz: int, places: PinMap) -> str:
    """Return Verilog with the module TOP around `chip`: byte streams, and words at the pins."""
    rx, tx = _line(board)
    reads, writes = places.read_addresses, places.write_addresses
    bits = {address: ["1'b0"] * _BITS for address in writes}
    for site, place in places.levels.items():
        bits[place.address][place.bit] = f"{'~' if place.inverted else ''}level_{site}"
    for site, place in places.drives.items():
        bits[place.address][place.bit] = f"drive_{site}"
    body = ["wire to_chip, from_chip, drives;"]
    links = [f".pin_{rx}_in(to_chip)", f".pin_{tx}_out(from_chip)", f".pin_{tx}_drive(drives)"]
    for site, place in places.inputs.items():
        number = reads.index(place.address) * _BITS + place.bit
        body.append(f"wire given_{site} = {'~' if place.inverted else ''}read_words[{number}];")
        links.append(f".pin_{site}_in(given_{site})")
    for site in places.levels:
        rest = f"given_{site}" if site in places.inputs else f"1'b{_rest(board, site):d}"
        body += [
            f"wire value_{site}, drive_{site};",
            f"wire level_{site} = drive_{site} ? value_{site} : {rest};",
        ]
        links += [f".pin_{site}_out(value_{site})", f".pin_{site}_drive(drive_{site})"]
    ports = ["input  clock", "input  reset", "input  rx_valid", "output rx_ready", "input  [7:0] rx_data"]
    ports += ["input  [2:0] rx_error", "output tx_valid", "input  tx_ready", "output [7:0] tx_data"]
    if reads:
        ports.append(f"input  [{len(reads) * _BITS - 1}:0] read_words")
    if writes:
        ports.append(f"output [{len(writes) * _BITS - 1}:0] write_words")
        joined = ", ".join(bit for address in reversed(writes) for bit in reversed(bits[address]))
        body.append(f"assign write_words = {{{joined}}};")
    times = (
        f".CLOCK_HZ({chip.clock_hz}), .BAUD_HZ({baud_hz}), .POWER_UP({round(chip.clock_hz * _POWER_UP_S)})"
    )
    streams = ("reset", "rx_valid", "rx_ready", "rx_data", "tx_valid", "tx_ready", "tx_data")
    line = ["clock", *streams]
    body.append(f"unitylink_line #({times}) line_(")
    body.append("  .to_chip(to_chip), .from_chip(from_chip | ~drives),")
    body.append("  " + ", ".join(f".{name}({name})" for name in line) + ");")
    body.append("chip chip_(.clock(clock), " + ", ".join(links) + ");")
    head = ",\n   ".join(ports)
    around = f"module {TOP}\n  ({head});\n" + "\n".join(body) + "\nendmodule\n"
    return around + chip.verilog + CELLS.read_text(encoding="utf-8")


def _rest(board: Board, site: str) -> bool:
    """Return the level of a pin that nothing drives: its pull-up lifts it."""
    pin = next((pin for pin in board.pins.values() if pin.site == site), None)
    return pin is None or pin.pull == "up"


class Pins:
    """The pins of a running bitstream. `pins[NAME]` is a level, with the name of the board's manifest.

        link.board.pins["BTN1"] = True
        link.board.pins["LEDR_N"]

    Setting a pin is what a wire from outside does. A pin that nothing was set on has the level of its
    pull-up. A pin that goes both ways has the chip's level while the chip drives it (`driven`). Raises
    BoardError if the design does not use the pin, or if only the chip drives it.
    """

    def __init__(self, native: _native.Board, places: PinMap, board: Board) -> None:
        self._native = native
        self._places = places
        self._board = board
        self._names = {pin.name: pin.site for pin in board.pins.values()}
        for site in places.inputs:
            self._set(site, _rest(board, site))

    def __iter__(self) -> Iterator[str]:
        names = {site: name for name, site in self._names.items()}
        used = dict.fromkeys((*self._places.inputs, *self._places.levels))
        return (names.get(site, f"SITE_{site}") for site in used)

    def __getitem__(self, name: str) -> bool:
        site = self._site(name, (*self._places.inputs, *self._places.levels))
        place = self._places.levels.get(site) or self._places.inputs[site]
        return bool(self._word(place) >> place.bit & 1) != place.inverted

    def __setitem__(self, name: str, level: bool) -> None:
        self._set(self._site(name, self._places.inputs), bool(level))

    def driven(self, name: str) -> bool:
        """Tell whether the chip drives a pin now."""
        site = self._site(name, (*self._places.inputs, *self._places.levels))
        place = self._places.drives.get(site)
        return place is not None and bool(self._word(place) >> place.bit & 1)

    def _word(self, place: Place) -> int:
        return self._native.get(place.address) or 0

    def _set(self, site: str, level: bool) -> None:
        place = self._places.inputs[site]
        word = self._word(place) & ~(1 << place.bit)
        self._native.set(place.address, word | (level != place.inverted) << place.bit)

    def _site(self, name: str, among: Iterable[str]) -> str:
        site = self._names.get(name, name.removeprefix("SITE_"))
        sites = set(among)
        if site in sites:
            return site
        there = [one for one in self if self._names.get(one, one.removeprefix("SITE_")) in sites]
        near = nearest(name, there)
        meant = f"did you mean {near}?" if near else f"there are: {', '.join(there) or 'none'}"
        if name in list(self):
            raise BoardError(
                f"pin {name}: only the chip drives it; the inputs are {', '.join(there) or 'none'}"
            )
        raise BoardError(f"pin {name}: the design does not use it; {meant}")
