# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of a node, with the same names in every ROS."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink.errors import UrlError

from .interface import Topic
from .node import Options

DIAGNOSTICS = Topic("/diagnostics", "diagnostic_msgs/DiagnosticArray", "record", ())
DIAGNOSTICS_PERIOD_S = 1.0
LEAST_SPEED, MOST_SPEED = 0.05, 1000.0


@dataclass
class Parameters:
    """The parameters of a node."""

    link: str = ""
    command_timeout: float = 0.0
    deadman_s: float = 1.0
    safe_at_exit: bool = True
    armed: bool = True
    speed: float = 1.0

    def options(self) -> Options:
        """Return the options of the node. Raises UrlError if there is no link, and for a wrong number."""
        if not self.link:
            raise UrlError("no link: set the parameter link, as in link:=serial:/dev/ttyUSB0?baud=3000000")
        for name in ("command_timeout", "deadman_s"):
            if not 0 <= getattr(self, name) < float("inf"):
                raise UrlError(f"{name} {getattr(self, name)}: expected seconds, 0 for never")
        if self.speed and not LEAST_SPEED <= self.speed <= MOST_SPEED:
            raise UrlError(
                f"speed {self.speed}: expected {LEAST_SPEED} to {MOST_SPEED:g} times real time, "
                "or 0 for as fast as the machine can"
            )
        return Options(
            command_timeout_s=self.command_timeout,
            deadman_s=self.deadman_s,
            safe_at_exit=self.safe_at_exit,
            armed=self.armed,
            speed=self.speed,
        )
