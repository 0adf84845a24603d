# SPDX-License-Identifier: BSD-3-Clause
"""A strip of LEDs at the line of `ws2812`, as a plant sees it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

_ONE_S = 525e-9  # a longer pulse is a one
_PAUSE_S = 50e-6  # a longer rest ends a frame


class _Line(Protocol):
    def edges(self, port: str, bit: int = 0) -> Sequence[tuple[float, bool]]: ...

    def time_s(self) -> float: ...


class LedStrip:
    """The LEDs of a strip, which show the colours of the last whole frame.

        ring = board.components["ring"].led_strip()
        ring.colours  # [(red, green, blue), ...], with white as a fourth part if the LEDs have it

    A strip is dark until its first frame. Calls may come from any thread.
    """

    def __init__(self, line: _Line, leds: int, channels: int) -> None:
        self._line = line
        self._channels = channels
        self._rose_s = self._fell_s = 0.0
        self._bits: list[int] = []
        self._shown = [0] * (leds * channels * 8)
        line.edges("data")

    @property
    def colours(self) -> list[tuple[int, ...]]:
        """What the LEDs show now: red, green, blue and perhaps white, each from 0 to 255."""
        now_s = self._line.time_s()  # before the edges: none until then is left out, so a rest is one
        for at_s, level in self._line.edges("data"):
            if level:
                self._rest(at_s)
                self._rose_s = at_s
            else:
                self._bits.append(int(at_s - self._rose_s > _ONE_S))
                self._fell_s = at_s
        self._rest(now_s)
        parts = [
            int("".join(map(str, self._shown[first : first + 8])), 2)
            for first in range(0, len(self._shown), 8)
        ]
        found = []
        for first in range(0, len(parts), self._channels):
            green, red, *others = parts[first : first + self._channels]
            found.append((red, green, *others))
        return found

    def _rest(self, until_s: float) -> None:
        """Show what has come, if the line has rested. LEDs behind the last bit keep their colours."""
        if self._bits and until_s - self._fell_s > _PAUSE_S:
            self._shown[: len(self._bits)] = self._bits[: len(self._shown)]
            self._bits = []
