# SPDX-License-Identifier: BSD-3-Clause
"""The core with each variant of the datalink: its cycle figures, as in docs/gateware/datalink.md."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from unitylink_lab.conformance.bench import bench

CONFIGURATION = bench({"FREQ": 100000})
ROWS = {
    "read, last byte in to last out": "#R:12\n",
    "period of pipelined reads": "#R:12\n",
    "period of pipelined writes": "#W:20DEADBEEF\n",
    "read-many of 8 words, first in to last out": "#RM:08" + "12" * 8 + "\n",
    "read through a FIFO each side, first in to last out": "#R:12\n",
}
VARIANTS = ("full", "lite", "none")
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "datalink.md"


def spelled(message: str, datalink: str) -> str:
    """Return the request as it is on the wire.

    Without a datalink, data are bytes and not hexadecimal digits.
    """
    command, colon, data = message.rstrip("\n").partition(":")
    if datalink == "none":
        data = bytes.fromhex(data).decode("latin-1")
    return f"{command}{colon}{data}\n"


def figure(rtl: Any, row: str, datalink: str) -> int:
    count = 24 if "pipelined" in row else 1
    text = spelled(ROWS[row], datalink) * count
    fifo_words = 16 if "FIFO" in row else 0
    rtl(CONFIGURATION, [[("send", text), ("quiet", 100)]], datalink=datalink, fifo_words=fifo_words)
    clocks = {kind: [at for what, at, _ in rtl.times if what == kind] for kind in "bio"}
    if count > 1:
        ends = [at for kind, at, byte in rtl.times if kind == "b" and byte == ord("\n")]
        assert len(ends) == count
        (period,) = {b - a for a, b in pairwise(ends[8:])}
        return period
    return clocks["b"][-1] - clocks["o" if "first in" in row else "i"][0]


@pytest.mark.parametrize("row", ROWS)
def test_figures_are_those_of_the_page(rtl: Any, row: str) -> None:
    line = next(
        line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith(f"| {row} |")
    )
    told = [int(cell) for cell in re.findall(r"(?<=\| )\d+(?= \|)", line)]
    assert told == [figure(rtl, row, datalink) for datalink in VARIANTS]
