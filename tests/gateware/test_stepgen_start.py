# SPDX-License-Identifier: BSD-3-Clause
"""When axes of `stepgen` begin whose targets are written one after the other, as its page says."""

from __future__ import annotations

import pytest
from gateware.clock_true import play_model

from unitylink.interface.components import components_of
from unitylink.spec import compile_text

CLOCK_HZ = 50_000_000
PERIOD_CLOCKS = CLOCK_HZ // 16_384  # of the ramp
BASE_CLOCKS = 12  # of a base period, with two axes


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_axes_begin_together_or_a_ramp_period_apart(order: tuple[int, int]) -> None:
    """The targets are written 20 clocks apart, at any time of the ramp period."""
    spec = compile_text("link l(ADDRESS=8); public a() { one: stepgen(axes=2); }").spec
    assert spec is not None
    (one,) = components_of(spec, CLOCK_HZ)
    written = {2: 20_000 << 8, 3: 4_000_000 // 64, 0: 1}
    words = [(16 * axis + word, value) for axis in (0, 1) for word, value in written.items()]
    apart = []
    for offset in range(0, PERIOD_CLOCKS, 100):
        stimuli = [(300 + 50 * number, "w", *word) for number, word in enumerate(words)]
        begin = 150_000 + offset
        stimuli += [(begin + 20 * number, "w", 16 * axis + 1, 60) for number, axis in enumerate(order)]
        first: dict[int, int] = {}
        for at, what, axis, value in play_model(one, stimuli, 220_000):
            if what == "o" and axis in (0, 1) and value == 1:
                first.setdefault(axis, at)
        apart.append(abs(first[0] - first[1]))
    together = [clocks for clocks in apart if clocks <= BASE_CLOCKS]
    assert all(clocks <= BASE_CLOCKS or abs(clocks - PERIOD_CLOCKS) <= BASE_CLOCKS for clocks in apart)
    assert len(together) > 0.8 * len(apart)


@pytest.mark.parametrize("target", [-(2**31), 2**31 - 1])
def test_no_axis_begins_with_a_speed_of_zero(target: int) -> None:
    """The magnitude of the most negative target has no place in 32 bits."""
    spec = compile_text("link l(ADDRESS=8); public a() { one: stepgen(axes=1); }").spec
    assert spec is not None
    (one,) = components_of(spec, CLOCK_HZ)
    written = {2: 0, 3: 2**20 - 1, 4: target % 2**32, 0: 3}
    stimuli = [(300 + 50 * number, "w", *word) for number, word in enumerate(written.items())]
    limited = [what for at, what, *_ in play_model(one, stimuli, 40_000) if what == "o" and at > 100]
    stimuli += [(20_000, "w", 2, 2**28 - 1)]
    free = [what for at, what, *_ in play_model(one, stimuli, 40_000) if what == "o" and at > 100]
    assert not limited and free
