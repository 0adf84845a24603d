# SPDX-License-Identifier: BSD-3-Clause
"""The plug-in of ros2_control: which interface each value of the spec is, and of which type."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from unitylink.ros.field_types import comment, primitive
from unitylink.ros.interface import JOINTS, SENSOR, Topic
from unitylink.ros.joints import PARTS
from unitylink.ros.names import field_name, joint_name
from unitylink.ros.notes import Note
from unitylink.spec.model import Element, Instance
from unitylink.spec.types import Field as BitField
from unitylink.values import Quantity

from ..quoting import Cpp
from ..ros_common.cpp import CppRobot, cpp_field, cpp_robot
from ..ros_common.package import Package, rendered

# The types of ros2_control's interfaces. A double has all numbers of the others, so it is for the rest.
_TYPES = ("float32", "bool", "uint8", "int8", "uint16", "int16", "uint32", "int32")
_EXACT_BITS = 53  # packed bits travel as one double
_COMMANDED = ("WRITE", "READWRITE")


@dataclass(frozen=True)
class Tag:
    """An interface in the URDF. `notes` tells unit, limits and the names of an enumeration."""

    name: str
    type: str = "double"
    notes: str = ""


@dataclass(frozen=True)
class Source:
    """The value of the spec behind an interface. `member` is a field of packed bits, -1 the whole value."""

    path: str
    factor: float = 1.0
    member: int = -1


@dataclass
class Part:
    """A `<joint>`, `<gpio>` or `<sensor>` in the URDF."""

    name: str
    states: list[Tag] = field(default_factory=list)
    commands: list[Tag] = field(default_factory=list)
    joint: bool = False

    @property
    def kind(self) -> str:
        return "joint" if self.joint else "gpio" if self.commands else "sensor"


def control(package: Package, folder: str) -> dict[str, str]:
    """Return the files of the plug-in. A robot that neither publishes nor takes values has none."""
    plan = _Plan(package)
    if not plan.states and not plan.commands:
        return {}
    robot = package.interface.robot
    templates = {
        "src/ros2_control.cpp": "ros2_control.cpp.jinja",
        "src/control_interfaces.hpp": "control_interfaces.hpp.jinja",
        f"{package.name}.xml": "plugin.xml.jinja",
        f"urdf/{robot}.ros2_control.xacro": "ros2_control.xacro.jinja",
        "config/controllers.yaml": "controllers.yaml.jinja",
        f"launch/{robot}_control.launch.py": "control.launch.py.jinja",
    }
    parts = list(plan.parts.values())
    joints = [part for part in parts if part.joint]
    controllers = [
        (kind, [joint.name for joint in joints if kind in (tag.name for tag in joint.commands)])
        for kind in PARTS
    ]
    rates = [e.publish.rate_hz for e in plan.elements if e.publish is not None and e.publish.rate_hz]
    more: dict[str, Any] = {
        "states": plan.states,
        "commands": plan.commands,
        "members": plan.members,
        "parts": parts,
        "joints": joints,
        "controllers": [(kind, held) for kind, held in controllers if held],
        "trajectory": [joint.name for joint in joints if _follows(joint)],
        "velocities": all("velocity" in (tag.name for tag in joint.states) for joint in joints),
        "gpios": [part for part in parts if part.kind == "gpio"],
        "update_hz": round(max(rates)) if rates else 100,
        "stale_s": max(1.0, 10 / min(rates)) if rates else 0.0,
        "pace_group": plan.fastest(),
    }
    return rendered(package, templates, "ros2", folder, **more)


def _follows(joint: Part) -> bool:
    return all("position" in (tag.name for tag in side) for side in (joint.states, joint.commands))


class _Plan:
    """The interfaces of a robot, in the order of the spec: first its joints, then sensors, then all else."""

    def __init__(self, package: Package) -> None:
        self.package = package
        self.elements = list(package.root.walk())
        self.index = {element.path: i for i, element in enumerate(self.elements)}
        self.robot: CppRobot = cpp_robot(package)
        self.states: list[Cpp] = []
        self.commands: list[Cpp] = []
        self.members: list[Cpp] = []
        self.parts: dict[str, Part] = {}
        self.taken: set[tuple[str, str]] = set()  # (side, path) of values that are a part of something above
        interface = package.interface
        for side, topics in (("states", interface.published), ("commands", interface.commanded)):
            for topic in topics:
                if topic.form == JOINTS:
                    self._joints(side, topic)
        for topic in interface.published:
            if topic.form == SENSOR:
                self._sensor(topic)
        self._instance(package.root)

    def fastest(self) -> int:
        """Return the group that comes most often, -1 if none comes by itself at a rate."""
        due = [(group.divisor, n) for n, group in enumerate(self.robot.groups) if group.divisor > 0]
        return min(due)[1] if due else -1

    def _add(self, side: str, part: Part, tag: Tag, source: Source) -> None:
        tags = part.states if side == "states" else part.commands
        tags.append(tag)
        self.taken.add((side, source.path))
        value = self.index[source.path]
        group = next((n for n, g in enumerate(self.robot.groups) if value in g.values), 0)
        (self.states if side == "states" else self.commands).append(
            Cpp.of(
                "{{{}, {}, {}, {}, {}, {}, {}, {}}}",
                *(Cpp.text(text) for text in (part.name, tag.name, tag.type)),
                value,
                source.factor,
                source.member,
                group,
                "true" if self.elements[value].readable else "false",
            )
        )

    def _joints(self, side: str, topic: Topic) -> None:
        for joint in topic.joints:
            part = self.parts.setdefault(joint.name, Part(joint.name, joint=True))
            for name in PARTS:
                at = getattr(joint, name)
                if at >= 0:
                    source = Source(topic.paths[at], getattr(joint, f"{name}_factor"))
                    self._add(side, part, Tag(name), source)

    def _sensor(self, topic: Topic) -> None:
        above = topic.name.rpartition("/")[0]
        part = self._part(joint_name(above.replace("/", ".")) if above else self.package.interface.robot)
        for name, path, by in zip(topic.axes, topic.paths, topic.factors, strict=True):
            self._add("states", part, Tag(name), Source(path, by))

    def _part(self, name: str) -> Part:
        """Return a new part. Joints, sensors and all else have names of their own."""
        free, number = name, 1
        while free in self.parts:
            number += 1
            free = f"{name}_io" if number == 2 else f"{name}_io{number - 1}"
        return self.parts.setdefault(free, Part(free))

    def _instance(self, instance: Instance) -> None:
        sides = [
            (side, element)
            for element in instance.elements
            for side in ("states", "commands")
            if _belongs(side, element) and (side, element.path) not in self.taken
        ]
        if sides:
            part = self._part(self._name(instance))
            for side, element in sides:
                self._value(side, part, element)
            if not part.states and not part.commands:
                del self.parts[part.name]
        for below in instance.instances:
            self._instance(below)

    def _name(self, instance: Instance) -> str:
        if not instance.path:
            return self.package.interface.robot
        above, _, own = instance.path.rpartition(".")
        named = Note(instance).text("name", own)
        return joint_name(f"{above}.{named}" if above else named)

    def _value(self, side: str, part: Part, element: Element) -> None:
        name = field_name(Note(element).text("name") or element.name)
        if element.type.kind != "bits":
            self._add(side, part, _tag(name, element), Source(element.path))
        elif element.type.width <= _EXACT_BITS:
            for one in element.type.fields:
                self.members.append(Cpp.of("{{{}, {}, {}}}", cpp_field(one), one.low, one.high - one.low + 1))
                tag = _tag(f"{name}.{field_name(one.name)}", one)
                self._add(side, part, tag, Source(element.path, member=len(self.members) - 1))


def _belongs(side: str, element: Element) -> bool:
    if side == "states":
        return element.publish is not None and element.readable
    return element.access in _COMMANDED


def _tag(name: str, item: Element | BitField) -> Tag:
    natural = primitive(Quantity.of(item))
    return Tag(name, natural if natural in _TYPES else "double", "; ".join(_notes(item)))


def _notes(item: Element | BitField) -> Iterator[str]:
    if item.type.enum is not None:
        yield ", ".join(f"{value.value} {value.name}" for value in item.type.enum.values)
    if said := comment(item):
        yield said
