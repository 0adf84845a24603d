# SPDX-License-Identifier: BSD-3-Clause
"""The trained policy drives an arm, and in the middle its line is cut and comes back.

A second board, which stands still, is the clock: time goes on in it while the arm has no link.
"""

from __future__ import annotations

from contextlib import ExitStack, suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from policy import COMMANDED, OBSERVED, Array, hand, torques
from train import DT_S, HERE

from unitylink import LinkError
from unitylink.layer2_message import Link
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.simulate.plants.mujoco import MujocoPlant
from unitylink.spec import load

DEAD_MAN_S = 0.06
CUT_S = 0.5  # for so long there is no line
LOOK_S = 0.001


@dataclass(frozen=True)
class Row:
    time_s: float
    angles: tuple[float, float]
    torques: tuple[float, float]  # as the motors have them
    target: int
    linked: bool


@dataclass(frozen=True)
class Drive:
    rows: list[Row]
    targets: Array
    missed_m: Array  # how far the hand was from each target at the end of its time
    cut_s: float
    back_s: float
    safe_after_s: float  # from the last message to the moment when the motors had no torque
    torque_before_nm: float  # the largest one at the cut
    largest_step_rad: float  # of an angle in a period while the policy drives
    step_at_return_rad: float  # the largest one in the first periods of the new link

    @property
    def safe(self) -> bool:
        """Whether the dead-man was there in time, and the motors had no torque until the line was back."""
        least_s = DEAD_MAN_S + DT_S
        gap = [row for row in self.rows if self.cut_s + least_s < row.time_s < self.back_s]
        return self.safe_after_s <= least_s and bool(gap) and not any(any(row.torques) for row in gap)

    @property
    def jumped(self) -> bool:
        return self.step_at_return_rad > self.largest_step_rad


class Arm:
    """The arm on one link: what the program has to make anew when the line is back."""

    def __init__(self, board: Board) -> None:
        self.link = Link(f"{board.url}?deadman={DEAD_MAN_S}&timeout=1")
        robot = load_spec_objects(load(HERE / "reach.ul"), self.link)
        self.sensors = ValueGroup([robot[path] for path in OBSERVED], "sensors")
        self.motors = ValueGroup([robot[path] for path in COMMANDED], "motors")

    def step(self, numbers: Array, target: Array) -> None:
        seen = self.sensors.snapshot()
        self.motors.write(torques(numbers, np.array([seen[path] for path in OBSERVED]), target).tolist())
        self.link.step(DT_S)


def drive(numbers: Array, targets: Array, *, rtl: bool = False, steps: int = 60) -> Drive:
    """Let the hand go from target to target, `steps` periods each.

    The line is cut on the way to the middle one.
    """
    spec = load(HERE / "reach.ul")
    plant = MujocoPlant(str(HERE / "reach.xml"))
    with ExitStack() as opened:
        if rtl:
            from unitylink.simulate.rtl import RtlBoard

            board: Board = opened.enter_context(RtlBoard(spec, plant=plant, endpoint="lockstep"))
        else:
            board = opened.enter_context(Board(spec, plant=plant, endpoint="lockstep"))
        clock_board = Board(configuration=BoardConfiguration(), endpoint="lockstep")
        clock = opened.enter_context(Link(opened.enter_context(clock_board).url))
        return _drive(numbers, targets, board, clock, steps)


def _drive(numbers: Array, targets: Array, board: Board, clock: Link, steps: int) -> Drive:
    rows: list[Row] = []
    begun_s = clock.now_s()
    torque_at = [element.address for _, element in board.spec.walk() if element.name == "torque"]  # type: ignore[union-attr]

    def note(target: int, linked: bool) -> None:
        words = board.registers.read_many(torque_at)
        motors = [((word & 0xFFFF) ^ 0x8000) - 0x8000 for word in words]
        angles = board.plant.data.qpos  # type: ignore[union-attr]
        rows.append(
            Row(
                clock.now_s() - begun_s,
                (float(angles[0]), float(angles[1])),
                (motors[0] * 1e-4, motors[1] * 1e-4),
                target,
                linked,
            )
        )

    arm, missed = Arm(board), []
    cut_s = back_s = safe_s = torque_nm = 0.0
    returned = 0
    note(0, linked=True)
    for number, target in enumerate(targets):
        for turn in range(steps):
            if number == len(targets) // 2 and turn == steps // 6:
                torque_nm = max(map(abs, rows[-1].torques))
                cut_s = clock.now_s() - begun_s
                board.hang_up()
                while clock.now_s() - begun_s < cut_s + CUT_S:
                    clock.step(LOOK_S)
                    note(number, linked=False)
                    if not safe_s and not any(rows[-1].torques):
                        safe_s = rows[-1].time_s
                _close(arm)
                arm, returned = Arm(board), len(rows)
                arm.link.arm()
                back_s = clock.now_s() - begun_s
            arm.step(numbers, target)
            note(number, linked=True)
        missed.append(float(np.linalg.norm(hand(_seen(rows[-1])) - target)))
    _close(arm)
    moves = np.array(
        [
            max(abs(np.subtract(one.angles, other.angles)))
            for one, other in pairwise(rows)
            if other.linked and one.linked
        ]
    )
    at_return = max(
        max(abs(np.subtract(rows[index].angles, rows[index - 1].angles)))
        for index in range(returned, returned + 3)
    )
    return Drive(
        rows, targets, np.array(missed), cut_s, back_s, safe_s - cut_s if safe_s else np.inf, torque_nm,
        float(moves.max()), float(at_return),
    )  # fmt: skip


def _seen(row: Row) -> Array:
    return np.array([*row.angles, 0.0, 0.0])


def _close(arm: Arm) -> None:
    with suppress(LinkError):  # its line was cut
        arm.link.close()
