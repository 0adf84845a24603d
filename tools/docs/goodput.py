# SPDX-License-Identifier: BSD-3-Clause
"""Draw how much passes a bad line, for docs/faults.md: python tools/docs/goodput.py [--check]

It runs on a virtual clock, so the same sources give the same numbers. --check compares.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

from made_files import parser_of, write_or_compare
from made_part import with_part
from page_format import formatted

from unitylink_lab.bench.goodput import POSTS, REQUESTS, Point, Traffic, goodput
from unitylink_lab.experiments.svg import log_lines

DOCS = Path(__file__).resolve().parents[2] / "docs"
PICTURE, PAGE = DOCS / "images" / "goodput.svg", DOCS / "faults.md"
WORDS = 20_000
LOSSES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)  # percent
SHOWN = (0.1, 1.0, 10.0)
READS = REQUESTS[0]
ONE_BY_ONE = replace(READS, name="one read after another", window=1)


@cache
def point(traffic: Traffic, percent: float) -> Point:
    """Return how much passes when `percent` of the frames are lost."""
    return goodput(traffic, percent / 100, words=WORDS)


def picture() -> str:
    """Return the curves as SVG: shares of what the line carries without a loss."""
    line = {traffic: goodput(traffic, 0.0, words=WORDS).words_per_s for traffic in (READS, POSTS)}
    reads = [point(READS, percent) for percent in LOSSES]
    series = {
        "ideal": [each.ideal_words_per_s / line[READS] for each in reads],
        "reads": [each.words_per_s / line[READS] for each in reads],
        POSTS.name: [point(POSTS, percent).words_per_s / line[POSTS] for percent in LOSSES],
        ONE_BY_ONE.name: [point(ONE_BY_ONE, percent).words_per_s / line[READS] for percent in LOSSES],
    }
    return log_lines(LOSSES, series, "% of the frames lost, each way", "share of the rate without loss")


def table() -> str:
    """Return the shares of the ideal sender as a Markdown table."""
    head = " | ".join(f"{percent:g} %" for percent in SHOWN)
    lines = [f"| frames lost | {head} |", f"|---|{'---|' * len(SHOWN)}"]
    for traffic in (*REQUESTS, POSTS):
        shares = " | ".join(f"{point(traffic, percent).share:.2f}" for percent in SHOWN)
        lines.append(f"| {traffic.name} | {shares} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the files, or compare them."""
    options = parser_of("Draw what gets through a line that loses frames.").parse_args()
    page = formatted(with_part(PAGE.read_text(encoding="utf-8"), "goodput.py", table()))
    return write_or_compare({PICTURE: picture(), PAGE: page}, check=options.check)


if __name__ == "__main__":
    sys.exit(main())
