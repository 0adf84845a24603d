# SPDX-License-Identifier: BSD-3-Clause
"""Exchange: 18 scattered reads and 18 writes in one message each way, against a bare round trip of a frame.

Both sides talk to the same twin through the same pty, as those of `sync_read.py` do. The bare program sends
HELLO, which every device answers and which changes nothing in the session that is open.
"""

from __future__ import annotations

import os

from .board import FIRST_VALUE
from .figure import BenchError, Figure, Run
from .programs import Process, native, twin
from .timing import in_turns, times

WORDS = 18
READS = [0x200 + 7 * n for n in range(WORDS)]  # no two next to each other
WRITES = [0x100 + 5 * n for n in range(WORDS)]
HELLO = "0080030101fa928300"  # docs/protocol.md, section 2
CLOCK_HZ = 1_000_000_000  # the device answers at once: at 50 MHz 36 accesses would rightly take it 3 us


def measure(run: Run) -> Figure:
    """Measure the figure."""
    from unitylink import connect

    with twin("pty", clock_hz=CLOCK_HZ) as board:
        url = board.line()
        slave = os.open(url.partition(":")[2].partition("?")[0], os.O_RDWR | os.O_NOCTTY)
        try:
            with connect(f"{url}{'&' if '?' in url else '?'}protocol=framed") as link:
                writes = [(address, number) for number, address in enumerate(WRITES)]

                def exchange() -> object:
                    return link.exchange(READS, writes)

                if list(link.exchange(READS, writes)) != [FIRST_VALUE + address for address in READS]:
                    raise BenchError("the twin does not hold what was put there")
                before = link.statistics().requests
                exchange()
                if link.statistics().requests != before + 1:
                    raise BenchError("an exchange is not one message")
                options = ["--frame", HELLO, "--descriptor", str(slave)]
                with Process([native(run.checkout, "bench_round_trip"), *options], pass_fds=[slave]) as bare:
                    bare.series("200")
                    times(exchange, 200)
                    result = in_turns(
                        lambda count: times(exchange, count),
                        lambda count: bare.series(str(count)),
                        rounds=run.rounds(101),
                        count=200 if not run.quick else 50,
                    )
        finally:
            os.close(slave)
    return Figure(
        "exchange",
        f"{WORDS} reads and {WORDS} writes from Python / bare C++ round trip, pty",
        1.3,
        True,
        result.ratio,
        "x",
        {
            "exchange us": result.ours_ns / 1e3,
            "bare us": result.theirs_ns / 1e3,
            "quartile low": result.low,
            "high": result.high,
        },
    )
