# SPDX-License-Identifier: BSD-3-Clause
"""Let an arm with six bus servos and a gripper pick something up and put it down elsewhere.

python examples/bus_arm/run.py
python examples/bus_arm/run.py --link "serial:/dev/ttyUSB1?baud=1000000&deadman=0.2"

It begins where the arm is. The exit code is 1 if a servo falls silent, or if the arm does not come home.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from functools import partial
from pathlib import Path
from typing import Any

from unitylink import Link, connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.program import run_program
from unitylink.spec import load

HERE = Path(__file__).resolve().parent
SPEC = HERE / "bus_arm.ul"
SERVOS = 7
PERIOD_S, PATIENCE_S = 0.02, 3.0
SPEED = 1.6  # rad/s at most
TOLERANCE = 0.03  # rad
HOME = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
# name, and the angles of base, shoulder, elbow, forearm, wrist, hand and gripper in rad
POSES = (
    ("above it", (0.8, 0.6, 1.0, 0.0, 0.6, 0.0, 0.5)),
    ("down", (0.8, 0.9, 1.1, 0.0, 0.5, 0.0, 0.5)),
    ("grip", (0.8, 0.9, 1.1, 0.0, 0.5, 0.0, -0.2)),
    ("up", (0.8, 0.4, 1.0, 0.0, 0.6, 0.0, -0.2)),
    ("turn", (-0.9, 0.4, 1.0, 0.6, 0.6, 1.2, -0.2)),
    ("put down", (-0.9, 0.9, 1.1, 0.0, 0.5, 0.0, -0.2)),
    ("let go", (-0.9, 0.9, 1.1, 0.0, 0.5, 0.0, 0.5)),
    ("home", HOME),
)


class Arm:
    """The seven servos: what they last told, and how they move.

    Raises UnityLinkError if one falls silent.
    """

    def __init__(self, board: Any, link: Link) -> None:
        self._board, self._link = board, link
        self.measured = [0.0] * SERVOS
        self.rows: list[list[float]] = []
        self._goals = ValueGroup([board[f"arm.goal[{n}]"] for n in range(SERVOS)], "goals")

    def start(self) -> None:
        """Wait for all servos, then let them follow from where they are. So none jumps."""
        due_s = self._link.now_s() + PATIENCE_S
        while not all(self._status(number).valid for number in range(SERVOS)):
            if self._link.now_s() > due_s:
                raise UnityLinkError(f"{self._absent()}; check ids, wires and power")
            self._link.sleep_until(self._link.now_s() + PERIOD_S)
        for number in range(SERVOS):
            self.measured[number] = self._board[f"arm.position[{number}]"].read()
            self._board[f"arm.position[{number}]"].on_publish(partial(self._keep, number))
        self.at = list(self.measured)
        self._goals.write(self.at)
        for number in range(SERVOS):
            self._board[f"arm.drive[{number}]"].write("follow")
        self._began_s = self._due_s = self._link.now_s()

    def _keep(self, number: int, _: float, angle: float) -> None:
        self.measured[number] = angle

    def _status(self, number: int) -> Any:
        return self._board[f"arm.status[{number}]"].read()

    def _absent(self) -> str:
        gone = [str(number + 1) for number in range(SERVOS) if not self._status(number).valid]
        return (
            f"no answer of the servos with the ids {', '.join(gone)}" if gone else "a servo does not arrive"
        )

    def move(self, pose: tuple[float, ...]) -> None:
        """Go to a pose by a smooth path, and wait until all are there."""
        begun = self.at
        way = max(abs(to - now) for to, now in zip(pose, begun, strict=True))
        count = max(1, math.ceil(1.9 * way / SPEED / PERIOD_S))  # the path is fastest in its middle
        for number in range(1, count + 1):
            t = number / count
            share = t**3 * (10 - 15 * t + 6 * t * t)
            self.at = [now + share * (to - now) for to, now in zip(pose, begun, strict=True)]
            self._goals.write(self.at)
            self._wait()
        due_s = self._link.now_s() + PATIENCE_S
        while self.error(pose) > TOLERANCE:
            if self._link.now_s() > due_s:
                raise UnityLinkError(f"{self._absent()}: {self.error(pose):.2f} rad off; is the arm blocked?")
            self._due_s = self._link.now_s()
            self._wait()

    def error(self, pose: tuple[float, ...]) -> float:
        """Return how far the joint that is worst is from a pose, in rad."""
        return max(abs(to - now) for to, now in zip(pose, self.measured, strict=True))

    def _wait(self) -> None:
        self._due_s += PERIOD_S
        self._link.sleep_until(self._due_s)
        model = getattr(getattr(self._link, "board", None), "plant", None)
        true = model.angles() if model is not None else self.measured
        self.rows.append([self._due_s - self._began_s, *self.at, *true])

    def hold(self) -> None:
        for number in range(SERVOS):
            self._board[f"arm.drive[{number}]"].write("hold")


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    board_url = f"sim:{SPEC}?plant={HERE / 'plant.py'}&deadman=0.5"
    parser.add_argument("--link", default=board_url, metavar="URL", help="board to use")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write goals and angles")
    options = parser.parse_args()
    with connect(options.link) as link:
        board: Any = load_spec_objects(load(SPEC), link)
        arm = Arm(board, link)
        arm.start()
        try:
            for name, pose in POSES:
                arm.move(pose)
                print(f"{name}: {arm.error(pose):.3f} rad off, a cycle takes {board['arm.lasted'].read()} us")
        finally:
            arm.hold()
            board.stop_publishing()
        if options.csv:
            with options.csv.open("w", newline="", encoding="utf-8") as file:
                rows = [[f"{number:.4f}" for number in row] for row in arm.rows[::2]]
                csv.writer(file, lineterminator="\n").writerows(rows)
        missed = arm.error(HOME)
    if missed > TOLERANCE:
        print(f"bus_arm: the arm is {missed:.2f} rad from home", file=sys.stderr)
        return 1
    print("the arm is home, and holds")
    return 0


if __name__ == "__main__":
    run_program(main, name="bus_arm")
