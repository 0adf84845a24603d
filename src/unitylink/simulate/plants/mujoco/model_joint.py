# SPDX-License-Identifier: BSD-3-Clause
"""A joint of a model of MuJoCo, as the components at it need it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco  # type: ignore[import-untyped]

from .places import UNITS_OF_JOINTS, kind_of

_NAMED = {"position": "a position", "velocity": "a velocity", "effort": "a motor", None: "another"}


@dataclass(frozen=True)
class ModelJoint:
    """A hinge or a slide, and where its numbers are. `actuators` are those at it: (number, what it wants)."""

    name: str
    unit: str  # of its position: rad or m
    number: int
    position: int
    dof: int
    actuators: tuple[tuple[int, str | None], ...]

    def add(self, model: Any, inertia: float, friction: float, damping: float) -> None:
        """Give it what turns with it. What the model itself says counts more."""
        for row, more in (
            (model.dof_armature, inertia),
            (model.dof_frictionloss, friction),
            (model.dof_damping, damping),
        ):
            if row[self.dof] == 0:
                row[self.dof] = more

    def actuator_of(self, kind: str) -> int | None:
        """Return the actuator that wants a position, a velocity or an effort, if there is one."""
        return next((number for number, wanted in self.actuators if wanted == kind), None)

    def other_actuators(self, model: Any) -> str:
        """Return what actuators are there, as text."""
        told = [
            f"{_NAMED[wanted]} actuator {model.actuator(number).name!r}" for number, wanted in self.actuators
        ]
        return " and ".join(told).replace("motor actuator", "motor") or "no actuator"


def joints_of(model: Any) -> dict[str, ModelJoint]:
    """Return the joints of a model that have one position, by name."""
    at: dict[int, list[tuple[int, str | None]]] = {}
    for number in range(model.nu):
        if int(model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT):
            joint = int(model.actuator_trnid[number, 0])
            at.setdefault(joint, []).append((number, kind_of(model, number)))
    found = {}
    for number in range(model.njnt):
        units = UNITS_OF_JOINTS.get(int(model.jnt_type[number]))
        if units is not None:
            name = model.joint(number).name
            places = int(model.jnt_qposadr[number]), int(model.jnt_dofadr[number])
            found[name] = ModelJoint(name, units["position"], number, *places, tuple(at.get(number, ())))
    return found


class Push:
    """Gives a joint a torque, or a slide a force: by its motor, whose limits count, or directly."""

    def __init__(self, model: Any, data: Any, joint: ModelJoint, motor: int | None) -> None:
        if motor is None:
            self._row, self._at, self._factor = data.qfrc_applied, joint.dof, 1.0
        else:
            gain = float(model.actuator_gainprm[motor, 0]) * float(model.actuator_gear[motor, 0])
            self._row, self._at, self._factor = data.ctrl, motor, 1.0 / gain

    def give(self, effort: float) -> None:
        """Let it push so from now on."""
        self._row[self._at] = effort * self._factor
