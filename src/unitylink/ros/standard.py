# SPDX-License-Identifier: BSD-3-Clause
"""The messages of ROS 2 that a node uses, as their packages define them. They serve a DDS without ROS."""

from __future__ import annotations

from .field_types import SCALARS
from .interface import Interface

# type -> fields: (name, primitive, "string" or another type). After it, "[]" means a sequence, and "[3]" an
# array.
Fields = tuple[tuple[str, str], ...]
# What ROS 2 puts into a message without fields.
NOTHING: Fields = (("structure_needs_at_least_one_member", "uint8"),)
STANDARD: dict[str, Fields] = {
    **{f"std_msgs/{name}": (("data", primitive),) for primitive, name in SCALARS.items()},
    "builtin_interfaces/Time": (("sec", "int32"), ("nanosec", "uint32")),
    "rosgraph_msgs/Clock": (("clock", "builtin_interfaces/Time"),),
    "std_msgs/Header": (("stamp", "builtin_interfaces/Time"), ("frame_id", "string")),
    "sensor_msgs/JointState": (
        ("header", "std_msgs/Header"),
        ("name", "string[]"),
        ("position", "float64[]"),
        ("velocity", "float64[]"),
        ("effort", "float64[]"),
    ),
    "geometry_msgs/Vector3": (("x", "float64"), ("y", "float64"), ("z", "float64")),
    "geometry_msgs/Twist": (("linear", "geometry_msgs/Vector3"), ("angular", "geometry_msgs/Vector3")),
    "geometry_msgs/Point": (("x", "float64"), ("y", "float64"), ("z", "float64")),
    "geometry_msgs/Quaternion": (("x", "float64"), ("y", "float64"), ("z", "float64"), ("w", "float64")),
    "geometry_msgs/Pose": (("position", "geometry_msgs/Point"), ("orientation", "geometry_msgs/Quaternion")),
    "geometry_msgs/PoseWithCovariance": (("pose", "geometry_msgs/Pose"), ("covariance", "float64[36]")),
    "geometry_msgs/TwistWithCovariance": (("twist", "geometry_msgs/Twist"), ("covariance", "float64[36]")),
    "nav_msgs/Odometry": (
        ("header", "std_msgs/Header"),
        ("child_frame_id", "string"),
        ("pose", "geometry_msgs/PoseWithCovariance"),
        ("twist", "geometry_msgs/TwistWithCovariance"),
    ),
    "sensor_msgs/Imu": (
        ("header", "std_msgs/Header"),
        ("orientation", "geometry_msgs/Quaternion"),
        ("orientation_covariance", "float64[9]"),
        ("angular_velocity", "geometry_msgs/Vector3"),
        ("angular_velocity_covariance", "float64[9]"),
        ("linear_acceleration", "geometry_msgs/Vector3"),
        ("linear_acceleration_covariance", "float64[9]"),
    ),
    "sensor_msgs/BatteryState": (
        ("header", "std_msgs/Header"),
        *(
            (name, "float32")
            for name in ("voltage", "temperature", "current", "charge", "capacity", "design_capacity")
        ),
        ("percentage", "float32"),
        ("power_supply_status", "uint8"),
        ("power_supply_health", "uint8"),
        ("power_supply_technology", "uint8"),
        ("present", "bool"),
        ("cell_voltage", "float32[]"),
        ("cell_temperature", "float32[]"),
        ("location", "string"),
        ("serial_number", "string"),
    ),
    "diagnostic_msgs/KeyValue": (("key", "string"), ("value", "string")),
    "diagnostic_msgs/DiagnosticStatus": (
        ("level", "uint8"),
        ("name", "string"),
        ("message", "string"),
        ("hardware_id", "string"),
        ("values", "diagnostic_msgs/KeyValue[]"),
    ),
    "diagnostic_msgs/DiagnosticArray": (
        ("header", "std_msgs/Header"),
        ("status", "diagnostic_msgs/DiagnosticStatus[]"),
    ),
}


def definitions(interface: Interface) -> dict[str, Fields]:
    """Return the standard types and those of a robot's package."""
    own: dict[str, Fields] = {}
    for message in interface.messages:
        head = (("header", "std_msgs/Header"), ("sequence", "uint32")) if message.stamped else ()
        fields = tuple(
            (
                field.name,
                (f"{interface.package}/{field.type}" if field.members else field.type)
                + (f"[{field.count}]" if field.count else ""),
            )
            for field in message.fields
        )
        own[f"{interface.package}/{message.name}"] = (*head, *fields)
    return STANDARD | own
