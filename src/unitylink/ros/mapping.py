# SPDX-License-Identifier: BSD-3-Clause
"""From a spec to the topics and messages of its robot, by the rule of docs/ros.md.

>>> from unitylink.spec import compile_text
>>> text = "public lamp() { @led = 0x0: WRITE(); @dark = 0x1: READ(PUBLISH(1,10)); }"
>>> spec = compile_text(text, "lamp.ul").spec
>>> interface = plan_interface(spec)
>>> [f"{topic.name}: {topic.type}" for topic in (*interface.published, *interface.commanded)]
['feedback: lamp_unitylink/LampFeedback', 'command: lamp_unitylink/LampCommand', 'led: std_msgs/UInt32']
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from unitylink.errors import BindingError
from unitylink.spec.model import Element, Instance, Publish, Spec
from unitylink.spec.types import EnumType, ValueType
from unitylink.values import Quantity, field_names

from .field_types import SCALARS, comment, primitive
from .interface import (
    JOINTS,
    ODOMETRY,
    RECORD,
    SCALAR,
    SENSOR,
    TWIST,
    Constant,
    Field,
    Interface,
    Joint,
    Message,
    Topic,
)
from .joints import PARTS, JointValues, factor, is_angle, joints_of
from .names import RESERVED_MESSAGES, constant_name, field_name, message_name, package_name, topic_name
from .notes import TWIST_AXES, Note
from .sensors import SENSORS, sensor_fields

JOINT_STATES, JOINT_COMMANDS = "joint_states", "joint_commands"
COMMANDED = ("WRITE", "READWRITE")


def plan_interface(spec: Spec, root: str | None = None, *, standard: bool = False) -> Interface:
    """Return the interface of a public constructor, by default the only one.

    With `standard` it has only messages that every ROS has, for tools without the generated package.

    Raises BindingError if two names of the spec become the same in ROS, if an `@ros(..)` is wrong, or if the
    constructor needs more than one link.
    """
    try:
        instance = spec.root(root)
    except KeyError as error:
        raise BindingError(f"{spec.source}: {error.args[0]}") from None
    links = [device.comm or device.link.name for device in spec.devices if device.root == instance.name]
    if len(links) > 1:
        raise BindingError(
            f"{spec.source}: `{instance.name}` needs {len(links)} links ({', '.join(links)}), but a node "
            "has one; write a public constructor for the part behind each link: each becomes a node"
        )
    return _Planner(spec, instance, standard).interface()


class _Planner:
    def __init__(self, spec: Spec, root: Instance, standard: bool) -> None:
        self.spec, self.root, self.standard = spec, root, standard
        self.package = package_name(root.name)
        # by name in lower case, because names of C++ headers are in lower case
        self.messages: dict[str, Message] = {}
        self.published: list[Topic] = []
        self.commanded: list[Topic] = []
        self.measured: dict[Publish, list[JointValues]] = {}
        self.set: list[JointValues] = []
        self.frame = ""

    def interface(self) -> Interface:
        self._instance(self.root)
        self._joint_topics()
        self._check_names()
        messages = tuple(self.messages.values())
        return Interface(
            self.package,
            field_name(self.root.name).removesuffix("_value"),
            self.spec.source,
            messages,
            tuple(self.published),
            tuple(self.commanded),
        )

    # One instance

    def _instance(self, instance: Instance) -> None:
        note = Note(instance)
        prefix = _prefix(instance, note)
        if not self.standard:
            self._feedback(instance, note, prefix)
            self._command(instance, note, prefix)
        for element in instance.elements:
            self._scalar(element, prefix)
        if note.text("type") == "Twist":
            self._twist(instance, note, prefix)
        elif any(note.text(axis) for axis in TWIST_AXES):
            raise note.wrong('linear_x, .. angular_z are for type="Twist"')
        if note.text("type") in SENSORS:
            self._sensor(instance, note, prefix)
        if note.text("type") == "Odometry":
            self._odometry(instance, note, prefix)
        for joint in joints_of(instance, note):
            self._joint(joint, note)
        for part in instance.instances:
            self._instance(part)

    def _feedback(self, instance: Instance, note: Note, prefix: str) -> None:
        sets: dict[Publish, list[Element]] = {}
        for element in instance.elements:
            if element.publish is not None and element.readable:
                sets.setdefault(element.publish, []).append(element)
        for publish, elements in sets.items():
            suffix = _label(publish) if len(sets) > 1 else ""
            message = self._message(instance, f"Feedback{suffix.title().replace('_', '')}", elements)
            name = f"{prefix}feedback{'_' + suffix if suffix else ''}"
            self.published.append(self._record(name, message, elements, note))

    def _command(self, instance: Instance, note: Note, prefix: str) -> None:
        elements = [e for e in instance.elements if e.access in COMMANDED]
        if elements:
            message = self._message(instance, "Command", elements, stamped=False)
            self.commanded.append(self._record(f"{prefix}command", message, elements, note))

    def _record(self, name: str, message: Message, elements: Sequence[Element], note: Note) -> Topic:
        return Topic(
            name,
            f"{self.package}/{message.name}",
            RECORD,
            tuple(element.path for element in elements),
            note.text("frame"),
            note.number("queue", 10),
            note.flag("reliable", True),
        )

    def _scalar(self, element: Element, prefix: str) -> None:
        note = Note(element)
        natural = SCALARS[primitive(Quantity.of(element))]
        wanted = note.text("type")
        if wanted and wanted != natural:
            raise note.wrong(f"type {wanted!r}: its values are {natural}")
        name = prefix + topic_name(note.text("name", element.name))
        topic = Topic(name, f"std_msgs/{natural}", SCALAR, (element.path,), queue=note.number("queue", 10))
        topic = replace(topic, reliable=note.flag("reliable", True), packed=element.type.kind == "bits")
        if element.publish is not None and element.readable and (self.standard or wanted):
            self.published.append(topic)
        if element.access in COMMANDED:
            both = element.publish is not None and element.readable and (self.standard or wanted)
            self.commanded.append(replace(topic, name=f"{name}/set") if both else topic)

    def _twist(self, instance: Instance, note: Note, prefix: str) -> None:
        names = {element.name: element for element in instance.elements if element.access in COMMANDED}
        axes = [axis for axis in TWIST_AXES if note.text(axis)]
        for axis in axes:
            if note.text(axis) not in names:
                known = ", ".join(names) or "none"
                raise note.wrong(f"{axis}={note.text(axis)!r} is not a WRITE; there are: {known}")
        if not axes:
            raise note.wrong('type "Twist" needs its targets: linear_x="..", angular_z=".."')
        paths = tuple(names[note.text(axis)].path for axis in axes)
        topic = Topic(f"{prefix}cmd_vel", "geometry_msgs/Twist", TWIST, paths, axes=tuple(axes))
        self.commanded.append(topic)

    def _sensor(self, instance: Instance, note: Note, prefix: str) -> None:
        sensor = SENSORS[note.text("type")]
        paths: list[str] = []
        fields: list[str] = []
        factors: list[float] = []
        for names, elements, by in sensor_fields(instance, note, sensor):
            fields += names
            paths += [element.path for element in elements]
            factors += [by] * len(names)
        topic = Topic(f"{prefix}{sensor.topic}", sensor.type, SENSOR, tuple(paths), note.text("frame"))
        self.published.append(replace(topic, axes=tuple(fields), factors=tuple(factors)))

    def _odometry(self, instance: Instance, note: Note, prefix: str) -> None:
        elements = {element.path: element for element in instance.walk()}
        wheels = []
        for side in ("left", "right"):
            path = f"{instance.path}.{note.text(side)}" if instance.path else note.text(side)
            wheel = elements.get(path)
            if wheel is None or wheel.publish is None or not is_angle(wheel):
                known = [p for p, e in elements.items() if e.publish is not None and is_angle(e)]
                what = f"{side}={note.text(side)!r} is no published angle of a wheel"
                raise note.wrong(f"{what}; there are: {', '.join(known) or 'none'}")
            wheels.append(wheel)
        sizes = note.real("radius_m"), note.real("track_m")
        if min(sizes) <= 0:
            raise note.wrong("Odometry needs radius_m=.. of the wheels and track_m=.. between them, above 0")
        paths = tuple(wheel.path for wheel in wheels)
        factors = (*map(factor, wheels), *sizes)
        topic = Topic(f"{prefix}odom", "nav_msgs/Odometry", ODOMETRY, paths, note.text("frame", "odom"))
        self.published.append(replace(topic, factors=factors))

    # Messages

    def _message(
        self, instance: Instance, suffix: str, elements: Sequence[Element], stamped: bool = True
    ) -> Message:
        fields: list[Field] = []
        constants: dict[str, Constant] = {}
        owner: dict[str, Element] = {}
        arrays: dict[str, int] = {}
        for element in elements:
            if element.array and element.array in arrays:
                at = arrays[element.array]
                fields[at] = replace(fields[at], count=fields[at].count + 1)
                continue
            name = field_name(Note(element).text("name") or element.array or element.name)
            if name in owner:
                raise BindingError(
                    f"{self.spec.source}: `{owner[name].path}` and `{element.path}` both become the field "
                    f'{name!r} in ROS; rename one, or give it @ros(name="..")'
                )
            owner[name] = element
            if element.array:
                arrays[element.array] = len(fields)
            kind, members = self._field_type(element.type, Quantity.of(element))
            fields.append(Field(name, kind, 1 if element.array else 0, comment(element), members))
            if element.type.enum is not None:
                self._constants(constants, name, element.type.enum, kind)
        said = " ".join(instance.documentation.split())
        message = Message(
            message_name(instance.constructor) + suffix,
            tuple(fields),
            stamped,
            tuple(constants.values()),
            said,
        )
        return self._claim(message)

    @staticmethod
    def _constants(into: dict[str, Constant], name: str, enum: EnumType, kind: str) -> None:
        for value in enum.values:
            constant = Constant(constant_name(name, value.name), kind, value.value)
            if constant.name in into:
                raise BindingError(
                    f"`{enum.name}` has two values that are {constant.name} in ROS; rename one of them"
                )
            into[constant.name] = constant

    def _field_type(self, kind: ValueType, quantity: Quantity) -> tuple[str, tuple[str, ...]]:
        if kind.kind != "bits":
            return primitive(quantity), ()
        fields, constants = [], dict[str, Constant]()
        seen: set[str] = set()
        for one in kind.fields:
            name = field_name(one.name)
            if name in seen:
                raise BindingError(f"`{kind.name}` has two fields that are {name!r} in ROS; rename one")
            seen.add(name)
            own = primitive(Quantity.of(one))
            fields.append(Field(name, own, comment=comment(one)))
            if one.type.enum is not None:
                self._constants(constants, name, one.type.enum, own)
        message = self._claim(
            Message(
                message_name(kind.name or "Bits"),
                tuple(fields),
                constants=tuple(constants.values()),
                documentation=" ".join(kind.documentation.split()),
            )
        )
        return message.name, tuple(field_names(kind).values())

    def _claim(self, message: Message) -> Message:
        """Give a message its name.

        An equal message has the same one, a new one gets a free name (`JointFeedback2`).
        """
        name, number = message.name, 1
        name = f"{name}Bits" if name in RESERVED_MESSAGES else name
        while True:
            taken = self.messages.get(name.lower())
            message = replace(message, name=name)
            if taken is None or _plain(taken) == _plain(message):
                return self.messages.setdefault(name.lower(), message)
            number += 1
            name = f"{message.name.rstrip('0123456789')}{number}"

    # Joints of the whole robot

    def _joint(self, joint: JointValues, note: Note) -> None:
        self.frame = self.frame or note.text("frame")
        if joint.set:
            self.set.append(joint)
        lead = next((joint.measured[part] for part in PARTS if part in joint.measured), None)
        if lead is not None and lead.publish is not None:
            together = {part: e for part, e in joint.measured.items() if e.publish == lead.publish}
            self.measured.setdefault(lead.publish, []).append(replace(joint, measured=together))

    def _joint_topics(self) -> None:
        for joints in self.measured.values():
            self.published.append(self._joint_topic(JOINT_STATES, [(j.name, j.measured) for j in joints]))
        if self.set:
            self.commanded.append(self._joint_topic(JOINT_COMMANDS, [(j.name, j.set) for j in self.set]))

    def _joint_topic(self, name: str, joints: Sequence[tuple[str, dict[str, Element]]]) -> Topic:
        paths: list[str] = []
        made = []
        for joint, parts in joints:
            where, factors = dict.fromkeys(PARTS, -1), dict.fromkeys(PARTS, 1.0)
            for part, element in parts.items():
                where[part], factors[part] = len(paths), factor(element)
                paths.append(element.path)
            made.append(Joint(joint, *(where[p] for p in PARTS), *(factors[p] for p in PARTS)))
        names = [joint.name for joint in made]
        for one in names:
            if names.count(one) > 1:
                raise BindingError(
                    f'{self.spec.source}: two joints are called {one!r} in ROS; give one @ros(joint="..")'
                )
        return Topic(name, "sensor_msgs/JointState", JOINTS, tuple(paths), self.frame, joints=tuple(made))

    def _check_names(self) -> None:
        seen: dict[str, Topic] = {}
        for topic in (*self.published, *self.commanded):
            other = seen.setdefault(topic.name, topic)
            parts = topic.name == JOINT_STATES and other.form == topic.form == JOINTS
            if other is not topic and not parts:
                raise BindingError(
                    f"{self.spec.source}: `{', '.join(other.paths)}` and `{', '.join(topic.paths)}` are both "
                    f'the topic {topic.name!r} in ROS; rename one, or give it @ros(name="..")'
                )


def _plain(message: Message) -> Message:
    """Remove display names, so that two expansions of one constructor have the same message."""
    return replace(
        message, fields=tuple(replace(field, comment="") for field in message.fields), documentation=""
    )


def _prefix(instance: Instance, note: Note) -> str:
    if not instance.path:
        return ""
    above, _, own = instance.path.rpartition(".")
    named = note.text("name", own)
    return f"{topic_name(f'{above}.{named}' if above else named)}/"


def _label(publish: Publish) -> str:
    """Name one of several publishes of an instance by its group, its event, or its rate."""
    if publish.group:
        return field_name(publish.group)
    if publish.trigger != "rate":
        return field_name(publish.event or "change")
    rate = f"{publish.rate_hz:g}".replace(".", "_") + "hz" if publish.rate_hz else f"div{publish.divisor}"
    return rate if publish.mode == 1 else f"polled_{rate}"
