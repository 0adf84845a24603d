# SPDX-License-Identifier: BSD-3-Clause
"""Trace: what `?trace=FILE` costs a reader, with and without taking turns on one board.

Two boards would not do: where the machine places their processes makes more of a difference than the trace.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from .board import layer4_word
from .figure import Figure, Run
from .programs import twin
from .timing import in_turns, times


def measure(run: Run) -> Figure:
    """Measure the figure."""
    from unitylink import connect

    def reads(url: str, count: int) -> Sequence[int]:
        with connect(url) as link:
            word = layer4_word(link)
            times(word.read, 50)
            return times(word.read, count)

    with tempfile.TemporaryDirectory() as folder, twin("tcp") as board:
        url = board.line()
        traced_url = f"{url}?trace={Path(folder) / 'bench.pcapng'}"
        result = in_turns(
            lambda count: reads(traced_url, count),
            lambda count: reads(url, count),
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
        {
            "traced us": result.ours_ns / 1e3,
            "bare us": result.theirs_ns / 1e3,
            "quartile low": result.low,
            "high": result.high,
        },
    )
