# SPDX-License-Identifier: BSD-3-Clause
"""Sync read: a read through layer 4 from Python against a bare C++ blocking round trip of the same bytes.

Both sides talk to the same twin through the same pty: the bare program holds a descriptor of it that was
opened before the link took the port, and the two take turns.
"""

from __future__ import annotations

import os

from .board import ADDRESS, layer4_word, reads_of
from .figure import BenchError, Figure, Run
from .programs import Process, native, twin
from .timing import in_turns, times


def measure(run: Run) -> Figure:
    """Measure the figure."""
    from unitylink import connect

    with twin("pty") as board:
        url = board.line()
        slave = os.open(url.partition(":")[2].partition("?")[0], os.O_RDWR | os.O_NOCTTY)
        try:
            with connect(f"{url}{'&' if '?' in url else '?'}protocol=classic") as link:
                word = layer4_word(link)
                request = f"#R:{ADDRESS:0{2 * link.configuration.address_bytes}X}"
                before = link.statistics().bytes_sent
                word.read()
                if link.statistics().bytes_sent - before != len(request) + 1:
                    raise BenchError(f"layer 4 does not send {request}: the two sides would not compare")
                options = ["--request", request, "--descriptor", str(slave)]
                with Process([native(run.checkout, "bench_round_trip"), *options], pass_fds=[slave]) as bare:
                    bare.series("200")
                    times(word.read, 200)
                    result = in_turns(
                        lambda count: times(word.read, count),
                        lambda count: bare.series(str(count)),
                        rounds=run.rounds(101),
                        count=200 if not run.quick else 50,
                    )
        finally:
            os.close(slave)
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
        mark = "&" if "?" in url else "?"
        result = in_turns(
            lambda count: reads_of(f"{url}{mark}protocol=framed", count),
            lambda count: reads_of(f"{url}{mark}protocol=classic", count),
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
