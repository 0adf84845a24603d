# SPDX-License-Identifier: BSD-3-Clause
"""Draw the pictures of the robots from recorded runs:  python tools/docs/robots.py [--check]

The runs are the tables docs/images/NAME.csv: a time in s, then what the robot measured. With `--record` the
examples run anew first.
"""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from made_files import ROOT, parser_of, write_or_compare
from picture import BOLD, CHECK, DEVICE, FAINT, GRID, PC, PUBLISH, SMALL, Picture

IMAGES = ROOT / "docs" / "images"
COLOURS = (DEVICE, PUBLISH, PC, CHECK)
Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Panel:
    """A part of a picture: lines, each from two columns of the table. `square` gives both axes one scale."""

    title: str
    across: str
    up: str
    lines: tuple[tuple[str, int, int], ...]
    square: bool = False


PICTURES = {
    "belt_axis": (
        "A carriage on a belt starts, and turns round",
        (
            Panel("the speed", "time in s", "m/s", (("encoder", 0, 2), ("datasheet", 0, 3))),
            Panel("what the encoder does not see", "time in s", "mm", (("the play", 0, 4),)),
        ),
    ),
    "bus_arm": (
        "An arm on bus servos picks something up",
        (
            Panel("shoulder", "time in s", "rad", (("goal", 0, 2), ("angle", 0, 9))),
            Panel("base and elbow", "time in s", "rad", (("base", 0, 8), ("elbow", 0, 10))),
        ),
    ),
    "diff_drive": (
        "A cart with two wheels drives a square",
        (
            Panel(
                "by its gyroscope", "x in m", "y in m", (("it believes", 1, 2), ("true", 5, 6)), square=True
            ),
            Panel("by its wheels", "x in m", "y in m", (("it believes", 3, 4), ("true", 5, 6)), square=True),
        ),
    ),
    "foc_joint": (
        "A joint with a brushless motor turns from angle to angle",
        (
            Panel("the angle", "time in s", "rad", (("path", 0, 1), ("joint", 0, 2))),
            Panel("the currents", "time in s", "A", (("d, aligns", 0, 3), ("q, turns", 0, 4))),
        ),
    ),
    "scara_stepper": (
        "A SCARA with stepper motors draws a flower",
        (
            Panel("from above", "x in mm", "y in mm", (("path", 1, 2), ("arm", 5, 6)), square=True),
            Panel("the tool", "time in s", "mm", (("path x", 0, 1), ("arm x", 0, 5))),
        ),
    ),
    "xyz_stage": (
        "A stage of three stepper axes draws a square",
        (
            Panel("from above", "x in mm", "y in mm", (("counters", 1, 2), ("carriages", 4, 5)), square=True),
            Panel("the axes", "time in s", "mm", (("x", 0, 1), ("y", 0, 2), ("z", 0, 3))),
        ),
    ),
}


def record(name: str) -> None:
    """Let an example run, and keep its table."""
    command = [sys.executable, str(ROOT / "examples" / name / "run.py"), "--csv", str(IMAGES / f"{name}.csv")]
    subprocess.run(command, check=True)


def table(name: str) -> list[list[float]]:
    with (IMAGES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return [[float(number) for number in row] for row in csv.reader(file)]


def ticks(low: float, high: float) -> list[float]:
    """Return some round numbers between two."""
    step = 10.0 ** len(str(int(high - low)))
    while (high - low) / step < 3:
        step /= 2 if str(step).strip("0.")[0] != "5" else 2.5
    first = -int(-low // step)
    return [number * step for number in range(first, int(high // step) + 1)]


def draw_panel(picture: Picture, panel: Panel, rows: list[list[float]], left: float, width: float) -> None:
    top, height = 60.0, 300.0
    lines = [
        (name, [(row[x], row[y]) for row in rows if not math.isnan(row[y])]) for name, x, y in panel.lines
    ]
    x_low, x_high = _range([x for _, points in lines for x, _ in points])
    y_low, y_high = _range([y for _, points in lines for _, y in points])
    x_scale, y_scale = width / (x_high - x_low), height / (y_high - y_low)
    if panel.square:
        x_scale = y_scale = min(x_scale, y_scale)

    def place(x: float, y: float) -> tuple[float, float]:
        return left + (x - x_low) * x_scale, top + height - (y - y_low) * y_scale

    picture.text(left, 34, panel.title, style=BOLD)
    for tick in ticks(x_low, x_high):
        x, _ = place(tick, 0)
        picture.line(x, top, x, top + height, GRID, dash="2 3")
        picture.text(x, top + height + 16, f"{tick:g}", anchor="middle", colour=FAINT, style=SMALL)
    for tick in ticks(y_low, y_high):
        _, y = place(0, tick)
        picture.line(left, y, left + width, y, GRID, dash="2 3")
        picture.text(left - 6, y + 4, f"{tick:g}", anchor="end", colour=FAINT, style=SMALL)
    for number, (name, points) in enumerate(lines):
        colour = COLOURS[number]
        picture.path([place(x, y) for x, y in points], colour)
        picture.text(
            left + width - 80 * (len(lines) - 1 - number), 34, name, anchor="end", colour=colour, style=SMALL
        )
    picture.text(left + width, top + height + 34, panel.across, anchor="end", colour=FAINT, style=SMALL)
    picture.text(left, top - 8, panel.up, colour=FAINT, style=SMALL)


def _range(numbers: Sequence[float]) -> tuple[float, float]:
    low, high = min(numbers), max(numbers)
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + margin


def draw(name: str) -> str:
    """Return the picture of a robot."""
    title, panels = PICTURES[name]
    rows = table(name)
    picture = Picture(860, 410, title)
    for number, panel in enumerate(panels):
        draw_panel(picture, panel, rows, 60 + 430 * number, 340)
    return picture.svg()


def main() -> int:
    """Write the pictures, or compare them with the files."""
    parser = parser_of("Draw the pictures of the robots.")
    parser.add_argument(
        "--record", nargs="*", default=(), metavar="NAME", help="let these examples run first"
    )
    given = parser.parse_args()
    for name in given.record:
        record(name)
    return write_or_compare({IMAGES / f"{name}.svg": draw(name) for name in PICTURES}, check=given.check)


if __name__ == "__main__":
    sys.exit(main())
