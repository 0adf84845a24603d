# SPDX-License-Identifier: BSD-3-Clause
"""PLL dividers: they are within the chip's limits, and as good as those of the chip's own tool."""

from __future__ import annotations

import re
import subprocess

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink.boards.pll import pll_of
from unitylink.errors import BoardError


def numbers(text: tuple[tuple[str, str], ...]) -> dict[str, int]:
    return {name: int(value.rpartition("d")[2]) for name, value in text if value[-1].isdigit()}


@pytest.mark.parametrize(("in_mhz", "out_mhz"), [(12, 24), (12, 48), (12, 60), (100, 33), (16, 50)])
def test_ice40_is_as_good_as_icepll(in_mhz: int, out_mhz: int) -> None:
    """The frequency is the same as icepll's. Other dividers may give it, too."""
    said = subprocess.run(
        ["icepll", "-i", str(in_mhz), "-o", str(out_mhz)],
        capture_output=True,
        text=True,
        check=True,
        timeout=20,
    ).stdout
    achieved = re.search(r"([\d.]+) MHz \(achieved\)", said)
    assert achieved is not None
    mine = pll_of("ice40", in_mhz * 1_000_000, out_mhz * 1_000_000)
    assert abs(mine.hz / 1e6 - out_mhz) <= abs(float(achieved[1]) - out_mhz) + 1e-3
    set_to = numbers(mine.parameters)
    code = re.search(r"FILTER_RANGE: (\d)", said)
    if set_to["DIVR"] == int(re.search(r"DIVR:\s+(\d+)", said)[1]):  # type: ignore[index]
        assert code is not None and set_to["FILTER_RANGE"] == int(code[1])


@given(st.integers(10, 100), st.integers(16, 275))
def test_ice40_stays_within_its_limits(in_mhz: int, out_mhz: int) -> None:
    try:
        pll = pll_of("ice40", in_mhz * 1_000_000, out_mhz * 1_000_000)
    except BoardError:
        return
    n = numbers(pll.parameters)
    detector = in_mhz / (n["DIVR"] + 1)
    oscillator = detector * (n["DIVF"] + 1)
    assert 10 <= detector <= 133 and 533 <= oscillator <= 1066
    assert oscillator / 2 ** n["DIVQ"] == pytest.approx(pll.hz / 1e6) == pytest.approx(out_mhz, rel=0.006)


@given(st.sampled_from((12, 25, 27, 50, 100)), st.integers(10, 200))
def test_ecp5_stays_within_its_limits(in_mhz: int, out_mhz: int) -> None:
    try:
        pll = pll_of("ecp5", in_mhz * 1_000_000, out_mhz * 1_000_000)
    except BoardError:
        return
    n = numbers(pll.parameters)
    out = in_mhz / n["CLKI_DIV"] * n["CLKFB_DIV"]
    assert 399.99 <= out * n["CLKOP_DIV"] <= 800.01
    assert out == pytest.approx(pll.hz / 1e6) == pytest.approx(out_mhz, rel=0.006)


def test_a_clock_that_cannot_be_had() -> None:
    with pytest.raises(BoardError, match=r"no PLL setting of ice40 makes 7 MHz of 12 MHz.*choose another"):
        pll_of("ice40", 12_000_000, 7_000_000)
