# SPDX-License-Identifier: BSD-3-Clause
"""Let a SCARA with stepper motors draw the flower of the paper's SCARA, along the same path.

python examples/scara_stepper/run.py
python examples/scara_stepper/run.py --link "serial:/dev/ttyUSB1?baud=3000000&deadman=0.2"

It begins with the arm stretched and the lift up. The exit code is 1 if a joint does not come back.
"""

from __future__ import annotations

import argparse
import csv
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from unitylink import Link, connect
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "scara_stepper.ul"
sys.path.append(str(HERE.parent / "scara"))  # its geometry and its path
PERIOD_S = 0.02
GAIN = 8.0  # speed in deg/s for each deg off the path
TOLERANCE = 0.1  # deg or mm
# the motor of each joint of the path: shoulder, elbow, lift, tool
MOTORS = (("arm", 0), ("arm", 1), ("lift", 0), ("arm", 2))
ACCELERATIONS = (4000.0, 6000.0, 4000.0, 8000.0)  # deg/s^2, mm/s^2
SPEEDS = (220.0, 300.0, 150.0, 500.0)

Row = list[float]


def follow(board: Any, link: Link, phases: list[tuple[str, Any]]) -> list[Row]:
    """Follow the path by speeds: that of the path, and a part of what is missing. Return rows of joints."""
    measured, rows = [0.0] * 4, []

    def keep(joint: int, _: float, at: float) -> None:
        measured[joint] = at

    for joint, (motor, axis) in enumerate(MOTORS):
        board[f"{motor}.position[{axis}]"].on_publish(partial(keep, joint))
    model = getattr(getattr(link, "board", None), "plant", None)
    speeds = ValueGroup([board[f"{motor}.velocity_target[{axis}]"] for motor, axis in MOTORS], "speeds")
    limits = np.array(SPEEDS)
    began_s = due_s = link.now_s()
    before = np.zeros(4)
    for name, points in phases:
        for point in points:
            wanted = (point - before) / PERIOD_S + GAIN * (before - np.array(measured))
            speeds.write(np.clip(wanted, -limits, limits).tolist())
            before = point
            due_s += PERIOD_S
            link.sleep_until(due_s)
            true = model.joints_deg_mm() if model is not None else (measured[0], measured[1])
            rows.append([due_s - began_s, *map(float, point), *measured, *true[:2]])
        print(f"{name}: {len(points)} set-points")
    return rows


def start(board: Any) -> None:
    for joint, (motor, axis) in enumerate(MOTORS):
        board[f"{motor}.speed[{axis}]"].write(SPEEDS[joint])
        board[f"{motor}.acceleration[{axis}]"].write(ACCELERATIONS[joint])
        board[f"{motor}.velocity_target[{axis}]"].write(0.0)
        control(board, joint, enable=True, velocity=True)


def control(board: Any, joint: int, *, enable: bool, velocity: bool) -> None:
    motor, axis = MOTORS[joint]
    fields = {"enable": enable, "velocity_mode": velocity, "stop_at_limit": False, "latch": "none"}
    board[f"{motor}.control[{axis}]"].write(fields)


def rest(board: Any, link: Link) -> list[float]:
    """Go home to zero in position mode, and return where the joints then are."""
    for joint, (motor, axis) in enumerate(MOTORS):
        board[f"{motor}.target[{axis}]"].write(0.0)
        control(board, joint, enable=True, velocity=False)
    due_s = link.now_s() + 3.0
    while link.now_s() < due_s and not all(
        board[f"{motor}.status[{axis}]"].read().at_target for motor, axis in MOTORS
    ):
        link.sleep_until(link.now_s() + PERIOD_S)
    places = [board[f"{motor}.position[{axis}]"].read() for motor, axis in MOTORS]
    for joint in range(4):
        control(board, joint, enable=False, velocity=False)
    return places


def tool_rows(rows: list[Row]) -> list[Row]:
    """Return (time, then x, y in mm: of the set-points, of the steps, of the arm)."""
    from kinematics import tool_position

    table = np.array(rows)
    places = [tool_position(table[:, column], table[:, column + 1]) for column in (1, 5, 9)]
    return np.column_stack([table[:, 0], *(axis for place in places for axis in place)]).tolist()


def main() -> int:
    from path import demonstration

    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"sim:{SPEC}?plant={HERE / 'plant.py'}&deadman=0.5"
    parser.add_argument("--link", default=board_url, metavar="URL", help="board to use")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write the path of the tool")
    options = parser.parse_args()
    with connect(options.link) as link:
        board: Any = load_spec_objects(load(SPEC), link)
        start(board)
        rows = follow(board, link, demonstration(PERIOD_S))
        places = rest(board, link)
        board.stop_publishing()
    tool = np.array(tool_rows(rows))
    for what, column in (("steps", 3), ("arm", 5)):
        off_mm = np.hypot(tool[:, column] - tool[:, 1], tool[:, column + 1] - tool[:, 2])
        rms_mm = np.sqrt(np.mean(off_mm**2))
        print(f"the {what}: {rms_mm:.2f} mm from the path (rms), {off_mm.max():.2f} at most")
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(
                [f"{one:.3f}" for one in row] for row in tool[::2]
            )
    worst = max(map(abs, places))
    if worst > TOLERANCE:
        print(f"scara_stepper: a joint is {worst:.2f} from where it began", file=sys.stderr)
        return 1
    print("the arm is home again")
    return 0


if __name__ == "__main__":
    run_program(main, name="scara_stepper")
