# SPDX-License-Identifier: BSD-3-Clause
"""A robot as ROS sees it: its messages and topics. They are frozen, and the same for ROS 1, DDS and ROS 2.

`mapping.plan_interface` makes it from a spec. A generated package contains it as a literal.
"""

from __future__ import annotations

from dataclasses import dataclass

RECORD, SCALAR, JOINTS, TWIST = "record", "scalar", "joints", "twist"  # the forms of a topic
SENSOR, ODOMETRY = "sensor", "odometry"


@dataclass(frozen=True)
class Constant:
    """A named number of an enumeration. It stands in the message whose field may have it."""

    name: str
    type: str
    value: int


@dataclass(frozen=True)
class Field:
    """A field of a message.

    `count` 0 is one value. Otherwise it is an array with so many values. `type` is a ROS
    primitive. For a packed value it is the name of a message of the same package, and `members` are its
    attributes.
    """

    name: str
    type: str
    count: int = 0
    comment: str = ""
    members: tuple[str, ...] = ()


@dataclass(frozen=True)
class Message:
    """A message type of the package.

    Messages that are `stamped` begin with a header and a sequence number.
    """

    name: str
    fields: tuple[Field, ...]
    stamped: bool = False
    constants: tuple[Constant, ...] = ()
    documentation: str = ""


@dataclass(frozen=True)
class Joint:
    """A joint of a JointState.

    The numbers are the places of its parts in the topic's `paths`, or -1 if it lacks one. A value of the spec
    times its factor is in rad or m, rad/s or m/s, N·m or N.
    """

    name: str
    position: int = -1
    velocity: int = -1
    effort: int = -1
    position_factor: float = 1.0
    velocity_factor: float = 1.0
    effort_factor: float = 1.0


@dataclass(frozen=True)
class Topic:
    """A topic and the values of the spec that it carries, in the order of its message.

    `form` is "record" (a message of the package), "scalar" (std_msgs), "joints" (sensor_msgs/JointState) or
    "twist" (geometry_msgs/Twist). For "twist", `axes` says where each path goes. `queue` messages are kept
    for a slow reader. `reliable` is for ROS 2. `packed` means a scalar that is the raw number of packed bits.

    A "sensor" (sensor_msgs/Imu or BatteryState) has its fields in `axes`. `factors` makes the values those of
    ROS. "odometry" (nav_msgs/Odometry) has the wheels left and right, and `factors` to rad. Radius and track
    in m follow.
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
    factors: tuple[float, ...] = ()


@dataclass(frozen=True)
class Interface:
    """The whole robot: `published` goes from the gateware to ROS, `commanded` the other way."""

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
