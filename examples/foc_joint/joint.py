# SPDX-License-Identifier: BSD-3-Clause
"""The joint: how its currents, its angle and its path are switched on, and what it last told."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from unitylink import Link
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import Node

OHM, HENRY, BANDWIDTH = 0.2, 200e-6, 2 * math.pi * 500  # of the motor, and of its currents in 1/s
NM_A_AMPERE, INERTIA, STIFFNESS = 0.05, 2e-3, 2 * math.pi * 9  # of the arm, and of its loop in 1/s
ALIGN_A, CURRENT_MOST_A, TRIP_A = 6.0, 12.0, 25.0
SPEED, ACCELERATION, ERROR_MOST = 8.0, 60.0, 0.5  # rad/s, rad/s^2, rad
PERIOD_S, PATIENCE_S = 0.01, 3.0
NAMES = ("shaft.position", "loop.current_d", "loop.current_q")


class Joint:
    """Raises UnityLinkError if it does not start, if it stops by itself, or if it does not arrive."""

    def __init__(self, board: Node, link: Link) -> None:
        self._board, self._link = board, link
        self.seen = dict.fromkeys(NAMES, 0.0)
        self.rows: list[tuple[float, ...]] = []
        for name in NAMES:
            self.item(name).on_publish(self._keeper(name))

    def item(self, name: str) -> Any:
        return self._board[name]

    def _keeper(self, name: str) -> Callable[[float, float], None]:
        def keep(time_s: float, value: float) -> None:
            self.seen[name] = value

        return keep

    def tune(self) -> None:
        """Write all gains, from the data of motor and arm."""
        item = self.item
        item("loop.kp").write(HENRY * BANDWIDTH)
        item("loop.ki").write(OHM * BANDWIDTH)
        item("loop.apply").pulse()
        item("servo.kp").write(INERTIA * STIFFNESS**2 / NM_A_AMPERE)
        item("servo.ki").write(INERTIA * STIFFNESS**3 / NM_A_AMPERE / 3)
        item("servo.kd").write(2 * INERTIA * STIFFNESS / NM_A_AMPERE)
        item("servo.kv").write(2 * INERTIA * STIFFNESS / NM_A_AMPERE)
        item("servo.ka").write(INERTIA / NM_A_AMPERE)
        item("servo.apply").pulse()
        item("servo.limit").write(CURRENT_MOST_A)
        item("servo.error_limit").write(ERROR_MOST)
        item("path.speed").write(SPEED)
        item("path.acceleration").write(ACCELERATION)
        item("current.limit").write(TRIP_A)

    def start(self) -> float:
        """Switch on from the sensors to the bridge, and let the rotor turn to its zero, by this current."""
        item = self.item
        for channel in range(2):  # without a current
            item(f"current.offset[{channel}]").write(0.0)
        self.wait(PERIOD_S)
        for channel in range(2):
            item(f"current.offset[{channel}]").write(item(f"current.value[{channel}]").read())
        for part in ("stop", "current"):
            item(f"{part}.control").write({"enable": False})
            item(f"{part}.control").write({"enable": True})
        self.wait(PERIOD_S)
        if not (item("stop.status").read().running and item("current.status").read().running):
            raise UnityLinkError("is the stop button pressed, or a line of a current open?")
        item("loop.control").write({"enable": True, "align": True})
        item("motor.control").write({"enable": True, "sample_start": False, "sample_middle": False})
        item("loop.target_d").write(ALIGN_A)
        for _ in range(50):
            self.watch()
        aligned_a = self.seen["loop.current_d"]
        item("shaft.position").write(0.0)
        item("loop.target_d").write(0.0)
        item("loop.control").write({"enable": True, "align": False})
        item("path.target").write(0.0)
        item("path.control").write({"enable": True})
        item("servo.control").write({"enable": True})
        return aligned_a

    def go_to(self, angle: float) -> float:
        """Turn to an angle, and return where the shaft then is."""
        self.item("path.target").write(angle)
        due_s = self._link.now_s() + PATIENCE_S
        while not self.item("path.status").read().arrived:
            self.check()
            if self._link.now_s() > due_s:
                raise UnityLinkError(f"the joint does not arrive within {PATIENCE_S:g} s; is it blocked?")
            self.watch()
        for _ in range(30):  # the loop settles
            self.watch()
        self.check()
        return float(self.item("shaft.position").read())

    def watch(self) -> None:
        """Wait a period, and keep what the sensors have said, and where the path is."""
        self.wait(PERIOD_S)
        self.rows.append((self._link.now_s(), self.item("path.position").read(), *self.seen.values()))

    def check(self) -> None:
        """Raise UnityLinkError if a part of the gateware has stopped."""
        for part in ("stop", "motor", "current", "loop", "servo"):
            if not self.item(f"{part}.status").read().running:
                raise UnityLinkError(f"the joint has stopped: see {part}.status")

    def stop(self) -> None:
        """Switch all off, the bridge first."""
        fields: dict[str, dict[str, bool]] = {
            "motor": {"enable": False, "sample_start": False, "sample_middle": False},
            "loop": {"enable": False, "align": False},
        }
        for part in ("motor", "loop", "servo", "path", "current", "stop"):
            self.item(f"{part}.control").write(fields.get(part, {"enable": False}))

    def wait(self, seconds: float) -> None:
        self._link.sleep_until(self._link.now_s() + seconds)
