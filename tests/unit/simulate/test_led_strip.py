# SPDX-License-Identifier: BSD-3-Clause
"""A strip of LEDs is read while the board goes on."""

from __future__ import annotations

from unitylink.simulate.led_strip import LedStrip


class _Line:
    """A line on which frames of 24 bits follow one another. Each look takes time, and more than a pause."""

    def __init__(self, colour: int) -> None:
        self._bits = [colour >> place & 1 for place in reversed(range(24))]
        self._now_s = self._told_s = 0.0

    def time_s(self) -> float:
        self._now_s += 60e-6
        return self._now_s

    def edges(self, port: str, bit: int = 0) -> list[tuple[float, bool]]:
        self._now_s += 7e-6
        first_s, self._told_s = self._told_s, self._now_s
        frame_s, bit_s = 330e-6, 1.25e-6
        edges = []
        for frame in range(int(self._now_s / frame_s) + 1):
            for place, one in enumerate(self._bits):
                at_s = 100e-6 + frame * frame_s + place * bit_s
                edges += [(at_s, True), (at_s + (700e-9 if one else 350e-9), False)]
        return [edge for edge in edges if first_s <= edge[0] < self._now_s]


def test_a_frame_that_goes_on_while_the_strip_is_read_stays_whole() -> None:
    strip = LedStrip(_Line(0x123456), 1, 3)
    seen = {strip.colours[0] for _ in range(300)}
    assert seen == {(0, 0, 0), (0x34, 0x12, 0x56)}
