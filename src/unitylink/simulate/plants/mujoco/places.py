# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of a model of MuJoCo that values of a spec may have."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco  # type: ignore[import-untyped]

_TURNS = {"position": "rad", "velocity": "rad/s", "effort": "N m"}
_SLIDES = {"position": "m", "velocity": "m/s", "effort": "N"}
UNITS_OF_JOINTS = {int(mujoco.mjtJoint.mjJNT_HINGE): _TURNS, int(mujoco.mjtJoint.mjJNT_SLIDE): _SLIDES}
# what a sensor measures, by the end of its name in MuJoCo; others may have any unit
_SENSED = {
    "m/s^2": ("ACCELEROMETER", "FRAMELINACC"),
    "rad/s": ("GYRO", "FRAMEANGVEL", "JOINTVEL"),
    "m/s": ("VELOCIMETER", "FRAMELINVEL"),
    "N": ("FORCE", "TOUCH"),
    "N m": ("TORQUE",),
    "m": ("RANGEFINDER", "FRAMEPOS"),
}
_SENSOR_UNITS = {
    int(getattr(mujoco.mjtSensor, f"mjSENS_{kind}")): unit
    for unit, kinds in _SENSED.items()
    for kind in kinds
}
_PARTS = {1: ("",), 2: (".x", ".y"), 3: (".x", ".y", ".z"), 4: (".w", ".x", ".y", ".z")}  # 4: a quaternion


@dataclass(frozen=True)
class Place:
    """A number of the model that a value may have: what it is called, its unit, and where it is."""

    name: str
    # "position", "velocity", "effort" ("push" or NO_EFFORT: efforts.py) or "sensor"; "actuator" or "limit"
    # for what is commanded
    what: str
    unit: str | None  # None: any
    index: int
    joint: str = ""  # whose number it is, "" for a sensor or an actuator of something else
    at_zero: bool = False  # does it say where a joint is, so that it has a zero?

    def __str__(self) -> str:
        what = {
            "limit": "speed limit of",
            "sensor": "sensor",
            "actuator": "actuator",
            "push": "effort of",
        }.get(self.what, f"{self.what} of")
        return f"{what} {self.name}" + (f" ({self.unit})" if self.unit else "")


def measured(model: Any) -> Iterator[Place]:
    """Yield what the joints and sensors measure."""
    for number in range(model.njnt):
        units = UNITS_OF_JOINTS.get(int(model.jnt_type[number]))
        if units is None:
            continue  # a free joint or a ball has no single position
        name, dof = model.joint(number).name, int(model.jnt_dofadr[number])
        yield Place(name, "position", units["position"], int(model.jnt_qposadr[number]), name, at_zero=True)
        yield Place(name, "velocity", units["velocity"], dof, name)
        yield Place(name, "effort", units["effort"], dof, name)
    for number in range(model.nsensor):
        name, first = model.sensor(number).name, int(model.sensor_adr[number])
        size, fits = int(model.sensor_dim[number]), _SENSOR_UNITS.get(int(model.sensor_type[number]))
        for index in range(size):
            named = (_PARTS[size][index],) if size in _PARTS else ()
            for part in dict.fromkeys((*named, f"[{index}]" if size > 1 else "")):
                yield Place(f"{name}{part}", "sensor", fits, first + index)


def commanded(model: Any) -> Iterator[Place]:
    """Yield the actuators, and how fast a position may move. Each is called as the actuator, or as its
    joint."""
    limits: list[Place] = []
    for number in range(model.nu):
        joint, units = "", None
        own = model.actuator(number).name
        if int(model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT):
            turned = int(model.actuator_trnid[number, 0])
            units, joint = UNITS_OF_JOINTS.get(int(model.jnt_type[turned])), model.joint(turned).name
        kind = kind_of(model, number)
        fits = units[kind] if units and kind else None
        for name in dict.fromkeys((own, joint or own)):
            yield Place(name, "actuator", fits, number, joint, at_zero=kind == "position")
            if units and kind == "position":
                limits.append(Place(name, "limit", units["velocity"], number, joint))
    yield from limits  # behind the others: a velocity belongs to a motor that wants one


def kind_of(model: Any, number: int) -> str | None:
    """Return what an actuator wants: "position", "velocity" or "effort". None: something else."""
    biases = mujoco.mjtBias
    bias = int(model.actuator_biastype[number])
    if bias == int(biases.mjBIAS_NONE):
        return "effort"
    if bias != int(biases.mjBIAS_AFFINE):
        return None
    if model.actuator_biasprm[number, 1] != 0:
        return "position"
    return "velocity" if model.actuator_biasprm[number, 2] != 0 else None
