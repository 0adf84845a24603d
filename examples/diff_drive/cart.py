# SPDX-License-Identifier: BSD-3-Clause
"""The cart: what its sensors last said, where it is, and how it is driven."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from unitylink import Link
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import Node
from unitylink.ros.odometry import Odometry

RADIUS_M, TRACK_M = 0.04, 0.24
FULL_SPEED = 22.0  # rad/s of a wheel at the full voltage
GAIN = 0.06  # duty for each rad/s that a wheel is too slow
FRICTION = 0.03  # duty that overcomes the friction of a wheel
SPEED, PULL = 0.5, 1.0  # m/s, m/s^2
TURN, TWIST = 3.0, 8.0  # rad/s, rad/s^2
HOLD = 4.0  # rad/s for each rad off the heading
NEAR_M, NEAR_RAD = 0.004, 0.015
PERIOD_S, SILENCE_S, PATIENCE_S = 0.02, 0.3, 8.0
NAMES = (
    "left_wheel.position",
    "right_wheel.position",
    "left_wheel.velocity",
    "right_wheel.velocity",
    "imu.turn[2]",
)


class Cart:
    """Drives by the heading of the gyroscope. `wheels` is where it would be by its wheels alone.

    Raises UnityLinkError if its sensors are silent, or if it does not arrive.
    """

    def __init__(self, board: Node, link: Link) -> None:
        self._board, self._link = board, link
        self._seen = dict.fromkeys(NAMES, 0.0)
        self._seen_s = link.now_s()
        self.wheels = Odometry(RADIUS_M, TRACK_M)
        self.x_m = self.y_m = self.heading = self.bias = 0.0
        self.rows: list[tuple[float, ...]] = []
        self._before: tuple[float, float] | None = None
        for name in NAMES:
            self._item(name).on_publish(self._keeper(name))

    def _item(self, name: str) -> Any:
        return self._board[name]

    def _keeper(self, name: str) -> Callable[[float, float], None]:
        def keep(time_s: float, value: float) -> None:
            self._seen[name], self._seen_s = value, time_s

        return keep

    def start(self) -> None:
        """Measure the bias of the gyroscope at rest, then switch the bridges on."""
        turns = []
        for _ in range(15):
            self._wait()
            turns.append(self._seen["imu.turn[2]"])
        self.bias = sum(turns[5:]) / len(turns[5:])
        if not self._item("imu.status").read().valid:
            raise UnityLinkError("the IMU does not answer; check its wires (imu.status says why)")
        for side in ("left", "right"):
            self._item(f"{side}_motor.duty").write(0.0)
            self._item(f"{side}_motor.control").write({"enable": True, "coast": False})

    def stop(self) -> None:
        for side in ("left", "right"):
            self._item(f"{side}_motor.control").write({"enable": False, "coast": False})

    def _wait(self) -> None:
        """Wait a period, and take what the sensors have said."""
        self._link.sleep_until(self._link.now_s() + PERIOD_S)
        if self._link.now_s() - self._seen_s > SILENCE_S:
            raise UnityLinkError("the sensors are silent; is the cart still connected?")
        now_s, left, right = self._seen_s, *(self._seen[name] for name in NAMES[:2])
        way_m = RADIUS_M * (left + right) / 2
        if self._before is not None and now_s > self._before[0]:
            turned = math.radians(self._seen["imu.turn[2]"] - self.bias) * (now_s - self._before[0])
            self.x_m += (way_m - self._before[1]) * math.cos(self.heading + turned / 2)
            self.y_m += (way_m - self._before[1]) * math.sin(self.heading + turned / 2)
            self.heading += turned
            self.wheels.turned(now_s, left, right)
            self._keep_row(now_s)
        self._before = now_s, way_m

    def _keep_row(self, now_s: float) -> None:
        model = getattr(getattr(self._link, "board", None), "plant", None)
        true = (model.x_m, model.y_m) if model is not None else ()
        self.rows.append((now_s, self.x_m, self.y_m, self.wheels.x_m, self.wheels.y_m, *true))

    def _drive(self, speed: float, turn: float) -> None:
        """Let the wheels have the speeds of a speed in m/s and a turn in rad/s."""
        for side, sign in (("left", -1), ("right", 1)):
            wanted = (speed + sign * turn * TRACK_M / 2) / RADIUS_M
            error = wanted - self._seen[f"{side}_wheel.velocity"]
            duty = wanted / FULL_SPEED + GAIN * error + (math.copysign(FRICTION, wanted) if wanted else 0.0)
            self._item(f"{side}_motor.duty").write(min(max(duty, -1.0), 1.0))

    def forward(self, way_m: float, heading: float) -> None:
        """Go straight on by a way, and keep to a heading."""
        start = self.x_m, self.y_m
        self._until(
            lambda: way_m - math.hypot(self.x_m - start[0], self.y_m - start[1]),
            lambda left_m: (braked(left_m, SPEED, PULL), HOLD * (heading - self.heading)),
            NEAR_M,
        )

    def turn_to(self, heading: float) -> None:
        self._until(lambda: heading - self.heading, lambda left: (0.0, braked(left, TURN, TWIST)), NEAR_RAD)

    def _until(
        self, left: Callable[[], float], speeds: Callable[[float], tuple[float, float]], near: float
    ) -> None:
        due_s = self._link.now_s() + PATIENCE_S
        while abs(left()) > near:
            if self._link.now_s() > due_s:
                raise UnityLinkError(f"the cart does not arrive within {PATIENCE_S:g} s; is a wheel blocked?")
            self._drive(*speeds(left()))
            self._wait()
        self._drive(0.0, 0.0)


def braked(left: float, most: float, brake: float) -> float:
    """Return a speed from which it can still stop. Near the end it is proportional to what is left."""
    size = min(most, math.sqrt(2 * brake * abs(left)), 6.0 * abs(left) + 0.03 * most)
    return math.copysign(size, left)
