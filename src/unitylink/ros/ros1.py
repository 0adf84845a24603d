# SPDX-License-Identifier: BSD-3-Clause
"""The front end of ROS 1: rospy."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from unitylink.errors import ToolError, UnityLinkError

from .health import diagnostics
from .interface import Interface, Topic
from .node import Options, RobotNode
from .plane import READ, SET_BOOL, TRIGGER, Port

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node

DIAGNOSTICS_PERIOD_S = 1.0


def _module(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError as error:
        version = ".".join(map(str, sys.version_info[:2]))
        raise ToolError(
            f"Python {version} at {sys.executable} cannot import {name} ({error}). ROS 1 brings it; "
            "a virtual environment that is to see it is made with --system-site-packages, by the Python that "
            "ROS was made for; messages of a robot's package need its workspace: source devel/setup.bash"
        ) from None


class RospyPlane:
    """Carries messages by rospy, after rospy.init_node."""

    def __init__(self) -> None:
        self.rospy = _module("rospy")
        self._time = _module("genpy").Time
        self._header = _module("std_msgs.msg").Header

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

    def header(self, time_s: float, frame: str) -> Any:
        ns = int((time.time() - time.monotonic() + time_s) * 1e9)
        return self._header(0, self._time(ns // 1_000_000_000, ns % 1_000_000_000), frame)

    def level(self, level: int) -> int:
        return level

    def advertise(self, topic: Topic) -> Port:
        publisher = self.rospy.Publisher(
            topic.name, self.message(topic.type), queue_size=topic.queue, tcp_nodelay=True
        )
        return Port(publisher.publish, lambda: publisher.get_num_connections() > 0)

    def subscribe(self, topic: Topic, take: Callable[[Any], None]) -> None:
        self.rospy.Subscriber(topic.name, self.message(topic.type), take, queue_size=1, tcp_nodelay=True)

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        std = _module("std_srvs.srv")
        if kind == TRIGGER:
            self.rospy.Service(name, std.Trigger, lambda _: handler())
        elif kind == SET_BOOL:
            self.rospy.Service(name, std.SetBool, lambda request: handler(request.data))
        else:
            service = getattr(_module(f"{self.package}.srv"), kind)
            if kind == READ:
                self.rospy.Service(name, service, lambda request: handler(request.names))
            else:
                self.rospy.Service(name, service, lambda request: handler(request.names, request.values))

    package = ""  # of the robot, whose services it has

    def say(self, level: int, message: str) -> None:
        (self.rospy.loginfo, self.rospy.logwarn, self.rospy.logerr)[level](message)


def main(interface: Interface, robot: Callable[[Link], Node], connect: Callable[[str], Link]) -> int:
    """Run a generated package's node, and return its exit code; errors are told in a line."""
    try:
        return run(interface, robot, connect)
    except UnityLinkError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


def run(
    interface: Interface,
    build: Callable[[Link], Node],
    connect: Callable[[str], Link],
    *,
    url: str = "",
    services: bool = True,
    arguments: Sequence[str] | None = None,
) -> int:
    """Run the robot's node until ROS ends it; return the exit code.

    Parameters of the node: `link` (the URL, if not given here), `command_timeout`, `safe_at_exit`, `armed`.
    """
    plane = RospyPlane()
    plane.package = interface.package
    rospy = plane.rospy
    rospy.init_node(interface.robot, argv=list(sys.argv if arguments is None else arguments))
    link_url = url or str(rospy.get_param("~link", ""))
    if not link_url:
        rospy.logfatal("no link: set the parameter ~link, as in _link:=serial:/dev/ttyUSB0?baud=3000000")
        return 2
    options = Options(
        command_timeout_s=float(rospy.get_param("~command_timeout", 0.0)),
        safe_at_exit=bool(rospy.get_param("~safe_at_exit", True)),
        armed=bool(rospy.get_param("~armed", True)),
        services=services,
    )
    node = RobotNode(interface, plane, lambda: connect(link_url), build, options)
    told = plane.advertise(Topic("/diagnostics", "diagnostic_msgs/DiagnosticArray", "record", (), queue=10))
    try:
        while not rospy.is_shutdown() and not node.keeper.ended.wait(DIAGNOSTICS_PERIOD_S):
            told.send(diagnostics(plane, rospy.get_name(), node.health(), time.monotonic()))
    except rospy.ROSException:  # publishing while ROS shuts down
        if not rospy.is_shutdown():
            raise
    finally:
        node.close()
    return 1 if node.keeper.failure is not None else 0
