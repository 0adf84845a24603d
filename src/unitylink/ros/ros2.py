# SPDX-License-Identifier: BSD-3-Clause
"""The node of ROS 2. It uses rclpy if ROS is installed, else only DDS or Zenoh."""

from __future__ import annotations

import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnityLinkError, UrlError
from unitylink.program import stopped_by_signals

from .dds import DdsPlane
from .health import diagnostics
from .interface import Interface
from .life import DEVICE_S
from .node import RobotNode
from .parameters import DIAGNOSTICS, DIAGNOSTICS_PERIOD_S, Described, Parameters
from .rclpy_plane import RclpyPlane
from .zenoh_plane import ZenohPlane

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node

DDS, ZENOH = "dds", "zenoh"  # what carries the messages of a node without rclpy
Build = Callable[["Link"], "Node"]
Connect = Callable[..., "Link"]  # as unitylink.connect


def main(interface: Interface, robot: Build, connect: Connect, arguments: Sequence[str] | None = None) -> int:
    """Run a generated package's node.

    Return the exit code. With `--dds` or `--zenoh` it does not use rclpy even if that is installed.

    Parameters have the form of ROS 2: `--ros-args -p link:=serial:/dev/ttyUSB0 -r __ns:=/left`.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    flags = {over: f"--{over}" in given for over in (DDS, ZENOH)}
    try:
        if not any(flags.values()) and find_spec("rclpy") is not None:
            return _run_rclpy(interface, robot, connect, given)
        parameters, namespace = parse(given, f"/{interface.robot}")
        over = next((over for over, asked in flags.items() if asked), carrier())
        if not any(flags.values()):
            name = {DDS: "DDS", ZENOH: "Zenoh"}[over]
            print(f"rclpy is not here: running on {name} alone, which ROS 2 sees the same", file=sys.stderr)
        return run_alone(interface, robot, connect, parameters, namespace=namespace, over=over)
    except UnityLinkError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1


def parse(arguments: Sequence[str], namespace: str) -> tuple[Parameters, str]:
    """Read the arguments after `--ros-args`: `-p NAME:=VALUE` and `-r __ns:=NAMESPACE`.

    >>> parameters, namespace = parse(["-p", "link:=tcp://127.0.0.1:5555", "-p", "armed:=false"], "/scara")
    >>> parameters.link, parameters.armed, namespace
    ('tcp://127.0.0.1:5555', False, '/scara')
    """
    found = Parameters()
    words = [word for word in arguments if word not in ("--ros-args", "--dds", "--zenoh")]
    while words:
        flag = words.pop(0)
        name, parted, value = (words.pop(0) if words else "").partition(":=")
        if flag in ("-r", "--remap") and name == "__ns" and parted:
            namespace = value
        elif flag in ("-r", "--remap") and name == "__node" and parted:
            continue  # without ROS a node has no name
        elif flag in ("-p", "--param") and parted and hasattr(found, name):
            setattr(found, name, _value(name, getattr(found, name), value))
        else:
            known = ", ".join(vars(found))
            raise UrlError(
                f"{flag} {name}{parted}{value}: expected -p NAME:=VALUE of {known}, or -r __ns:=/NAME"
            )
    return found, namespace


def _value(name: str, standard: Any, text: str) -> Any:
    if isinstance(standard, bool):
        if text.lower() not in ("true", "false"):
            raise UrlError(f"{name}:={text}: expected true or false")
        return text.lower() == "true"
    try:
        return type(standard)(text)
    except ValueError:
        raise UrlError(f"{name}:={text}: expected a number") from None


def carrier() -> str:
    """Return what carries the messages of a node without rclpy: what RMW_IMPLEMENTATION says, or DDS."""
    return ZENOH if os.environ.get("RMW_IMPLEMENTATION") == "rmw_zenoh_cpp" else DDS


def run_alone(
    interface: Interface,
    build: Build,
    connect: Connect,
    parameters: Parameters,
    *,
    namespace: str,
    services: bool = True,
    over: str = DDS,
    until: threading.Event | None = None,
) -> int:
    """Run the node without rclpy until SIGINT, SIGTERM or `until`. Return the exit code.

    `over` is "dds" or "zenoh".
    """
    if not logging.getLogger().handlers:
        logging.basicConfig(level=logging.INFO, format="%(levelname)s: %(message)s")
    text = os.environ.get("ROS_DOMAIN_ID", "0") or "0"
    if not text.isdigit() or int(text) > 232:
        raise UrlError(f"ROS_DOMAIN_ID={text}: expected 0 to 232")
    with stopped_by_signals() if until is None else nullcontext(until) as stop:
        options = parameters.options()
        plane = _plane(over, interface, namespace, int(text))
        node = RobotNode(
            interface,
            plane,
            lambda: connect(parameters.link, reconnect="auto"),
            build,
            options,
            services=services,
        )
        told = plane.advertise(DIAGNOSTICS)
        plane.start()
        name = f"{namespace.rstrip('/')}/unitylink"
        try:
            while not stop.is_set() and not node.keeper.ended.is_set():
                told.send(diagnostics(plane, name, node.health(), plane.stamps.now_s()))
                stop.wait(DIAGNOSTICS_PERIOD_S)
        finally:
            node.close()
            plane.close()
        return 1 if node.keeper.failure is not None else 0


def _plane(over: str, interface: Interface, namespace: str, domain: int) -> DdsPlane | ZenohPlane:
    if over == ZENOH:
        # Humble has no hashes of types. Its nodes and newer ones do not meet.
        return ZenohPlane(interface, namespace, domain, hashes=os.environ.get("ROS_DISTRO") != "humble")
    return DdsPlane(interface, namespace, domain)


def _descriptor(parameter: Described) -> Any:
    """Return the rcl_interfaces/ParameterDescriptor. A node reads its parameters once, when it starts."""
    messages = import_module("rcl_interfaces.msg")
    made = messages.ParameterDescriptor(description=parameter.description, read_only=True)
    if parameter.most is not None:
        made.floating_point_range = [
            messages.FloatingPointRange(from_value=0.0, to_value=parameter.most, step=0.0)
        ]
    return made


def _run_rclpy(interface: Interface, build: Build, connect: Connect, arguments: Sequence[str]) -> int:
    rclpy = import_module("rclpy")
    # rclpy's own signal handler would end the context at once, while the link's thread still publishes.
    no_signals = import_module("rclpy.signals").SignalHandlerOptions.NO
    rclpy.init(args=[sys.argv[0], *arguments], signal_handler_options=no_signals)
    ros = rclpy.create_node("unitylink")
    parameters = Parameters()
    for one in Parameters.described():
        setattr(parameters, one.name, ros.declare_parameter(one.name, one.standard, _descriptor(one)).value)
    options = parameters.options()
    plane = RclpyPlane(ros, interface)
    node = RobotNode(interface, plane, lambda: connect(parameters.link, reconnect="auto"), build, options)
    told = plane.advertise(DIAGNOSTICS)
    executors = import_module("rclpy.executors")
    # one for topics, one for services, one for the node's own parameters
    executor = executors.MultiThreadedExecutor(num_threads=3)
    executor.add_node(ros)
    due_s = 0.0
    try:
        with stopped_by_signals() as stop:
            while not stop.is_set() and not node.keeper.ended.is_set():
                plane.life.beat("the thread of the diagnostics", DEVICE_S)
                if time.monotonic() >= due_s:
                    due_s = time.monotonic() + DIAGNOSTICS_PERIOD_S
                    name, now_s = ros.get_fully_qualified_name(), plane.stamps.now_s()
                    told.send(diagnostics(plane, name, node.health(), now_s))
                plane.life.beat("the executor")
                executor.spin_once(timeout_sec=0.1)
    finally:
        plane.life.rest()
        node.close()
        executor.shutdown(timeout_sec=1.0)
        ros.destroy_node()
        rclpy.try_shutdown()
    return 1 if node.keeper.failure is not None else 0
