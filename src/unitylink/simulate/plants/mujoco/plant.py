# SPDX-License-Identifier: BSD-3-Clause
"""The plant that moves a model of MuJoCo.

The joints, actuators and sensors of the model belong to values of the spec (docs/mujoco.md).
"""

from __future__ import annotations

import logging
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np

from unitylink.spec.model import Spec

from ...registers import Registers
from ..si_words import SiWords
from .binding import bind
from .camera import Camera
from .model_file import load_model
from .pin_looks import PinLooks, looks_of
from .world import World

_log = logging.getLogger("unitylink.simulate")


class MujocoPlant:
    """A model of MuJoCo (MJCF or URDF). `notes` names what belongs to nothing.

    Raises UnityLinkError for a model that MuJoCo refuses, and if nothing in it belongs to a value.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        self._loaded = load_model(file)
        self._world = World(self._loaded.model)
        self.period_s = self._world.period_s
        self.notes: tuple[str, ...] = ()
        self._steps: int | None = None  # of the world, as far as this board is; None before its first
        self._attached: tuple[int, int] | None = None
        self._looks_a_step = 1
        self._looks: PinLooks | None = None

    @property
    def model(self) -> Any:
        """The mujoco.MjModel."""
        return self._world.model

    @property
    def data(self) -> Any:
        """The mujoco.MjData, which moves."""
        return self._world.data

    @property
    def drives(self) -> tuple[Any, ...]:
        """What moves joints from the pins of components, in the order of the spec."""
        return tuple(self._drives)

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the values of joints, actuators and sensors."""
        if self._attached == (id(spec), id(registers)):  # the board begins anew
            self._start()
            return
        self._attached = id(spec), id(registers)
        loaded = self._loaded
        if loaded.shared:
            member = tuple(root.name for root in spec.roots) if spec else ()
            self._world = World.shared_by(loaded.path, member, self._world)
        found = bind(spec, self.model, loaded.values, self._file, loaded.motors)
        self._couplings, self._components = found.coupled, registers.components
        self._looks_a_step = looks_of(spec, self._world.period_s) if found.coupled.drives else 1
        self.period_s = self._world.period_s / self._looks_a_step
        # what this board leaves free in a shared world may belong to another
        self.notes = (*loaded.notes, *found.notes, *(() if loaded.shared else found.free))
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
            "push": data.qfrc_applied,  # what a component gives a joint without an actuator
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
        with self._world.lock:
            joints = self.model.actuator_trnid[self._controls[self._limited], 0]
            self.data.ctrl[self._controls[self._limited]] = self.data.qpos[self.model.jnt_qposadr[joints]]
            mujoco.mj_forward(self.model, self.data)
            self._drives, self._shown = self._couplings.made(self._components, self.data)
            self._looks = None
            if self._looks_a_step > 1:
                self._looks = PinLooks(self._looks_a_step, self.period_s, self._drives, self._shown)
                self._looks.show()
                self._shown = [one for one in self._shown if one not in self._looks.shown]
            self._show()
            for shown in self._shown:
                shown.show(0.0)

    def step(self, time_s: float) -> None:
        """Let the model move on, or only look. Raises UnityLinkError if it has become unstable."""
        with self._world.lock:
            if self._looks is not None and not self._looks.due():
                return
            period_s = self._world.period_s
            if self._limits is not None:
                wanted = self._set_points.read()
                now = self.data.ctrl[self._controls[self._limited]]
                most = np.abs(self._limits.read()) * period_s
                wanted[self._limited] = now + np.clip(wanted[self._limited] - now, -most, most)
                self.data.ctrl[self._controls] = wanted
            else:
                if self._loaded.shared:  # another board may have reset the world
                    self._set_points.forget()
                changed = self._set_points.read_new()
                if changed is not None:
                    self.data.ctrl[self._controls] = changed
            for drive in self._drives:
                drive.push(period_s)
            # the first step is in the moment of the reset, so nothing has moved yet
            self._steps = self._world.steps if self._steps is None else self._steps + 1
            self._world.move_to(self._steps, time_s)
            self._show()
            for shown in self._shown:
                shown.show(period_s)
            if self._looks is not None:
                self._looks.show()

    def reset(self) -> None:
        """Go back to the start of the model."""
        with self._world.lock:
            mujoco.mj_resetData(self.model, self.data)
        self._set_points.forget()
        self._steps = None

    def save(self) -> object:
        """Return all that the next steps depend on."""
        return self._steps is not None, self.snapshot()

    def restore(self, state: Any) -> None:
        """Go on from what `save` has returned, of this model."""
        begun, numbers = state
        self._steps = self._world.steps if begun else None
        self._set_points.forget()
        mujoco.mj_setState(self.model, self.data, numbers, mujoco.mjtState.mjSTATE_INTEGRATION)

    def camera(self) -> Camera:
        """Return what draws the model. Raises ToolError if nothing does."""
        return Camera(self.model)

    def snapshot(self) -> Any:
        """Return the state of the model, mjSTATE_INTEGRATION, also from another thread."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        numbers = np.empty(mujoco.mj_stateSize(self.model, kind))
        with self._world.lock:
            mujoco.mj_getState(self.model, self.data, numbers, kind)
        return numbers

    def _show(self) -> None:
        if len(self._rows) == 1:  # as with a robot that tells its positions only
            row, _, indices = self._rows[0]
            self._sensors.write(row[indices])
            return
        for row, where, indices in self._rows:
            self._numbers[where] = row[indices]
        self._sensors.write(self._numbers)
