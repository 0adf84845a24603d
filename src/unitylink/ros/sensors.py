# SPDX-License-Identifier: BSD-3-Clause
"""Which values of an instance are a message of a sensor: `@ros(type="Imu")`, `@ros(type="BatteryState")`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from unitylink.spec.model import Element, Instance

from .notes import Note

_NAN = math.nan


@dataclass(frozen=True)
class Sensor:
    """A message: which of its fields are measured, by unit, and what the others are.

    `parts` has, for each group of fields, the unit that a value must have and its factor to the unit of ROS.
    """

    topic: str
    type: str
    parts: tuple[tuple[tuple[str, ...], dict[str, float]], ...]
    constants: dict[str, float]


def _vector(name: str) -> tuple[str, ...]:
    return tuple(f"{name}.{axis}" for axis in "xyz")


SENSORS = {
    "Imu": Sensor(
        "imu",
        "sensor_msgs/Imu",
        (
            (_vector("angular_velocity"), {"rad/s": 1.0, "deg/s": math.pi / 180}),
            (_vector("linear_acceleration"), {"m/s^2": 1.0}),
        ),
        {"orientation_covariance[0]": -1.0},  # the message says so: there is no orientation
    ),
    "BatteryState": Sensor(
        "battery",
        "sensor_msgs/BatteryState",
        ((("voltage",), {"V": 1.0, "mV": 1e-3}),),
        {
            **dict.fromkeys(("temperature", "current", "charge", "capacity", "design_capacity"), _NAN),
            "percentage": _NAN,
            "present": 1,
        },
    ),
}


def sensor_fields(
    instance: Instance, note: Note, sensor: Sensor
) -> list[tuple[tuple[str, ...], Sequence[Element], float]]:
    """Return (fields of the message, their values, factor) for each part.

    Raises BindingError if there is no published value with a unit of the part, or if there are several.
    """
    found: list[tuple[tuple[str, ...], Sequence[Element], float]] = []
    for names, units in sensor.parts:
        fitting = [e for e in instance.elements if e.publish is not None and e.unit in units]
        if len(fitting) != len(names):
            raise note.wrong(
                f"{sensor.type.partition('/')[2]} needs {len(names)} published in {' or '.join(units)} for "
                f"{names[0].partition('.')[0]}, and there are {len(fitting)}; give the instance a `rate`"
            )
        found.append((names, fitting, units[fitting[0].unit]))
    return found
