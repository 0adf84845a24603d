# SPDX-License-Identifier: BSD-3-Clause
"""A robot as ROS sees it: its messages and topics, frozen, the same for ROS 1, DDS and ROS 2.

`mapping.plan_interface` makes it from a spec. A generated package has it as a literal.
"""

from __future__ import annotations

from dataclasses import dataclass

RECORD, SCALAR, JOINTS, TWIST = "record", "scalar", "joints", "twist"  # the forms of a topic


@dataclass(frozen=True)
class Constant:
    """A named number of an enumeration, in the message whose field may have it."""

    name: str
    type: str
    value: int


@dataclass(frozen=True)
class Field:
    """A field of a message. `count` 0 is one value, otherwise an array has that many. `type` is a ROS
    primitive, or the name of a message of the same package for a packed value, whose attributes are then
    `members`."""

    name: str
    type: str
    count: int = 0
    comment: str = ""
    members: tuple[str, ...] = ()


@dataclass(frozen=True)
class Message:
    """A message type of the package. `stamped` ones begin with a header and a sequence number."""

    name: str
    fields: tuple[Field, ...]
    stamped: bool = False
    constants: tuple[Constant, ...] = ()
    documentation: str = ""


@dataclass(frozen=True)
class Joint:
    """A joint of a JointState. The numbers say where in the topic's `paths` its parts are, -1: it has none; a
    value of the spec times its factor is in rad or m, rad/s or m/s, N·m or N."""

    name: str
    position: int = -1
    velocity: int = -1
    effort: int = -1
    position_factor: float = 1.0
    velocity_factor: float = 1.0
    effort_factor: float = 1.0


@dataclass(frozen=True)
class Topic:
    """A topic and the values of the spec which it carries, in the order of its message.

    `form` is "record" (a message of the package), "scalar" (std_msgs), "joints" (sensor_msgs/JointState) or
    "twist" (geometry_msgs/Twist; `axes` says where each path goes). `queue` messages are kept for a slow
    reader. `reliable` is for ROS 2. `packed`: a scalar that is the raw number of packed bits.
    """

    name: str
    type: str  # "scara_unitylink/JointFeedback"
    form: str
    paths: tuple[str, ...]
    frame: str = ""
    queue: int = 10
    reliable: bool = True
    joints: tuple[Joint, ...] = ()
    axes: tuple[str, ...] = ()
    packed: bool = False


@dataclass(frozen=True)
class Interface:
    """All of a robot: `published` goes from the gateware to ROS, `commanded` the other way."""

    package: str
    robot: str
    source: str
    messages: tuple[Message, ...]
    published: tuple[Topic, ...]
    commanded: tuple[Topic, ...]

    def message(self, topic: Topic) -> Message:
        """Return the message type of a topic of the form "record"."""
        name = topic.type.partition("/")[2]
        return next(message for message in self.messages if message.name == name)
