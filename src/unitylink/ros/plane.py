# SPDX-License-Identifier: BSD-3-Clause
"""The interface between the node and the software that carries its messages: rospy, rclpy, or DDS."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Protocol

from .interface import Topic
from .life import Life
from .stamps import Stamps

_log = logging.getLogger("unitylink.ros")
TRIGGER, SET_BOOL, READ, WRITE = "std_srvs/Trigger", "std_srvs/SetBool", "Read", "Write"

# kind -> (fields of the request, fields of the reply), with fields as in `standard.py`
SERVICE_FIELDS: dict[str, tuple[tuple[tuple[str, str], ...], tuple[tuple[str, str], ...]]] = {
    TRIGGER: ((), (("success", "bool"), ("message", "string"))),
    SET_BOOL: ((("data", "bool"),), (("success", "bool"), ("message", "string"))),
    READ: (
        (("names", "string[]"),),
        (("success", "bool"), ("message", "string"), ("values", "float64[]"), ("texts", "string[]")),
    ),
    WRITE: (
        (("names", "string[]"), ("values", "float64[]")),
        (("success", "bool"), ("message", "string")),
    ),
}


Refuse = Callable[[str, Exception], None]  # topic, why


def log_refused(topic: str, error: Exception) -> None:
    """Log that bytes on a topic were not a message of its type."""
    _log.warning("%s: the message does not have its type: %s", topic, error)


@dataclass(frozen=True)
class Port:
    """The port for messages of one topic.

    `wanted` says whether there is a reader, so that no message is made in vain.
    """

    send: Callable[[Any], object]
    wanted: Callable[[], bool]


class Plane(Protocol):
    """A front end.

    Types have their names of ROS 1: `sensor_msgs/JointState`, and `scara_unitylink/JointFeedback` of the
    robot's own package. Its threads give signs to `life` that they work.
    """

    life: Life
    stamps: Stamps

    def maker(self, type_name: str, fields: Sequence[str]) -> Callable[..., Any]:
        """Return a function that makes a message from the values of its fields, in order."""
        ...

    def time(self, time_s: float) -> Any:
        """Return a time of a link, which is by default one of time.monotonic(), as a stamp."""
        ...

    def header(self, time_s: float, frame: str) -> Any:
        """Return a std_msgs/Header with a time of a link as its stamp."""
        ...

    def level(self, level: int) -> Any:
        """Return a diagnostic level in the type of the front end's messages."""
        ...

    def advertise(self, topic: Topic) -> Port: ...

    def gathered(self) -> AbstractContextManager[None]:
        """Within it, the publishes of this thread may be sent together. All are sent when it ends."""
        ...

    def subscribe(self, topic: Topic, take: Callable[[Any], None], refuse: Refuse = log_refused) -> None:
        """Call `take(message)` for each message. If messages come too fast, only the newest is taken.

        `refuse(topic, error)` is called for bytes that are not a message of its type.
        """
        ...

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        """Offer a service. The handler gets the fields of a request, and returns those of the reply.

        The thread that takes messages does not call it, because that thread may hang, and the service may be
        `set_safe`.
        """
        ...

    def say(self, level: int, message: str) -> None:
        """Log: 0 information, 1 warning, 2 error."""
        ...
