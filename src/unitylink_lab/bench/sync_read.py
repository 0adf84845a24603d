# SPDX-License-Identifier: BSD-3-Clause
"""Sync read: a read through layer 4 from Python against a bare C++ blocking round trip of the same bytes.

Both sides talk to the same twin through the same pty, in turns.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from .bare import against_bare, with_option
from .board import ADDRESS, layer4_word, reads_of
from .figure import BenchError, Figure, Run
from .programs import twin
from .timing import in_turns

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def measure(run: Run) -> Figure:
    """Measure the figure."""

    def side(link: Link) -> tuple[Callable[[], object], list[str]]:
        word = layer4_word(link)
        request = f"#R:{ADDRESS:0{2 * link.configuration.address_bytes}X}"
        before = link.statistics().bytes_sent
        word.read()
        if link.statistics().bytes_sent - before != len(request) + 1:
            raise BenchError(f"layer 4 does not send {request}: the two sides would not compare")
        return word.read, ["--request", request]

    with twin("pty") as board:
        result = against_bare(run, board.line(), "classic", side)
    return Figure(
        "sync-read",
        "layer-4 read from Python / bare C++ round trip, pty",
        1.3,
        True,
        result.ratio,
        "x",
        result.told_us("layer 4", "bare"),
    )


def measure_framed(run: Run) -> Figure:
    """Measure reads through layer 4 on frames against classic ones, in turns on one board."""
    with twin("pty") as board:
        url = board.line()
        result = in_turns(
            lambda count: reads_of(with_option(url, "protocol=framed"), count),
            lambda count: reads_of(with_option(url, "protocol=classic"), count),
            rounds=run.rounds(61),
            count=200 if not run.quick else 50,
        )
    return Figure(
        "sync-framed",
        "layer-4 read on frames / on the classic protocol, pty",
        1.0,
        True,
        result.ratio,
        "x",
        result.told_us("framed", "classic"),
    )
