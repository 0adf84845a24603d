# SPDX-License-Identifier: BSD-3-Clause
"""Imu, BatteryState and Odometry: which values they take, what they say, and what is refused."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pytest
from unit.ros.plane import MemoryPlane

from unitylink.errors import BindingError
from unitylink.generate import generate
from unitylink.ros.dds_types import DdsTypes
from unitylink.ros.interface import Interface
from unitylink.ros.mapping import plan_interface
from unitylink.ros.odometry import GAP_S, Odometry
from unitylink.ros.senders import sender
from unitylink.ros.standard import STANDARD, definitions
from unitylink.spec import Spec, compile_text

CART = """
link cart (ADDRESS=8);
@ros(type="Odometry", left="left.position", right="right.position", radius_m=0.05, track_m=0.3)
public cart() {
   @ros(type="JointState")
   left: quadrature_encoder(scale=2*pi/2048 rad, rate=50 Hz);
   right: quadrature_encoder(scale=360/2048 deg, rate=50 Hz);
   @ros(type="Imu", frame="imu_link")
   imu: icm42688(period=10 ms, rate=50 Hz);
   @ros(type="BatteryState")
   battery: spi_device(bytes=2, period=100 ms, rate=10 Hz, scale=1 mV);
}
"""


def compiled(text: str = CART) -> Spec:
    spec = compile_text(text, "cart.ul").spec
    assert spec is not None
    return spec


class TypedPlane(MemoryPlane):
    """Its messages are those of ROS 2, so a wrong field or type fails."""

    def __init__(self, interface: Interface) -> None:
        super().__init__()
        self._types = DdsTypes(definitions(interface))

    def maker(self, type_name: str, fields: Sequence[str]) -> Any:
        return self._types[type_name]

    def header(self, time_s: float, frame: str) -> Any:
        return self._types["std_msgs/Header"](self._types["builtin_interfaces/Time"](int(time_s), 0), frame)


def said(name: str, *samples: tuple[float, Sequence[float]]) -> Any:
    """Return the last message of a topic."""
    interface = plan_interface(compiled())
    (topic,) = [one for one in interface.published if one.name == name]
    plane = TypedPlane(interface)
    send = sender(interface, topic, plane)
    for time_s, numbers in samples:
        send(time_s, numbers)
    message = plane.sent[name][-1]
    assert type(message).deserialize(message.serialize()) is not None  # it can go over the wire
    return message


def test_an_imu_is_in_the_units_of_ros() -> None:
    message = said("imu/imu", (7.0, (180.0, 0.0, -90.0, 0.0, 1.0, 9.8)))
    turn, pull = message.angular_velocity, message.linear_acceleration
    assert (turn.x, turn.y, turn.z) == pytest.approx((math.pi, 0.0, -math.pi / 2))
    assert (pull.x, pull.y, pull.z) == pytest.approx((0.0, 1.0, 9.8))
    assert message.header.frame_id == "imu_link" and message.header.stamp.sec == 7
    assert list(message.orientation_covariance) == [-1.0] + [0.0] * 8  # there is no orientation


def test_a_battery_says_what_is_not_measured() -> None:
    message = said("battery/battery", (0.0, (12_345.0,)))
    assert message.voltage == pytest.approx(12.345) and message.present is True
    unknown = ("current", "charge", "capacity", "design_capacity", "percentage", "temperature")
    assert all(math.isnan(getattr(message, name)) for name in unknown)
    assert len(message.cell_voltage) == 0 and message.location == ""


def test_odometry_follows_a_quarter_of_a_circle() -> None:
    """The wheels of a track of 0.3 m go round a centre that is 0.5 m to the left. The right one is in deg."""
    steps = 7
    left = [0.35 * math.pi / 2 * k / steps / 0.05 for k in range(steps + 1)]
    right = [math.degrees(0.65 * math.pi / 2 * k / steps / 0.05) for k in range(steps + 1)]
    message = said("odom", *((0.1 * k, (left[k], right[k])) for k in range(steps + 1)))
    pose, twist = message.pose.pose, message.twist.twist
    assert (pose.position.x, pose.position.y) == pytest.approx((0.5, 0.5))
    assert (pose.orientation.z, pose.orientation.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert twist.linear.x == pytest.approx(0.5 * math.pi / 2 / 0.7)
    assert twist.angular.z == pytest.approx(math.pi / 2 / 0.7)
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "base_link")


def test_odometry_does_not_jump_when_the_device_was_away() -> None:
    place = Odometry(0.05, 0.3)
    for time_s, angle in ((0.0, 0.0), (0.1, 2.0), (0.2 + GAP_S, 500.0), (0.3 + GAP_S, 502.0)):
        place.turned(time_s, angle, angle)
    assert place.x_m == pytest.approx(0.05 * 4) and place.speed == pytest.approx(1.0)


def test_a_preset_of_a_joint_is_no_command() -> None:
    interface = plan_interface(compiled())
    assert [topic.name for topic in interface.commanded if topic.type == "sensor_msgs/JointState"] == []
    (states,) = [topic for topic in interface.published if topic.name == "joint_states"]
    assert states.paths == ("left.position",)


def test_the_packages_depend_on_what_they_send() -> None:
    for artefact in ("ros1", "ros2"):
        files = generate(compiled(), artefact)
        package = next(text for name, text in files.items() if name.endswith("package.xml"))
        assert "nav_msgs" in package
        node = next(text for name, text in files.items() if name.endswith("node.cpp"))
        assert "message.angular_velocity.x = " in node and "message.voltage = " in node
        assert "topic odom is in the Python node only" in node
        plain = generate(
            compiled("link l(ADDRESS=8); public a() { one: gpio(pins=2, rate=10 Hz); }"), artefact
        )
        assert not any("nav_msgs" in text for text in plain.values())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"left.position"', '"left.stamp"', "left='left.stamp' is no published angle of a wheel; there are:"),
        ("radius_m=0.05", "radius_m=0", "needs radius_m=.. of the wheels and track_m=.. between them"),
        ("radius_m=0.05", 'radius_m="5"', "radius_m='5' is not of type float"),
        (
            "period=10 ms, rate=50 Hz",
            "period=10 ms",
            "Imu needs 3 published in rad/s or deg/s for angular_vel",
        ),
        ("scale=1 mV", "scale=1 count", "BatteryState needs 1 published in V or mV for voltage"),
        (
            'type="Imu"',
            'type="Gyro"',
            "type 'Gyro' is none of JointState, Twist, Imu, BatteryState, Odometry",
        ),
    ],
)
def test_a_mistake_names_the_remedy(old: str, new: str, message: str) -> None:
    with pytest.raises(BindingError, match=message):
        plan_interface(compiled(CART.replace(old, new, 1)))


def test_the_types_are_closed() -> None:
    """Each type that a standard message contains is there too."""
    for fields in STANDARD.values():
        kinds = {kind.partition("[")[0] for _, kind in fields}
        assert not {kind for kind in kinds if "/" in kind} - STANDARD.keys()
