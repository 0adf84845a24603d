# SPDX-License-Identifier: BSD-3-Clause
"""The far end of a serial line of `uart_bridge`, as a plant uses it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

_DATA_BITS = 8


class _Pins(Protocol):
    def play(self, port: str, levels: Sequence[tuple[float, bool]], bit: int = 0) -> None: ...
    def edges(self, port: str, bit: int = 0) -> list[tuple[float, bool]]: ...
    def time_s(self) -> float: ...


class SerialEnd:
    """A device on a serial line: what it sends goes to the gateware, and what the gateware sends comes out.

        receiver = board.components["gnss"].serial()
        receiver.send(b"$GNGGA,")     # takes its time on the line: 10 bits a byte
        receiver.take()               # the whole bytes that have come since the last call
        receiver.baud_hz = 9600.0     # for all from now on
        receiver.broken               # how many characters had a wrong parity or no stop bit

    `parity` is 0 for none, 1 for even and 2 for odd.
    """

    def __init__(self, pins: _Pins, baud_hz: float, parity: int = 0, stop_bits: int = 1) -> None:
        self._pins = pins
        self.baud_hz = baud_hz
        self.broken = 0
        self._parity = parity
        self._stop_bits = stop_bits
        self._edges: list[tuple[float, bool]] = []  # that belong to no whole byte so far
        self._pins.edges("tx")

    def send(self, data: bytes) -> None:
        """Send bytes, behind those that are still on their way."""
        bit_s = 1 / self.baud_hz
        levels: list[tuple[float, bool]] = []
        place = 0
        for byte in data:
            for level in self._frame(byte):
                levels.append((place * bit_s, level))
                place += 1
        if levels:
            self._pins.play("rx", [*levels, (place * bit_s, True)])

    def take(self) -> bytes:
        """Return the whole bytes that the gateware has sent since the last call."""
        until_s = self._pins.time_s()
        self._edges += self._pins.edges("tx")
        return bytes(self._whole_bytes(until_s))

    def _frame(self, byte: int) -> list[bool]:
        bits = [bool(byte >> place & 1) for place in range(_DATA_BITS)]
        check = [sum(bits) % 2 == self._parity % 2] if self._parity else []
        return [False, *bits, *check, *[True] * self._stop_bits]

    def _whole_bytes(self, until_s: float) -> Iterator[int]:
        """Read frames from the edges. A frame that ends later than `until_s` stays there."""
        bit_s = 1 / self.baud_hz
        bits = 2 + _DATA_BITS + bool(self._parity)
        while True:
            while self._edges and self._edges[0][1]:
                del self._edges[0]  # the line rests
            if not self._edges or self._edges[0][0] + bits * bit_s > until_s:
                return
            start_s = self._edges[0][0]
            levels = [self._level(start_s + (place + 0.5) * bit_s) for place in range(bits)]
            while self._edges and self._edges[0][0] < start_s + (bits - 0.5) * bit_s:
                del self._edges[0]
            byte = sum(level << place for place, level in enumerate(levels[1 : 1 + _DATA_BITS]))
            if levels == self._frame(byte)[:bits]:
                yield byte
            else:
                self.broken += 1

    def _level(self, time_s: float) -> bool:
        return [level for at_s, level in self._edges if at_s <= time_s][-1]
