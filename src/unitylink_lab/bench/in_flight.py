# SPDX-License-Identifier: BSD-3-Clause
"""Requests in flight: 64 reads at once against one after another, over TCP to a twin with 1024-byte FIFOs."""

from __future__ import annotations

from .board import ADDRESS, FIRST_VALUE
from .figure import BenchError, Figure, Run
from .programs import twin
from .timing import in_turns, times

REQUESTS = 64
FIFO_BYTES = 1024


def measure(run: Run) -> Figure:
    """Measure the classic protocol."""
    return _measure(run, "in-flight", "classic")


def measure_framed(run: Run) -> Figure:
    """Measure frames."""
    return _measure(run, "in-flight-framed", "framed")


def _measure(run: Run, name: str, protocol: str) -> Figure:
    from unitylink import connect

    addresses = list(range(ADDRESS, ADDRESS + REQUESTS))
    options = f"fifo={FIFO_BYTES}&window={REQUESTS}"
    with (
        twin("tcp", fifo=FIFO_BYTES) as board,
        connect(f"{board.line()}?protocol={protocol}&{options}") as link,
    ):
        if list(link.read_each(addresses)) != [FIRST_VALUE + address for address in addresses]:
            raise BenchError("the twin does not hold what was put there")
        before = link.statistics()
        result = in_turns(
            lambda count: times(lambda: link.read_each(addresses), max(1, count // 10)),
            lambda count: times(lambda: link.read(ADDRESS), count),
            rounds=run.rounds(61),
            count=200 if not run.quick else 50,
        )
        after = link.statistics()
    complaint = "requests were repeated" if after.retries != before.retries else ""
    return Figure(
        name,
        f"{REQUESTS} requests in flight / sync rate, TCP loopback, {protocol}",
        10,
        False,
        REQUESTS / result.ratio,
        "x",
        {
            "in flight reads/s": REQUESTS * 1e9 / result.ours_ns,
            "sync reads/s": 1e9 / result.theirs_ns,
            "quartile low": REQUESTS / result.high,
            "high": REQUESTS / result.low,
        },
        complaint,
    )
