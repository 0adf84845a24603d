# SPDX-License-Identifier: BSD-3-Clause
"""The cycle figures of the core with 8-bit addresses and 32-bit data. The bus acknowledges one clock late.

The constants are what the core takes. They must not get worse. docs/gateware/core.md shows them beside the
goals.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from unitylink_lab.conformance.bench import bench

READ_LAST_IN_TO_FIRST_OUT = 6  # goal 9
READ_LAST_IN_TO_LAST_OUT = 23
READ_PERIOD = 14  # goal 16: the reply has 14 bytes
READ_PERIOD_CHECKED = 17  # goal 19: the reply has 17 bytes
WRITE_PERIOD = 14  # goal 16: the request has 14 bytes
WRITE_PERIOD_CHECKED = 17  # the request has 17 bytes
READ_MANY_FIXED = 14  # from last byte in to last byte out: goal 14, and 8 for each word
PUBLISH_FIXED = 10  # back to back: goal 12, and 8 for each word; a publish has 10 + 8 n bytes
CLOCKS_A_WORD = 8
STACK_READ = 32  # through both FIFOs, from first byte in to last byte out: goal 36
STACK_WRITE = 35  # goal 36

CONFIGURATION = bench({"FREQ": 100000})
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "core.md"


def test_the_page_has_these_figures() -> None:
    text = PAGE.read_text(encoding="utf-8")
    table = text[text.index("| this core | goal |") :].split("\n\n")[0]
    assert [row.split("|")[2].strip() for row in table.splitlines()[2:]] == [
        str(READ_LAST_IN_TO_FIRST_OUT),
        str(READ_LAST_IN_TO_LAST_OUT),
        str(READ_PERIOD),
        str(READ_PERIOD_CHECKED),
        str(WRITE_PERIOD),
        str(WRITE_PERIOD_CHECKED),
        f"{READ_MANY_FIXED} + {CLOCKS_A_WORD}n",
        f"{PUBLISH_FIXED} + {CLOCKS_A_WORD}n",
        str(STACK_READ),
        str(STACK_WRITE),
    ]


def clocks(rtl: Any, kind: str, byte: str = "") -> list[int]:
    """Return the clocks of the events of one kind in the last run."""
    return [at for what, at, value in rtl.times if what == kind and (not byte or value == ord(byte))]


def burst(rtl: Any, message: str) -> int:
    """Return the steady period of a message that is sent again and again."""
    count = 24
    answers = rtl(CONFIGURATION, [[("send", message * count), ("quiet", 100)]])
    ends = clocks(rtl, "b", "\n")
    assert len(ends) == count, answers
    periods = [b - a for a, b in pairwise(ends[8:])]
    return max(periods)


def test_read(rtl: Any) -> None:
    rtl(CONFIGURATION, [[("send", "#R:12\n"), ("quiet", 100)]])
    (last_in,), out = clocks(rtl, "i"), clocks(rtl, "b")
    assert (out[0] - last_in, out[-1] - last_in) == (READ_LAST_IN_TO_FIRST_OUT, READ_LAST_IN_TO_LAST_OUT)


@pytest.mark.parametrize(
    ("message", "period"),
    [
        ("#R:12\n", READ_PERIOD),
        ("$R:12*58\n", READ_PERIOD_CHECKED),
        ("#W:20DEADBEEF\n", WRITE_PERIOD),
        ("$W:20DEADBEEF*99\n", WRITE_PERIOD_CHECKED),
    ],
)
def test_steady_period(rtl: Any, message: str, period: int) -> None:
    assert burst(rtl, message) == period


@pytest.mark.parametrize("words", [1, 2, 4, 32])
def test_read_many(rtl: Any, words: int) -> None:
    rtl(CONFIGURATION, [[("send", f"#RM:{words:02x}{'12' * words}\n"), ("quiet", 100)]])
    assert clocks(rtl, "b")[-1] - clocks(rtl, "i")[0] == READ_MANY_FIXED + CLOCKS_A_WORD * words


@pytest.mark.parametrize("words", [1, 2, 8, 16])
def test_publish_back_to_back(rtl: Any, words: int) -> None:
    steps = [
        *(("send", text) for text in (f"#WSA:00{words:02x}{'12' * words}\n#WIC:0001\n#EPS\n",)),
        ("quiet", 100),
        ("events", 1),
        ("wait", 2000),
        ("events", 0),
        ("quiet", 100),
    ]
    rtl(CONFIGURATION, [steps])
    heads = clocks(rtl, "b", "%")
    periods = {b - a for a, b in pairwise(heads[1:])}
    assert periods == {PUBLISH_FIXED + CLOCKS_A_WORD * words}


@pytest.mark.parametrize(("message", "most"), [("#R:12\n", STACK_READ), ("#W:20DEADBEEF\n", STACK_WRITE)])
def test_through_both_fifos(rtl: Any, message: str, most: int) -> None:
    rtl(CONFIGURATION, [[("send", message), ("quiet", 100)]], fifo_words=16)
    assert clocks(rtl, "b")[-1] - clocks(rtl, "o")[0] == most
