# SPDX-License-Identifier: BSD-3-Clause
"""The plant that moves a model of MuJoCo.

The joints, actuators and sensors of the model belong to values of the spec (docs/mujoco.md).
"""

from __future__ import annotations

import logging
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Spec

from ...registers import Registers
from ..si_words import SiWords
from .binding import bind
from .model_file import load_model

LEAST_PERIOD_S = 0.001
# how often position, velocity and acceleration were no numbers, or too large
_FIRST_UNSTABLE = int(mujoco.mjtWarning.mjWARN_BADQPOS)
_LAST_UNSTABLE = int(mujoco.mjtWarning.mjWARN_BADQACC)
_log = logging.getLogger("unitylink.simulate")


class MujocoPlant:
    """A model of MuJoCo (MJCF or URDF). `notes` names what belongs to nothing.

    It steps every millisecond, or with the time step of the model if that is longer. Raises UnityLinkError
    for a model that MuJoCo refuses, and if nothing in it belongs to a value.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        loaded = load_model(file)
        self.model = loaded.model
        self._said = loaded.values
        self._of_model = loaded.notes
        self.data = mujoco.MjData(self.model)
        self._unstable = self.data.warning.number[_FIRST_UNSTABLE : _LAST_UNSTABLE + 1]  # a view
        step_s = float(self.model.opt.timestep)
        self._at_once = max(1, round(LEAST_PERIOD_S / step_s))
        self.period_s = self._at_once * step_s
        self.notes: tuple[str, ...] = ()
        self._begun = False
        self._attached: tuple[int, int] | None = None

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the values of joints, actuators and sensors."""
        if self._attached == (id(spec), id(registers)):  # the board begins anew
            self._start()
            return
        self._attached = id(spec), id(registers)
        found = bind(spec, self.model, self._said, self._file)
        self.notes = (*self._of_model, *found.notes)
        for note in self.notes:
            _log.warning("plant mujoco:%s: %s", self._file, note)
        driven = [one for one in found.moved if one.place.what == "actuator"]
        self._set_points = SiWords([one.word for one in driven], registers)
        self._controls = np.array([one.place.index for one in driven], dtype=np.intp)
        limits = {one.place.index: one.word for one in found.moved if one.place.what == "limit"}
        # of the set-points that have one, in their order
        self._limited = np.array([one.place.index in limits for one in driven], dtype=np.bool_)
        ordered = [limits[one.place.index] for one in driven if one.place.index in limits]
        self._limits = SiWords(ordered, registers) if ordered else None
        self._sensors = SiWords([one.word for one in found.seen], registers)
        self._numbers = np.zeros(len(found.seen))
        data = self.data
        rows = {
            "position": data.qpos,
            "velocity": data.qvel,
            "effort": data.qfrc_actuator,
            "sensor": data.sensordata,
        }
        self._rows = []  # (numbers of the model, where they are shown, which of them)
        for what, row in rows.items():
            where = [number for number, one in enumerate(found.seen) if one.place.what == what]
            if where:
                indices = np.array([found.seen[number].place.index for number in where])
                self._rows.append((row, np.array(where), indices))
        self._start()

    def _start(self) -> None:
        """Stand still where the model begins."""
        joints = self.model.actuator_trnid[self._controls[self._limited], 0]
        self.data.ctrl[self._controls[self._limited]] = self.data.qpos[self.model.jnt_qposadr[joints]]
        mujoco.mj_forward(self.model, self.data)
        self._show()

    def step(self, time_s: float) -> None:
        """Let the model move on by `period_s`. Raises UnityLinkError if it has become unstable."""
        wanted = self._set_points.read()
        if self._limits is not None:
            now = self.data.ctrl[self._controls[self._limited]]
            most = np.abs(self._limits.read()) * self.period_s
            wanted[self._limited] = now + np.clip(wanted[self._limited] - now, -most, most)
        self.data.ctrl[self._controls] = wanted
        if self._begun:  # the first step is in the moment of the reset, so nothing has moved yet
            mujoco.mj_step(self.model, self.data, self._at_once)
        self._begun = True
        self._check(time_s)
        self._show()

    def reset(self) -> None:
        """Go back to the start of the model."""
        mujoco.mj_resetData(self.model, self.data)
        self._begun = False

    def save(self) -> object:
        """Return all that the next steps depend on."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        numbers = np.empty(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, self.data, numbers, kind)
        return self._begun, numbers

    def restore(self, state: Any) -> None:
        """Go on from what `save` has returned, of this model."""
        self._begun, numbers = state
        mujoco.mj_setState(self.model, self.data, numbers, mujoco.mjtState.mjSTATE_INTEGRATION)

    def _show(self) -> None:
        for row, where, indices in self._rows:
            self._numbers[where] = row[indices]
        self._sensors.write(self._numbers)

    def _check(self, time_s: float) -> None:
        if not self._unstable.any():
            return
        size = np.abs(np.nan_to_num(self.data.qacc, nan=np.inf))
        worst = int(np.argmax(size)) if size.size else 0
        joint = self.model.joint(int(self.model.dof_jntid[worst])).name
        raise UnityLinkError(
            f"the model has become unstable at {time_s:.4f} s, first at joint {joint!r}; use a shorter "
            "timestep, integrator implicitfast, or more armature and damping"
        )
