# SPDX-License-Identifier: BSD-3-Clause
"""Trace: how much `?trace=FILE` costs a reader. Links with and without it take turns on one board.

Both use one board, because with two boards the placement of their processes makes more difference than the
trace.
"""

from __future__ import annotations

import itertools
import tempfile
from pathlib import Path

from .board import reads_of
from .figure import Figure, Run
from .programs import twin
from .timing import in_turns


def measure(run: Run) -> Figure:
    """Measure the figure."""
    with tempfile.TemporaryDirectory() as folder, twin("tcp") as board:
        url = board.line()
        captures = (Path(folder) / f"{number}.pcapng" for number in itertools.count())
        result = in_turns(
            lambda count: reads_of(f"{url}?trace={next(captures)}", count),
            lambda count: reads_of(url, count),
            rounds=run.rounds(101),
            count=200 if not run.quick else 50,
        )
    return Figure(
        "trace",
        "layer-4 read with ?trace=FILE / without, tcp",
        1.05,
        True,
        result.ratio,
        "x",
        result.told_us("traced", "bare"),
    )
