# SPDX-License-Identifier: BSD-3-Clause
"""A model of MuJoCo in motion. Several boards of a process may move the same one."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any
from weakref import WeakValueDictionary

import mujoco  # type: ignore[import-untyped]
import numpy as np

from unitylink.errors import UnityLinkError

LEAST_PERIOD_S = 0.001
# how often position, velocity and acceleration were no numbers, or too large
_FIRST_UNSTABLE = int(mujoco.mjtWarning.mjWARN_BADQPOS)
_LAST_UNSTABLE = int(mujoco.mjtWarning.mjWARN_BADQACC)
_shared: WeakValueDictionary[Path, World] = WeakValueDictionary()


def steps_at_once(model: Any) -> int:
    """Return how many time steps of a model one of the plant has."""
    return max(1, round(LEAST_PERIOD_S / float(model.opt.timestep)))


class World:
    """The model and its data. It steps every millisecond, or with the time step of the model if that is
    longer.

    `steps` counts them. A board that is ahead makes the next one, and those behind it only look. `lock` is
    for boards whose time passes by itself, each in a thread of its own.
    """

    def __init__(self, model: Any) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        self._at_once = steps_at_once(model)
        self.period_s = self._at_once * float(model.opt.timestep)
        self.steps = 0
        self.lock = threading.RLock()
        self._unstable = self.data.warning.number[_FIRST_UNSTABLE : _LAST_UNSTABLE + 1]  # a view
        self._members: set[tuple[str, ...]] = set()

    @staticmethod
    def shared_by(path: Path, member: tuple[str, ...], otherwise: World) -> World:
        """Return the world of a file that another board has already, else the one given.

        A second board of the same part of a spec, `member`, has another world.
        """
        world = _shared.get(path.resolve())
        if world is None or member in world._members:
            world = _shared[path.resolve()] = otherwise
        world._members.add(member)
        return world

    def move_to(self, steps: int, time_s: float) -> None:
        """Make a step, unless another board has. Raises UnityLinkError if the model has become unstable."""
        if steps > self.steps:
            self.steps = steps
            mujoco.mj_step(self.model, self.data, self._at_once)
        if self._unstable.any():
            size = np.abs(np.nan_to_num(self.data.qacc, nan=np.inf))
            worst = int(np.argmax(size)) if size.size else 0
            joint = self.model.joint(int(self.model.dof_jntid[worst])).name
            raise UnityLinkError(
                f"the model has become unstable at {time_s:.4f} s, first at joint {joint!r}; use a shorter "
                "timestep, integrator implicitfast, or more armature and damping"
            )
