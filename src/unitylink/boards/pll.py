# SPDX-License-Identifier: BSD-3-Clause
"""Compute the dividers of a PLL that makes the design's clock from the board's clock.

The limits are from Lattice's data sheets. iCE40 (TN1251): phase detector 10 to 133 MHz, oscillator 533 to
1066 MHz. ECP5 (FPGA-TN-02200): phase detector from 3.125 MHz (we stay above 10), oscillator 400 to 800 MHz.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from unitylink.errors import BoardError

_TOLERANCE = 0.005  # share of the requested frequency; a UART tolerates 2 %


@dataclass(frozen=True)
class Pll:
    """An instance of a PLL: the frequency that it really gives, and its Verilog."""

    hz: float
    parameters: tuple[tuple[str, str], ...]


def pll_of(family: str, in_hz: int, out_hz: int) -> Pll:
    """Return the dividers for a clock of `out_hz` from one of `in_hz`, within 0.5 %.

    >>> round(pll_of("ice40", 12_000_000, 48_000_000).hz)
    48000000

    Raises BoardError, which names the nearest possible frequency.
    """
    found = list((_ice40 if family == "ice40" else _ecp5)(in_hz, out_hz))
    best = min(found, key=lambda pll: abs(pll.hz - out_hz), default=None)
    if best is None or abs(best.hz - out_hz) > _TOLERANCE * out_hz:
        near = f"; the nearest is {best.hz / 1e6:.6g} MHz" if best else ""
        raise BoardError(
            f"no PLL setting of {family} makes {out_hz / 1e6:.6g} MHz of {in_hz / 1e6:.6g} MHz{near}: "
            "choose another --clock-hz"
        )
    return best


def _ice40(in_hz: int, out_hz: int) -> Iterator[Pll]:
    ranges = ((17, 1), (26, 2), (44, 3), (66, 4), (101, 5), (134, 6))
    for divr in range(16):
        detector = in_hz / (divr + 1)
        if not 10e6 <= detector <= 133e6:
            continue
        filter_range = next(code for most, code in ranges if detector < most * 1e6)
        for divq in range(1, 7):
            divf = round(out_hz * 2**divq / detector) - 1
            oscillator = detector * (divf + 1)
            if 0 <= divf <= 127 and 533e6 <= oscillator <= 1066e6:
                yield Pll(
                    oscillator / 2**divq,
                    (
                        ("FEEDBACK_PATH", '"SIMPLE"'),
                        ("DIVR", f"4'd{divr}"),
                        ("DIVF", f"7'd{divf}"),
                        ("DIVQ", f"3'd{divq}"),
                        ("FILTER_RANGE", f"3'd{filter_range}"),
                    ),
                )


def _ecp5(in_hz: int, out_hz: int) -> Iterator[Pll]:
    for input_divider in range(1, 129):
        detector = in_hz / input_divider
        if not 10e6 <= detector <= 400e6:
            continue
        feedback = round(out_hz / detector)
        for output_divider in range(1, 129):
            hz = detector * feedback
            if 1 <= feedback <= 80 and 400e6 <= hz * output_divider <= 800e6:
                yield Pll(
                    hz,
                    (
                        ("CLKI_DIV", str(input_divider)),
                        ("CLKFB_DIV", str(feedback)),
                        ("CLKOP_DIV", str(output_divider)),
                        ("CLKOP_CPHASE", str(output_divider - 1)),
                        ("CLKOP_FPHASE", "0"),
                        ("CLKOP_ENABLE", '"ENABLED"'),
                        ("FEEDBK_PATH", '"CLKOP"'),
                    ),
                )
