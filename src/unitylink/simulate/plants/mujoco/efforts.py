# SPDX-License-Identifier: BSD-3-Clause
"""Where the effort of a joint is in a model, and at which joints there is none to measure."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np

from .places import Place

NO_EFFORT = "no effort"
_AT_A_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
_TRIED = 3


class Efforts:
    """The efforts of a model's joints. `pushed` are the numbers of those that a component pushes directly.

    A joint that nothing pushes has an effort of 0 for ever, which says nothing about it.
    """

    def __init__(self, model: Any, pushed: Collection[int]) -> None:
        self._pushed = {int(model.jnt_dofadr[number]) for number in pushed}
        transmissions = [int(kind) for kind in model.actuator_trntype]
        at_joints = [number for number, kind in enumerate(transmissions) if kind in _AT_A_JOINT]
        self._driven = {int(model.jnt_dofadr[model.actuator_trnid[number, 0]]) for number in at_joints}
        if len(at_joints) < model.nu:  # a tendon or a site, say, may push any joint
            self._driven |= _felt(model)

    def of(self, place: Place) -> Place:
        """Return the place of an effort. Where there is none to measure, it is NO_EFFORT."""
        if place.what != "effort" or place.index in self._driven:
            return place
        return replace(place, what="push" if place.index in self._pushed else NO_EFFORT)


def _felt(model: Any) -> set[int]:
    """Return the degrees of freedom that feel the actuators, in some poses of the model."""
    data, random = mujoco.MjData(model), np.random.default_rng(0)
    felt = np.zeros(model.nv, dtype=bool)
    limited = np.asarray(model.actuator_ctrllimited, dtype=bool)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    for _ in range(_TRIED):
        mujoco.mj_resetData(model, data)
        mujoco.mj_integratePos(model, data.qpos, random.normal(size=model.nv), 0.5)
        data.ctrl[:], data.act[:] = random.uniform(low, high), random.uniform(0.2, 1.0, model.na)
        for forward in (mujoco.mj_fwdPosition, mujoco.mj_fwdVelocity, mujoco.mj_fwdActuation):
            forward(model, data)
        felt |= data.qfrc_actuator != 0
    return {int(dof) for dof in np.flatnonzero(felt)}
