# SPDX-License-Identifier: BSD-3-Clause
"""The front end of ROS 2 for machines with ROS: it uses rclpy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from importlib import import_module
from typing import Any

from unitylink.errors import ToolError

from .interface import Interface, Topic
from .life import Life
from .plane import SERVICE_FIELDS, Port, Refuse, log_refused
from .stamps import Stamps


class RclpyPlane:
    """Carries messages with a node of rclpy. Names are relative to the node's namespace."""

    def __init__(self, node: Any, interface: Interface) -> None:
        self._node = node
        self._interface = interface
        self._header = self._message("std_msgs/Header")
        self._time = self._message("builtin_interfaces/Time")
        self._qos = import_module("rclpy.qos")
        self.life = Life()
        self.stamps = Stamps()
        # In a group of its own, a service such as set_safe is answered even if a callback of a topic hangs.
        self._services = import_module("rclpy.callback_groups").MutuallyExclusiveCallbackGroup()

    def _message(self, type_name: str, part: str = "msg") -> Any:
        package, _, name = type_name.partition("/")
        try:
            return getattr(import_module(f"{package}.{part}"), name)
        except (ImportError, AttributeError) as error:
            raise ToolError(f"no {type_name} ({error}): source install/setup.bash of its workspace") from None

    def maker(self, type_name: str, fields: Sequence[str]) -> Callable[..., Any]:
        made, names = self._message(type_name), tuple(fields)
        return lambda *values: made(**dict(zip(names, values, strict=True)))

    def time(self, time_s: float) -> Any:
        seconds, ns = self.stamps.parts(time_s)
        return self._time(sec=seconds, nanosec=ns)

    def header(self, time_s: float, frame: str) -> Any:
        return self._header(stamp=self.time(time_s), frame_id=frame)

    def level(self, level: int) -> bytes:
        return bytes([level])  # type of `byte` in ROS 2's Python

    def advertise(self, topic: Topic) -> Port:
        publisher = self._node.create_publisher(
            self._message(topic.type), topic.name, self._profile(topic.queue, topic.reliable)
        )
        return Port(publisher.publish, lambda: publisher.get_subscription_count() > 0)

    def gathered(self) -> AbstractContextManager[None]:
        return nullcontext()  # each message is sent alone

    def subscribe(self, topic: Topic, take: Callable[[Any], None], refuse: Refuse = log_refused) -> None:
        del refuse  # rclpy replaces bytes that are not text, and passes on the rest
        profile = self._profile(1, topic.reliable)

        def work(message: Any) -> None:
            with self.life.work("the thread that takes messages"):
                take(message)

        self._node.create_subscription(self._message(topic.type), topic.name, work, profile)

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        request_fields, reply_fields = SERVICE_FIELDS[kind]
        full = kind if "/" in kind else f"{self._interface.package}/{kind}"

        def answer(request: Any, response: Any) -> Any:
            results = handler(*(getattr(request, field) for field, _ in request_fields))
            for (field, _), value in zip(reply_fields, results, strict=True):
                setattr(response, field, value)
            return response

        kind_of_service = self._message(full, "srv")
        self._node.create_service(kind_of_service, name, answer, callback_group=self._services)

    def say(self, level: int, message: str) -> None:
        logger = self._node.get_logger()
        # One line for each severity, because rclpy raises if a line logs with another severity than before.
        if level == 0:
            logger.info(message)
        elif level == 1:
            logger.warning(message)
        else:
            logger.error(message)

    def _profile(self, depth: int, reliable: bool) -> Any:
        policy = self._qos.ReliabilityPolicy
        return self._qos.QoSProfile(
            depth=depth, reliability=policy.RELIABLE if reliable else policy.BEST_EFFORT
        )
