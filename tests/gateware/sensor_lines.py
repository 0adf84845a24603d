# SPDX-License-Identifier: BSD-3-Clause
"""What sensors put on their lines, at the times at which they are asked. Their models tell when that is."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from gateware.clock_true import Stimulus, in_order

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration


def next_edge(
    one: ComponentConfiguration, stimuli: Sequence[Stimulus], end: int, after: int, output: int, level: int
) -> int | None:
    """Return the state in which an output next becomes this level, or None if it does not until the end."""
    trace = _native.ComponentModel(one).play(in_order(stimuli, end), end)
    edges = (at for at, what, number, value in trace if (what, number, value) == ("o", output, level))
    return next((at for at in edges if after < at <= end), None)


def echoes(
    draw: random.Random, one: ComponentConfiguration, accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield echoes behind triggers: short, long and stuck ones, spikes, and none."""
    generics = {name: int(value) for name, value in one.generics}
    us = generics["clock_hz"] / 1e6
    longest, period = us * generics["timeout_us"], us * generics["period_us"]
    found: list[Stimulus] = []
    at: int | None = 0
    while (at := next_edge(one, [*accesses, *found], end, at, 0, 0)) is not None:
        rises = at + int(draw.choice((1.0, 5.0, 100.0, 0.9 * period / us)) * us)
        length = draw.choice((0.1, 0.5, 0.9, 1.01)) * draw.choice((1.0, draw.random())) * longest
        if draw.random() < 0.1:
            length = draw.choice((1.1, 2.5)) * period
        if draw.random() < 0.3:
            found += [(rises - 1, "p", 0, 1), (rises + 1, "p", 0, 0)]  # a spike
            rises += int(3 * us)
        if draw.random() < 0.85:
            found += [(rises, "p", 0, 1), (rises + 1 + int(length), "p", 0, 0)]
            at = max(at, rises + int(length))
    yield from found
