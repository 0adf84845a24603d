# SPDX-License-Identifier: BSD-3-Clause
"""What is between the step pins of a component and a joint of a model: a stepper that may lose steps."""

from __future__ import annotations

from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np

from ...components import BoardComponent
from ...machine import TurnedShaft, TurnedStepper
from .drives import Axis
from .model_joint import Push
from .world import steps_at_once


class StepperDrive:
    """A stepper. It begins with its rotor in the field, wherever the joint is."""

    def __init__(
        self, component: BoardComponent, stepper: TurnedStepper, axis: Axis, push: Push, *, channel: int
    ) -> None:
        self._pins, self.stepper, self._axis, self._push = component, stepper, axis, push
        self._channel = channel
        self._start = axis.angle
        data = axis.data
        self._unit, self._solved = np.zeros((1, data.qvel.size)), np.zeros((1, data.qvel.size))
        self._unit[0, axis.joint.dof] = 1.0
        self._pins.steps("step", "direction", channel)  # from here on they are counted

    @property
    def lost_steps(self) -> int:
        """Whole steps by which the rotor is behind. They are a multiple of 4."""
        self.stepper.angle_rad = (self._axis.angle - self._start) * self.stepper.ratio
        return self.stepper.lost_steps

    def check_period(self, model: Any) -> None:
        """Raise ValueRangeError if the joint would swing too fast in the field."""
        at_once = steps_at_once(model)
        self.stepper.check_period(self._inertia(model), at_once * float(model.opt.timestep), at_once)

    def push(self, seconds: float) -> None:
        data, dof, sign = self._axis.data, self._axis.joint.dof, self._axis.sign
        inertia = self._inertia(data.model)
        # what all other forces together did in the last time step
        given = float(data.qfrc_applied[dof] + data.qfrc_actuator[dof])
        load = given - inertia * float(data.qacc[dof])
        shaft = TurnedShaft(self._axis.angle - self._start, self._axis.speed, inertia, sign * load)
        steps = self._pins.steps("step", "direction", self._channel)
        self._push.give(sign * self.stepper.give(steps, seconds, shaft))

    def _inertia(self, model: Any) -> float:
        """Return what the joint has to move now, if all others are free."""
        mujoco.mj_solveM(model, self._axis.data, self._solved, self._unit)
        return 1.0 / float(self._solved[0, self._axis.joint.dof])
