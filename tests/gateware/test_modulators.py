# SPDX-License-Identifier: BSD-3-Clause
"""The model of sigma_delta_adc takes the bits of modulators by itself. It gives what it gives when each is
driven, and what the VHDL gives.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from gateware.clock_true import Case, Stimulus, in_order, play_vhdl, random_stimuli
from gateware.simulators import Ghdl
from gateware.test_clock_true import configuration

from unitylink import _native

FULL = 1 << 30
CLOCKS = 40_000
CASES = (
    Case("modulator_hz=500000, osr=8, trip_osr=4", {0: (0, 1, 1, 1), 2: (0, 0, 20, 28), 4: (0, 30)}, 900),
    Case("channels=3, modulator_hz=600000, osr=10", {0: (0, 1, 1, 1), 2: (0, 0, 190)}, 2000),
    Case("channels=1, modulator_hz=290000, osr=64", {0: (0, 1, 1), 2: (0,)}, 900),
)


def inputs(draw: random.Random, channels: int) -> Iterator[Stimulus]:
    """Lead the modulators to inputs at random, at once or slowly, also beyond their range."""
    for channel in range(channels):
        now = 8 + draw.randrange(40)
        while now < CLOCKS - 20:
            level = draw.choice((draw.uniform(-1.0, 1.0), draw.uniform(-0.3, 0.3), 1.0, -1.0))
            clocks = draw.choice((0, 0, 1, 100, 3000))
            yield now, "m", channel | clocks << 8, int(level * FULL) & 0xFFFFFFFF
            now += draw.randrange(1, draw.choice((30, 4000)))


def without(trace: list[Stimulus], *left_out: tuple[str, int]) -> list[Stimulus]:
    order = {"o": 0, "e": 1, "a": 2}
    found = [one for one in trace if (one[1], one[2]) not in left_out and one[1] != "p" and one[0] <= CLOCKS]
    return sorted(found, key=lambda one: (one[0], order[one[1]], one[2]))


@pytest.mark.parametrize("number", range(len(CASES)))
def test_bits_of_modulators_are_taken_as_if_they_were_driven(tmp_path: Path, number: int) -> None:
    case = CASES[number]
    one = configuration("sigma_delta_adc", case)
    draw = random.Random(number)
    accesses = [each for each in random_stimuli(one, case, CLOCKS, seed=number) if each[1] != "p"]
    stimuli = sorted([*accesses, *inputs(draw, one.pins[2][2])], key=lambda each: (each[0], each[1] != "m"))
    driven = _native.ComponentModel(one).play(stimuli, CLOCKS)
    drawn = _native.ComponentModel(one).play(stimuli, CLOCKS, draws=True)
    assert without(drawn) == without(driven, ("o", 0))  # nobody watches their clock then
    bits = [each for each in driven if each[1] == "p"]
    assert len({each[3] for each in bits}) == 2 and len(bits) > 1000
    assert play_vhdl(Ghdl, tmp_path, one, in_order([*accesses, *bits], CLOCKS), CLOCKS) == without(driven)
    values = {each[3] for each in driven if each[1] == "a" and each[2] == 0}
    assert len(values) > 20
