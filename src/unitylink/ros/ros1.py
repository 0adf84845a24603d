# SPDX-License-Identifier: BSD-3-Clause
"""The front end of ROS 1: rospy."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from importlib import import_module
from typing import TYPE_CHECKING, Any

from unitylink.errors import ToolError, UnityLinkError

from .health import diagnostics
from .interface import Interface, Topic
from .life import Life
from .node import RobotNode
from .parameters import DIAGNOSTICS, DIAGNOSTICS_PERIOD_S, Parameters
from .plane import SERVICE_FIELDS, Port, Refuse, log_refused
from .stamps import Stamps

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node


def _module(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        version = ".".join(map(str, sys.version_info[:2]))
        raise ToolError(
            f"Python {version} at {sys.executable} cannot import {name} ({error}). It is a "
            "part of ROS 1: make the virtual environment with --system-site-packages and with the Python of "
            "ROS. The messages of a robot's package need its workspace: source devel/setup.bash"
        ) from None


class RospyPlane:
    """Carries messages by rospy, after rospy.init_node."""

    def __init__(self, package: str) -> None:
        self._package = package  # the robot's package, which has the types of the services
        self.rospy = _module("rospy")
        self._time = _module("genpy").Time
        self._header = _module("std_msgs.msg").Header
        self.life = Life()
        self.stamps = Stamps()

    def message(self, type_name: str) -> Any:
        package, _, name = type_name.partition("/")
        return getattr(_module(f"{package}.msg"), name)

    def maker(self, type_name: str, fields: Sequence[str]) -> Callable[..., Any]:
        made = self.message(type_name)
        if tuple(made.__slots__) != tuple(fields):
            raise ToolError(
                f"{type_name} has the fields {', '.join(made.__slots__)}, and the robot has "
                f"{', '.join(fields)}: "
                "build the generated package again (catkin_make)"
            )
        return made  # type: ignore[no-any-return]  # a message class takes its fields in order

    def time(self, time_s: float) -> Any:
        return self._time(*self.stamps.parts(time_s))

    def header(self, time_s: float, frame: str) -> Any:
        return self._header(0, self._time(*self.stamps.parts(time_s)), frame)

    def level(self, level: int) -> int:
        return level

    def advertise(self, topic: Topic) -> Port:
        publisher = self.rospy.Publisher(
            topic.name, self.message(topic.type), queue_size=topic.queue, tcp_nodelay=True
        )
        return Port(publisher.publish, lambda: publisher.get_num_connections() > 0)

    def gathered(self) -> AbstractContextManager[None]:
        return nullcontext()  # each message is sent alone

    def subscribe(
        self, topic: Topic, take: Callable[[Any], None], refuse: Refuse = log_refused, *, depth: int = 1
    ) -> None:
        del refuse  # rospy replaces bytes that are not text, and passes on the rest

        def work(message: Any) -> None:
            with self.life.work("the thread that takes messages"):
                take(message)

        self.rospy.Subscriber(topic.name, self.message(topic.type), work, queue_size=depth, tcp_nodelay=True)

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        package, _, name_of_type = kind.rpartition("/")
        service = getattr(_module(f"{package or self._package}.srv"), name_of_type)
        fields = [field for field, _ in SERVICE_FIELDS[kind][0]]
        self.rospy.Service(
            name, service, lambda request: handler(*(getattr(request, field) for field in fields))
        )

    def say(self, level: int, message: str) -> None:
        (self.rospy.loginfo, self.rospy.logwarn, self.rospy.logerr)[level](message)


def main(interface: Interface, robot: Callable[[Link], Node], connect: Callable[..., Link]) -> int:
    """Run a generated package's node, and return its exit code. An error is printed in one line."""
    try:
        return run(interface, robot, connect)
    except UnityLinkError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


def run(
    interface: Interface,
    build: Callable[[Link], Node],
    connect: Callable[..., Link],
    parameters: Parameters | None = None,
    *,
    namespace: str = "",
    services: bool = True,
) -> int:
    """Run the robot's node until ROS ends it.

    Return the exit code. Without `parameters`, they come from ROS.
    """
    if namespace:
        os.environ["ROS_NAMESPACE"] = namespace  # rospy reads this when it is imported
    plane = RospyPlane(interface.package)
    rospy = plane.rospy
    rospy.init_node("unitylink" if namespace else interface.robot)
    if parameters is None:
        parameters = Parameters()
        for name, standard in vars(Parameters()).items():
            setattr(parameters, name, type(standard)(rospy.get_param(f"~{name}", standard)))
    options, url = parameters.options(), parameters.link
    node = RobotNode(
        interface, plane, lambda: connect(url, reconnect="auto"), build, options, services=services
    )
    told = plane.advertise(DIAGNOSTICS)
    try:
        while not rospy.is_shutdown() and not node.keeper.ended.is_set():
            told.send(diagnostics(plane, rospy.get_name(), node.health(), plane.stamps.now_s()))
            node.keeper.ended.wait(DIAGNOSTICS_PERIOD_S)
    except rospy.ROSException:  # a publish while ROS shuts down
        if not rospy.is_shutdown():
            raise
    finally:
        node.close()
    return 1 if node.keeper.failure is not None else 0
