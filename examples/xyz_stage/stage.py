# SPDX-License-Identifier: BSD-3-Clause
"""The axes of the stage: homing, and moves from point to point. Lengths are in mm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from unitylink import Link
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import Node

HOME_MM = 10.0  # where the home switches close
SPEED, ACCELERATION = 200.0, 4000.0  # mm/s, mm/s^2
FAST, SLOW = 80.0, 10.0  # mm/s: to find a switch, and to measure where it is
PATIENCE_S = 6.0
PERIOD_S = 0.01


class Stage:
    """Three axes. Raises UnityLinkError if an axis halts, slips beyond its travel or does not arrive."""

    def __init__(self, board: Node, link: Link) -> None:
        self._board, self._link = board, link
        for axis in range(3):
            self._item("speed", axis).write(SPEED)
            self._item("acceleration", axis).write(ACCELERATION)

    def _item(self, name: str, axis: int) -> Any:
        return self._board[f"motor.{name}[{axis}]"]

    def _control(self, axis: int, *, velocity: bool, latch: str = "none") -> None:
        self._item("control", axis).write(
            {"enable": True, "velocity_mode": velocity, "stop_at_limit": True, "latch": latch}
        )

    def _wait(self, axes: Sequence[int], ready: Callable[[Any], bool], what: str, stop: bool = False) -> None:
        """Wait until all axes are ready. With `stop`, each comes to rest as soon as it is."""
        due_s, waiting = self._link.now_s() + PATIENCE_S, list(axes)
        while waiting:
            states = {axis: self._item("status", axis).read() for axis in waiting}
            for axis, state in states.items():
                if state.halted:
                    raise UnityLinkError(f"axis {axis} is at a limit while it {what}; move it off by hand")
            arrived = [axis for axis in waiting if ready(states[axis])]
            waiting = [axis for axis in waiting if axis not in arrived]
            if stop:
                self._stop(arrived)
            if waiting and self._link.now_s() > due_s:
                raise UnityLinkError(
                    f"axis {waiting[0]} {what} for {PATIENCE_S:g} s; is its motor connected?"
                )
            self._link.sleep_until(self._link.now_s() + PERIOD_S)

    def _drive(self, axes: Sequence[int], speed: float, latch: str = "none") -> None:
        for axis in axes:
            self._item("velocity_target", axis).write(speed)
            self._control(axis, velocity=True, latch=latch)

    def _stop(self, axes: Sequence[int]) -> None:
        for axis in axes:
            self._item("velocity_target", axis).write(0.0)

    def home(self) -> list[float]:
        """Find all home switches. Return how far each axis was from where its counter said, in mm."""
        axes = range(3)
        for speed in (FAST, SLOW):
            closed = [axis for axis in axes if self._item("status", axis).read().home]
            self._drive(closed, FAST / 4)  # off the switch first
            self._wait(closed, lambda state: not state.home, "stays on its home switch", stop=True)
            self._drive(axes, -speed, latch="home")
            self._wait(axes, lambda state: state.latched, "does not find its home switch", stop=True)
            self._wait(axes, lambda state: not state.moving, "does not stop")
        shifts = [HOME_MM - self._item("latched", axis).read() for axis in axes]
        for axis, shift in zip(axes, shifts, strict=True):
            self._item("shift", axis).pulse(shift)
            self._link.sleep_until(self._link.now_s() + PERIOD_S)  # a shift takes 62 µs
            self._item("target", axis).write(self._item("position", axis).read())
            self._control(axis, velocity=False)
        return shifts

    def move(self, *point_mm: float) -> None:
        """Go to a point, and come to rest there. All axes start together."""
        for axis, target in enumerate(point_mm):
            self._item("target", axis).write(target)
        self._wait(range(len(point_mm)), lambda state: state.at_target, "does not arrive")

    def position(self) -> list[float]:
        return [self._item("position", axis).read() for axis in range(3)]
