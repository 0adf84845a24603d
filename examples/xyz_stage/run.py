# SPDX-License-Identifier: BSD-3-Clause
"""Home a stage of three stepper axes, and draw a square. Tell how far its corners are passed.

python examples/xyz_stage/run.py
python examples/xyz_stage/run.py --link "serial:/dev/ttyUSB1?baud=3000000&deadman=0.5"

The exit code is 1 if a corner of the square is not met.
"""

from __future__ import annotations

import argparse
import csv
import sys
from functools import partial
from pathlib import Path

from stage import Stage

from unitylink import Link, connect
from unitylink.layer4_data import Node, ReadValue, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "xyz_stage.ul"
SQUARE_MM = ((60.0, 60.0), (120.0, 60.0), (120.0, 120.0), (60.0, 120.0), (60.0, 60.0))
UP_MM, DOWN_MM = 60.0, 50.0
TOLERANCE_MM = 0.0125  # a step

Row = tuple[
    float, ...
]  # time in s, then x, y, z: what the counters say, and on a virtual board the carriages


def record(board: Node, link: Link) -> list[Row]:
    """Keep each publish from now on, with the places of the carriages if a model has them."""
    rows: list[Row] = []
    carriages = getattr(getattr(link, "board", None), "plant", None)
    latest = [0.0, 0.0, 0.0]

    def keep(axis: int, time_s: float, at_mm: float) -> None:
        latest[axis] = at_mm
        if axis == 2:  # the values of one publish come in their order
            true = [one.at_mm for one in carriages.axes] if carriages is not None else []
            rows.append((time_s, *latest, *true))

    for axis in range(3):
        value = board[f"motor.position[{axis}]"]
        assert isinstance(value, ReadValue)
        value.on_publish(partial(keep, axis))
    return rows


def overshoot(rows: list[Row], column: int) -> float:
    """Return by how many mm a column passes the square."""
    low, high = min(SQUARE_MM[0]), max(SQUARE_MM[2])
    return max(0.0, max(row[column] for row in rows) - high, low - min(row[column] for row in rows))


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"sim:{SPEC}?plant={HERE / 'plant.py'}&deadman=0.5"
    parser.add_argument("--link", default=board_url, metavar="URL", help="board to use")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write the path of the square")
    options = parser.parse_args()
    with connect(options.link) as link:
        board = load_spec_objects(load(SPEC), link)
        stage = Stage(board, link)
        shifts = stage.home()
        print("homed; the axes stood at " + ", ".join(f"{shift:.2f}" for shift in shifts) + " mm")
        stage.move(*SQUARE_MM[0], UP_MM)
        rows = record(board, link)
        stage.move(*SQUARE_MM[0], DOWN_MM)
        worst = 0.0
        for x, y in SQUARE_MM[1:]:
            stage.move(x, y)
            at = stage.position()
            worst = max(worst, abs(at[0] - x), abs(at[1] - y))
            print(f"corner {x:g}, {y:g}: the counters are at {at[0]:.4f}, {at[1]:.4f} mm")
        stage.move(*SQUARE_MM[0], UP_MM)
        board.stop_publishing()
        print(f"the steps pass the corners by {max(overshoot(rows, 1), overshoot(rows, 2)):.3f} mm")
        if len(rows[0]) > 4:
            passed = max(overshoot(rows, 4), overshoot(rows, 5))
            print(f"the carriages pass them by {passed:.3f} mm, for the motors are springs")
        if options.csv:
            with options.csv.open("w", newline="", encoding="utf-8") as file:
                csv.writer(file, lineterminator="\n").writerows(
                    [f"{number:.4f}" for number in (row[0] - rows[0][0], *row[1:])] for row in rows
                )
        if worst > TOLERANCE_MM:
            print(f"xyz_stage: a corner was missed by {worst:.4f} mm", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    run_program(main, name="xyz_stage")
