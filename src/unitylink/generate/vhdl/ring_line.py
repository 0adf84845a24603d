# SPDX-License-Identifier: BSD-3-Clause
"""The line between the nodes of a ring: how many samples of it a clock takes."""

from __future__ import annotations

from unitylink.errors import BindingError

_LEAST = 3  # samples of a bit (tosnet_line_in)
_CHOICES = (1, 2, 4)  # samples of a clock: a plain input, a DDR input, a SERDES input


def samples_a_clock(clock_hz: int, baud_hz: int) -> int:
    """Return the fewest samples of the line that will do.

    Raises BindingError if a bit is not a whole number of clocks.

    >>> samples_a_clock(50_000_000, 12_500_000), samples_a_clock(50_000_000, 50_000_000)
    (1, 4)
    """
    clocks, rest = divmod(clock_hz, baud_hz)
    if rest:
        slower = clock_hz // (clocks + 1)
        fits = f"{slower:,} Hz" if clocks == 0 else f"{slower:,} Hz or {clock_hz // clocks:,} Hz"
        raise BindingError(
            f"vhdl: the ring's line has {baud_hz:,} bit/s, and a bit is no whole number of clocks of "
            f"{clock_hz:,} Hz; write a BAUD such as {fits} in TOSNET, or choose another clock"
        )
    return next(samples for samples in _CHOICES if samples * clocks >= _LEAST)
