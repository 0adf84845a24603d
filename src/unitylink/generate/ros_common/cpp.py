# SPDX-License-Identifier: BSD-3-Clause
"""The C++ of a robot's nodes: the table of its values, and the code that fills and reads each message."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from unitylink import protocol
from unitylink.interface.wire_hash import wire_hashes
from unitylink.ros.interface import JOINTS, ODOMETRY, RECORD, SCALAR, SENSOR, Topic
from unitylink.ros.sensors import SENSORS
from unitylink.spec.model import Element, Instance, LinkBinding, Spec
from unitylink.spec.types import Field as BitField
from unitylink.spec.types import ValueType
from unitylink.values import Codec, Quantity

from ..quoting import Cpp, Part
from .package import Package

_COMMITTED = ("tosnet", "double_buffer")


@dataclass(frozen=True)
class CppGroup:
    values: tuple[int, ...]
    divisor: int
    polled: bool


@dataclass(frozen=True)
class CppTopic:
    """A topic of the node: statements that fill or read `message`. `group` is the group of its publishes."""

    topic: Topic
    package: str
    message: str
    statements: tuple[Cpp, ...]
    group: int = -1
    stamped: bool = False


@dataclass(frozen=True)
class CppJoint:
    name: str
    values: tuple[int, int, int]  # index in the table for each, -1 for none
    factors: tuple[float, float, float]


@dataclass(frozen=True)
class CppRobot:
    spec: str
    gateware: tuple[str, ...]  # wire hashes
    values: tuple[Cpp, ...]  # initialisers
    groups: tuple[CppGroup, ...]
    units: tuple[Cpp, ...]
    data_bits: int
    published: tuple[CppTopic, ...]
    commanded: tuple[CppTopic, ...]
    joints: tuple[CppJoint, ...]  # of joint_commands
    left_out: tuple[str, ...]  # topics whose values are in several groups, and odometry
    asks_for_frames: str  # the first value that does, and why, or ""


def cpp_robot(package: Package) -> CppRobot:
    """Return all that the templates of the C++ nodes need."""
    return _Cpp(package.spec, package.root, package).robot()


class _Cpp:
    def __init__(self, spec: Spec, root: Instance, package: Package) -> None:
        self.spec, self.root, self.package = spec, root, package
        self.interface = package.interface
        self.elements = list(root.walk())
        self.index = {element.path: i for i, element in enumerate(self.elements)}
        self.units: list[LinkBinding] = []
        for element in self.elements:
            if element.link.kind in _COMMITTED and element.link not in self.units:
                self.units.append(element.link)
        devices = [device for device in spec.devices if device.root == root.name]
        self.data_bits = devices[0].link.data_bits if devices else 32
        self.groups = [
            CppGroup(tuple(self.index[e.path] for e in group.elements), group.divisor, False)
            for device in devices
            for group in device.groups
        ]
        polled: dict[int, list[int]] = {}
        for element in self.elements:
            if element.publish is not None and element.publish.mode == 2:
                polled.setdefault(element.publish.divisor, []).append(self.index[element.path])
        self.groups += [CppGroup(tuple(values), divisor, True) for divisor, values in polled.items()]

    def robot(self) -> CppRobot:
        published, left_out = [], []
        for topic in self.interface.published:
            indices = [self.index[path] for path in topic.paths]
            group = next((n for n, g in enumerate(self.groups) if set(indices) <= set(g.values)), None)
            if group is None or topic.form == ODOMETRY:
                left_out.append(topic.name)
            else:
                published.append(self._published(topic, group))
        joints = next((t for t in self.interface.commanded if t.form == JOINTS), None)
        return CppRobot(
            self.spec.source,
            tuple(f"0x{told:016X}U" for told in wire_hashes(self.spec, self.root.name)),
            tuple(self._value(element) for element in self.elements),
            tuple(self.groups),
            tuple(_unit(link) for link in self.units),
            self.data_bits,
            tuple(published),
            tuple(self._commanded(topic) for topic in self.interface.commanded),
            self._joints(joints) if joints is not None else (),
            tuple(left_out),
            next((text for element in self.elements if (text := _asks_for_frames(element))), ""),
        )

    def _value(self, element: Element) -> Cpp:
        unit = self.units.index(element.link) if element.link in self.units else -1
        where = (Cpp.text(element.path), f"0x{element.address:X}", element.words)
        return _initialiser(where, Quantity.of(element), element.access in ("WRITE", "READWRITE"), unit)

    # Out

    def _published(self, topic: Topic, group: int) -> CppTopic:
        package, _, message = topic.type.partition("/")
        at = {value: k for k, value in enumerate(self.groups[group].values)}
        raws = [at[self.index[path]] for path in topic.paths]
        lines: list[Cpp] = []
        if topic.form == SCALAR:
            lines.append(Cpp.of("message.data = {};", self._read(topic.paths[0], raws[0], topic.packed)))
        elif topic.form == RECORD:
            position = 0
            for field in self.interface.message(topic).fields:
                for k in range(max(1, field.count)):
                    target = Cpp.of("message.{}[{}]" if field.count else "message.{}", field.name, k)
                    path = topic.paths[position]
                    if field.members:
                        lines += self._unpack(target, path, raws[position])
                    else:
                        lines.append(Cpp.of("{} = {};", target, self._read(path, raws[position])))
                    position += 1
        elif topic.form == SENSOR:
            for name, by, path, raw in zip(topic.axes, topic.factors, topic.paths, raws, strict=True):
                value = Cpp.of("unitylink::number(values[{}], raws[{}])", self.index[path], raw)
                lines.append(Cpp.of("message.{} = {} * {};", name, value, by))
            for name, constant in SENSORS[message].constants.items():
                told = Cpp("unitylink::none") if math.isnan(constant) else constant
                lines.append(Cpp.of("message.{} = {};", name, told))
        else:
            for joint in topic.joints:
                lines.append(Cpp.of("message.name.push_back({});", Cpp.text(joint.name)))
            for part in ("position", "velocity", "effort"):
                if any(getattr(joint, part) >= 0 for joint in topic.joints):
                    for joint in topic.joints:
                        value = self._joint_part(topic, joint, part, raws)
                        lines.append(Cpp.of("message.{}.push_back({});", part, value))
        stamped = topic.form in (JOINTS, SENSOR) or (
            topic.form == RECORD and self.interface.message(topic).stamped
        )
        return CppTopic(topic, package, message, tuple(lines), group, stamped)

    def _joint_part(self, topic: Topic, joint: Any, part: str, raws: Sequence[int]) -> Cpp:
        at = getattr(joint, part)
        if at < 0:
            return Cpp("unitylink::none")
        value, by = self.index[topic.paths[at]], getattr(joint, f"{part}_factor")
        return Cpp.of("unitylink::number(values[{}], raws[{}]) * {}", value, raws[at], by)

    def _read(self, path: str, raw: int, packed: bool = False) -> Cpp:
        at = self.index[path]
        value, bits = Cpp.of("values[{}]", at), Cpp.of("raws[{}]", raw)
        return _expression(value, bits, Quantity.of(self.elements[at]), packed)

    def _unpack(self, target: Cpp, path: str, raw: int) -> Iterator[Cpp]:
        kind = self.elements[self.index[path]].type
        for name, one in zip(self._names(kind.name, path), kind.fields, strict=True):
            bits = Cpp.of("raws[{}] >> {}", raw, one.low)
            yield Cpp.of("{}.{} = {};", target, name, _expression(cpp_field(one), bits, Quantity.of(one)))

    def _names(self, name: str, path: str) -> list[str]:
        for topic in (*self.interface.published, *self.interface.commanded):
            if topic.form == RECORD and path in topic.paths:
                position = 0
                for field in self.interface.message(topic).fields:
                    if topic.paths.index(path) < position + max(1, field.count):
                        inner = next(m for m in self.interface.messages if m.name == field.type)
                        return [one.name for one in inner.fields]
                    position += max(1, field.count)
        raise KeyError(name)

    # In

    def _commanded(self, topic: Topic) -> CppTopic:
        package, _, message = topic.type.partition("/")
        lines: list[Cpp] = []
        if topic.form == SCALAR:
            lines.append(self._put(topic.paths[0], Cpp("message.data")))
        elif topic.form == RECORD:
            position = 0
            for field in self.interface.message(topic).fields:
                for k in range(max(1, field.count)):
                    source = Cpp.of("message.{}[{}]" if field.count else "message.{}", field.name, k)
                    path = topic.paths[position]
                    if field.members:
                        lines += self._pack(source, path)
                    else:
                        lines.append(self._put(path, source))
                    position += 1
        elif topic.form == JOINTS:
            lines.append(Cpp("command.joint_state(message);"))
        else:
            for axis, path in zip(topic.axes, topic.paths, strict=True):
                lines.append(self._put(path, Cpp.of("message.{}", axis.replace("_", "."))))
        return CppTopic(topic, package, message, tuple(lines))

    def _put(self, path: str, source: Cpp) -> Cpp:
        return Cpp.of("command.put({}, static_cast<double>({}));", self.index[path], source)

    def _pack(self, source: Cpp, path: str) -> Iterator[Cpp]:
        kind = self.elements[self.index[path]].type
        yield Cpp("{")
        yield Cpp("  std::uint64_t packed = 0;")
        for name, one in zip(self._names(kind.name, path), kind.fields, strict=True):
            mask, value = (
                (1 << one.high - one.low + 1) - 1,
                Cpp.of("static_cast<double>({}.{})", source, name),
            )
            yield Cpp.of("  command.pack({}, {}, {}U, {}, packed);", cpp_field(one), value, mask, one.low)
        yield Cpp.of("  {}", self._put(path, Cpp("packed")))
        yield Cpp("}")

    def _joints(self, topic: Topic) -> tuple[CppJoint, ...]:
        made = []
        for joint in topic.joints:
            parts = (joint.position, joint.velocity, joint.effort)
            indices = [self.index[topic.paths[at]] if at >= 0 else -1 for at in parts]
            factors = (joint.position_factor, joint.velocity_factor, joint.effort_factor)
            made.append(
                CppJoint(
                    joint.name,
                    (indices[0], indices[1], indices[2]),
                    (factors[0], factors[1], factors[2]),
                )
            )
        return tuple(made)


def _real(number: float | None) -> Part:
    return Cpp("unitylink::none") if number is None else float(number)


def _true(flag: bool) -> str:
    return "true" if flag else "false"


def _initialiser(where: tuple[Part, Part, int], quantity: Quantity, writable: bool, unit: int) -> Cpp:
    kind = quantity.type
    codec = Codec(str(where[0]), quantity, kind.width)
    scale = quantity.scale / (1 << kind.fraction)
    ratio = codec.ratio if quantity.scaled and codec.ratio is not None else (0, 0, 0)
    safe = float(quantity.safe) if quantity.safe is not None else None
    flags = (kind.signed, kind.kind == "float", writable, quantity.overflow == "saturate")
    numbers = (_real(number) for number in (scale, quantity.offset, *ratio, *_limits(codec), safe))
    inside = Cpp(", ").join((*where, kind.width, *map(_true, flags), unit, *numbers, _members(kind)))
    return Cpp.of("{{{}}}", inside)


def _members(kind: ValueType) -> Cpp:
    """Return a number with one bit for each number of a closed enumeration.

    Return 0 if this is impossible. Then the limits are checked instead.
    """
    numbers = {value.value for value in kind.enum.values} if kind.enum is not None else set()
    whole = kind.enum is None or kind.enum.open or any(not 0 <= number < 64 for number in numbers)
    return Cpp.of("0x{:X}U", 0 if whole else sum(1 << number for number in numbers))


def _limits(codec: Codec) -> tuple[float | None, float | None]:
    """Return the limits that are narrower than the type.

    For a float they are in its unit, else they are raw numbers.
    """
    quantity, kind = codec.quantity, codec.quantity.type
    if kind.kind == "float":
        return quantity.minimum, quantity.maximum
    if kind.enum is not None and not kind.enum.open:
        numbers = [value.value for value in kind.enum.values]
        return min(numbers), max(numbers)
    low, high = -codec.sign, codec.mask ^ codec.sign
    return (codec.low if codec.low > low else None), (codec.high if codec.high < high else None)


def cpp_field(one: BitField) -> Cpp:
    """Return a field of packed bits as a value of its own."""
    return Cpp.of("unitylink::Value{}", _initialiser((Cpp.text(one.name), 0, 1), Quantity.of(one), False, -1))


def _expression(value: Cpp, raw: Cpp, quantity: Quantity, packed: bool = False) -> Cpp:
    if quantity.type.kind == "bool":
        return Cpp.of("({} & 1U) != 0", raw)
    if (quantity.scaled or quantity.type.kind == "float") and not packed:
        return Cpp.of("unitylink::number({}, {})", value, raw)
    return Cpp.of("unitylink::whole({}, {})", value, raw)


def _asks_for_frames(element: Element) -> str:
    reason = Quantity.of(element).asks_for_frames(element.access)
    return f"{element.path} {reason}" if reason else ""


def _unit(link: LinkBinding) -> Cpp:
    if link.kind != "tosnet":
        return Cpp.of("{{0x{:X}, 0, 0, 0, 0}}", link.base + link.size)
    bits = (
        protocol.TOSNET_STATUS_COMMIT_PENDING_BIT,
        protocol.TOSNET_STATUS_COMMIT_ABORTED_BIT,
        protocol.TOSNET_STATUS_ONLINE_BIT,
        protocol.TOSNET_STATUS_SYSTEM_HALT_BIT,
    )
    masks = Cpp(", ").join(Cpp.of("1U << {}", bit) for bit in bits)
    return Cpp.of("{{0x{:X}, {}}}", link.base + protocol.TOSNET_STATUS, masks)
