# SPDX-License-Identifier: BSD-3-Clause
"""18 scattered reads and 18 writes in one message each way, against a bare C++ program with the same bytes.

`exchange` names the addresses each time. `cycle` has named them once, as an exchange group.

The bare program sends the same bytes as the link and waits for the same reply. They are made before its clock
starts. So the ratio is the cost of the host's stack. The distance to a minimal echo is shown beside it. The
echo is HELLO: every device answers it, and it changes nothing in the open session.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from .bare import against_bare, against_same_bytes
from .board import FIRST_VALUE
from .figure import BenchError, Figure, Run
from .programs import twin

if TYPE_CHECKING:
    from unitylink.layer2_message import Link, Words

WORDS = 18
READS = [0x200 + 7 * n for n in range(WORDS)]  # no two of them are neighbours
WRITES = [0x100 + 5 * n for n in range(WORDS)]
HELLO = "0080030101fa928300"  # docs/protocol.md, section 2
CLOCK_HZ = 1_000_000_000  # the device answers at once; at 50 MHz, 36 accesses would take it 3 us


def measure(run: Run) -> Figure:
    """Measure `link.exchange`."""

    def named_each_time(link: Link) -> Callable[[], Words]:
        writes = [(address, number) for number, address in enumerate(WRITES)]
        return lambda: link.exchange(READS, writes)

    return _measured(run, "exchange", "from Python", named_each_time)


def measure_cycle(run: Run) -> Figure:
    """Measure the same words as an exchange group."""

    def named_once(link: Link) -> Callable[[], Words]:
        group = link.exchange_group(writes=WRITES, reads=READS)
        return lambda: group.exchange(range(WORDS))

    return _measured(run, "cycle", "as a group, from Python", named_once)


def _measured(run: Run, name: str, how: str, call: Callable[[Link], Callable[[], Words]]) -> Figure:
    def side(link: Link) -> Callable[[], Words]:
        exchange = call(link)
        if list(exchange()) != [FIRST_VALUE + address for address in READS]:
            raise BenchError("the twin does not hold what was put there")
        before = link.statistics().requests
        exchange()
        if link.statistics().requests != before + 1:
            raise BenchError("an exchange is not one message")
        return exchange

    board_settings = {"clock_hz": CLOCK_HZ, "exchange_size": 2 * WORDS}
    same = against_same_bytes(run, board_settings, side)
    with twin("pty", **board_settings) as board:
        echo = against_bare(run, board.line(), "framed", lambda link: (side(link), ["--frame", HELLO]))
    return Figure(
        name,
        f"{WORDS} reads and {WORDS} writes {how} / bare C++ with the same bytes, pty",
        1.15,
        True,
        same.ratio,
        "x",
        {**same.told_us(name, "the same bytes"), "HELLO us": echo.theirs_ns / 1e3, "over HELLO": echo.ratio},
    )
