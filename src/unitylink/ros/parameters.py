# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of a node, with the same names in every ROS."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

from unitylink.errors import UrlError

from .interface import Topic
from .node import Options

DIAGNOSTICS = Topic("/diagnostics", "diagnostic_msgs/DiagnosticArray", "record", ())
DIAGNOSTICS_PERIOD_S = 1.0
LEAST_SPEED, MOST_SPEED = 0.05, 1000.0
MOST_S = 1e6


def _told(standard: Any, description: str, most: float | None = None) -> Any:
    return field(default=standard, metadata={"description": description, "most": most})


@dataclass(frozen=True)
class Described:
    """A parameter as `ros2 param describe` shows it."""

    name: str
    standard: Any
    description: str
    most: float | None


@dataclass
class Parameters:
    """The parameters of a node."""

    link: str = _told("", "where the board is, such as serial:/dev/ttyUSB0?baud=3000000")
    command_timeout: float = _told(
        0.0, "s without a command after which the safe values are written; 0: never", MOST_S
    )
    deadman_s: float = _told(
        1.0, "s without a sign of life until the gateware makes its outputs safe; 0: never", MOST_S
    )
    safe_at_exit: bool = _told(True, "write the safe values when the node ends")
    armed: bool = _told(True, "take commands at once; else after the service arm was called")
    speed: float = _told(
        1.0,
        "how fast the time of a virtual board with time=lockstep passes; 0: as fast as it can",
        MOST_SPEED,
    )

    @classmethod
    def described(cls) -> list[Described]:
        """Return what ROS 2 tells of each parameter. Numbers are from 0 to `most`."""
        return [
            Described(one.name, one.default, one.metadata["description"], one.metadata["most"])
            for one in fields(cls)
        ]

    def options(self) -> Options:
        """Return the options of the node. Raises UrlError if there is no link, and for a wrong number."""
        if not self.link:
            raise UrlError("no link: set the parameter link, as in link:=serial:/dev/ttyUSB0?baud=3000000")
        for name in ("command_timeout", "deadman_s"):
            if not 0 <= getattr(self, name) <= MOST_S:
                raise UrlError(f"{name} {getattr(self, name)}: expected 0 to {MOST_S:.0f} s, 0 for never")
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
