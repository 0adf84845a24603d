# SPDX-License-Identifier: BSD-3-Clause
"""What the front ends of ROS 2 without ROS have in common: names, messages and their CDR."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from typing import Any

from unitylink.optional import absent

from .dds_types import DdsTypes
from .interface import Interface
from .life import Life
from .stamps import Stamps
from .standard import definitions

_log = logging.getLogger("unitylink.ros")
# So many commands may come before the node's thread runs. The thread takes all of them and joins them, value
# by value. Two messages may name different joints, so none of them may be dropped, and none waits.
COMMANDS = 16
NODE = "unitylink"  # the name of the node


class CdrPlane:
    """The part of a plane that does not depend on what carries the messages. Raises ToolError."""

    def __init__(self, interface: Interface, namespace: str, network: str) -> None:
        try:
            import cyclonedds.idl  # noqa: F401  it makes the CDR of the messages
        except ImportError:
            raise absent("cyclonedds", f"ROS 2 over {network}") from None
        self.definitions = definitions(interface)
        self.types = DdsTypes(self.definitions)
        self.life = Life()
        self.stamps = Stamps()
        self._interface = interface
        self._namespace = namespace.strip("/")
        self._header = self.types["std_msgs/Header"]
        self._time = self.types["builtin_interfaces/Time"]

    def name(self, topic: str) -> str:
        """Return a name with its namespace. A name that begins with / is left as it is."""
        return topic[1:] if topic.startswith("/") else f"{self._namespace}/{topic}".lstrip("/")

    def maker(self, type_name: str, fields: Sequence[str]) -> Callable[..., Any]:
        made = self.types[type_name]
        return made  # type: ignore[no-any-return]  # a dataclass takes its fields in order

    def time(self, time_s: float) -> Any:
        return self._time(*self.stamps.parts(time_s))

    def header(self, time_s: float, frame: str) -> Any:
        return self._header(self._time(*self.stamps.parts(time_s)), frame)

    def level(self, level: int) -> int:
        return level

    def say(self, level: int, message: str) -> None:
        _log.log((logging.INFO, logging.WARNING, logging.ERROR)[level], message)

    def service_name(self, kind: str) -> str:
        """Return the type of a service with its package: the robot's own, if `kind` names none."""
        return kind if "/" in kind else f"{self._interface.package}/{kind}"


class Matched:
    """Whether somebody reads a topic. The network is asked a few times a second, and not at each message."""

    PERIOD_S = 0.1

    def __init__(self, ask: Callable[[], object]) -> None:
        self._ask = ask
        self._asked_s = float("-inf")
        self._matched = False

    def __call__(self) -> bool:
        now = time.monotonic()
        if now - self._asked_s > self.PERIOD_S:
            self._asked_s = now
            self._matched = bool(self._ask())
        return self._matched
