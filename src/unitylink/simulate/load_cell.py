# SPDX-License-Identifier: BSD-3-Clause
"""A load cell behind an HX711 at the lines of `hx711`, as a plant uses it."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from .sensor import Sensor

_INPUTS = 3
_COUNTS_MOST = (1 << 23) - 1
_PERIOD = 12  # the register of the clocks of a conversion


class LoadCell(Sensor):
    """A chip HX711, and what is at its inputs.

        cell = board.components["plate"].load_cell(conversions_hz=80)
        cell.weigh(123456)            # counts at input A with 128
        cell.weigh(-300, input=1)     # at input B
        cell.plugged = False          # it neither converts nor answers

    Calls may come from any thread.
    """

    @property
    def conversions_hz(self) -> float:
        """How many conversions it makes in a second: 10 or 80 as its pin RATE says, or any other number."""
        return self._clock_hz / self._clocks(_PERIOD)

    @conversions_hz.setter
    def conversions_hz(self, hertz: float) -> None:
        if not 0.1 <= hertz <= 10_000:
            raise ValueRangeError(f"a load cell has no {hertz} conversions a second: give 0.1 to 10000")
        clocks = max(1, round(self._clock_hz / hertz))
        self._put(_PERIOD, clocks, 4)

    def weigh(self, counts: int, input: int = 0) -> None:
        """Let an input give so many counts. 0 is A with a gain of 128, 1 is B with 32, 2 is A with 64.

        What is beyond 24 bits becomes the largest or the smallest value, as it does in the chip.
        """
        if not 0 <= input < _INPUTS:
            raise ValueRangeError(f"a load cell has inputs 0 to {_INPUTS - 1}, not {input}")
        limited = max(-_COUNTS_MOST - 1, min(_COUNTS_MOST, int(counts)))
        self._put(4 * input, limited & 0xFFFFFF, 3)
