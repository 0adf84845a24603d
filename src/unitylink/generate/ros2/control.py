# SPDX-License-Identifier: BSD-3-Clause
"""The plug-in of ros2_control: the value of the table for each number of a joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from unitylink.ros.interface import JOINTS, Topic
from unitylink.ros.joints import PARTS

from ..quoting import Cpp
from ..ros_common.package import Package, rendered


@dataclass(frozen=True)
class ControlJoint:
    """A joint in the URDF, and which of position, velocity and effort it has."""

    name: str
    states: tuple[str, ...]
    commands: tuple[str, ...]


def control(package: Package, folder: str) -> dict[str, str]:
    """Return the files of the plug-in. A robot without joints has no plug-in."""
    published = [topic for topic in package.interface.published if topic.form == JOINTS]
    commanded = [topic for topic in package.interface.commanded if topic.form == JOINTS]
    if not published and not commanded:
        return {}
    index = {element.path: i for i, element in enumerate(package.root.walk())}
    states = [channel for topic in published for channel in _channels(topic, index)]
    commands = [channel for topic in commanded for channel in _channels(topic, index)]
    names = dict.fromkeys(joint.name for topic in (*published, *commanded) for joint in topic.joints)
    joints = [ControlJoint(name, _parts(name, published), _parts(name, commanded)) for name in names]
    rates = [e.publish.rate_hz for e in package.root.walk() if e.publish is not None and e.publish.rate_hz]
    controllers = [(part, [joint.name for joint in joints if part in joint.commands]) for part in PARTS]
    robot = package.interface.robot
    templates = {
        "src/ros2_control.cpp": "ros2_control.cpp.jinja",
        f"{package.name}.xml": "plugin.xml.jinja",
        f"urdf/{robot}.ros2_control.xacro": "ros2_control.xacro.jinja",
        "config/controllers.yaml": "controllers.yaml.jinja",
    }
    more: dict[str, Any] = {
        "states": states,
        "commands": commands,
        "control_joints": joints,
        "controllers": [(part, held) for part, held in controllers if held],
        "update_hz": round(max(rates)) if rates else 100,
    }
    return rendered(package, templates, "ros2", folder, **more)


def _channels(topic: Topic, index: dict[str, int]) -> list[Cpp]:
    return [
        Cpp.of(
            "{{{}, {}, {}, {}}}",
            Cpp.text(joint.name),
            Cpp.text(part),
            index[topic.paths[at]],
            getattr(joint, f"{part}_factor"),
        )
        for joint in topic.joints
        for part in PARTS
        if (at := getattr(joint, part)) >= 0
    ]


def _parts(name: str, topics: list[Topic]) -> tuple[str, ...]:
    found = [joint for topic in topics for joint in topic.joints if joint.name == name]
    return tuple(part for part in PARTS if any(getattr(joint, part) >= 0 for joint in found))
