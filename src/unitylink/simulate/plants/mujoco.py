# SPDX-License-Identifier: BSD-3-Clause
"""A robot's model in MuJoCo behind the registers: `plant=mujoco:robot.xml`.

The joints, actuators and sensors of the model belong to values of the spec by name and unit (docs/mujoco.md).
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import mujoco  # type: ignore[import-untyped]
import numpy as np

from unitylink.errors import UnityLinkError
from unitylink.interface.joint_names import names_of, plain
from unitylink.spec.model import Element, Spec
from unitylink.spec.units import unit

from ..registers import Registers
from .si_words import SiWords

LEAST_PERIOD_S = 0.001
_TURNS = {"position": "rad", "velocity": "rad/s", "effort": "N m"}
_SLIDES = {"position": "m", "velocity": "m/s", "effort": "N"}
_UNITS = {int(mujoco.mjtJoint.mjJNT_HINGE): _TURNS, int(mujoco.mjtJoint.mjJNT_SLIDE): _SLIDES}
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
_log = logging.getLogger("unitylink.simulate")


@dataclass(frozen=True)
class _Place:
    """A number of the model that a value may have: what it is called, its unit, and where it is."""

    name: str
    what: str  # "position", "velocity", "effort" or "sensor"; "actuator" or "limit" for what is commanded
    unit: str | None  # None: any
    index: int


class MujocoPlant:
    """A model of MuJoCo (MJCF or URDF). `notes` names what belongs to nothing.

    It steps every millisecond, or with the time step of the model if that is longer. Raises UnityLinkError
    for a model that MuJoCo refuses, and if nothing in it belongs to a value.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        if not Path(file).is_file():  # MuJoCo's own message for this is that of a parser
            raise UnityLinkError(f"plant mujoco:{file}: there is no such file")
        try:
            self.model = mujoco.MjModel.from_xml_path(file)
        except ValueError as error:
            raise UnityLinkError(f"plant mujoco:{file}: {error}") from error
        mujoco.set_mju_user_warning(_log.debug)  # else they go to a file in the working folder
        # or a model that has become unstable would begin anew, and say nothing
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        self.data = mujoco.MjData(self.model)
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
        elements = [one for root in spec.roots for one in root.walk()] if spec else []
        names = {
            path: found for root in (spec.roots if spec else ()) for path, found in names_of(root).items()
        }
        notes: list[str] = []
        read = [one for one in elements if not one.writable]
        written = [one for one in elements if one.writable and one.access != "PULSE"]
        seen = list(_bound(list(self._measured()), read, names, notes))
        moved = list(_bound(list(self._actuators()), written, names, notes))
        if not seen and not moved:
            joints = ", ".join(place.name for place in self._measured() if place.what == "position") or "none"
            values = ", ".join(one.path for one in elements[:8]) or "none"
            raise UnityLinkError(
                f"plant mujoco:{self._file}: no joint belongs to a value. Its joints: {joints}. Values of "
                f"the spec: {values}. They belong together by name and unit (docs/mujoco.md)"
            )
        self.notes = tuple(notes)
        for note in notes:
            _log.warning("plant mujoco:%s: %s", self._file, note)
        driven = [one for one in moved if one[1].what == "actuator"]
        self._set_points = SiWords([(one, factor) for one, _, factor in driven], registers)
        self._controls = np.array([place.index for _, place, _ in driven], dtype=np.intp)
        limits = {place.index: (one, factor) for one, place, factor in moved if place.what == "limit"}
        # of the set-points that have one, in their order
        self._limited = np.array([place.index in limits for _, place, _ in driven], dtype=np.bool_)
        ordered = [limits[place.index] for _, place, _ in driven if place.index in limits]
        self._limits = SiWords(ordered, registers) if ordered else None
        self._sensors = SiWords([(one, factor) for one, _, factor in seen], registers)
        self._numbers = np.zeros(len(seen))
        data = self.data
        rows = {
            "position": data.qpos,
            "velocity": data.qvel,
            "effort": data.qfrc_actuator,
            "sensor": data.sensordata,
        }
        self._rows = []  # (numbers of the model, where they are shown, which of them)
        for what, row in rows.items():
            where = [number for number, (_, place, _) in enumerate(seen) if place.what == what]
            if where:
                self._rows.append(
                    (row, np.array(where), np.array([seen[number][1].index for number in where]))
                )
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
        kinds = mujoco.mjtWarning
        bad = (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC)
        if not any(self.data.warning[kind].number for kind in bad):
            return
        size = np.abs(np.nan_to_num(self.data.qacc, nan=np.inf))
        worst = int(np.argmax(size)) if size.size else 0
        joint = self.model.joint(int(self.model.dof_jntid[worst])).name
        raise UnityLinkError(
            f"the model has become unstable at {time_s:.4f} s, first at joint {joint!r}; use a shorter "
            "timestep, integrator implicitfast, or more armature and damping"
        )

    def _measured(self) -> Iterator[_Place]:
        """Yield what the joints and sensors measure."""
        model = self.model
        for number in range(model.njnt):
            units = _UNITS.get(int(model.jnt_type[number]))
            if units is None:
                continue  # a free joint or a ball has no single position
            name, dof = model.joint(number).name, int(model.jnt_dofadr[number])
            yield _Place(name, "position", units["position"], int(model.jnt_qposadr[number]))
            yield _Place(name, "velocity", units["velocity"], dof)
            yield _Place(name, "effort", units["effort"], dof)
        for number in range(model.nsensor):
            name, first = model.sensor(number).name, int(model.sensor_adr[number])
            size, fits = int(model.sensor_dim[number]), _SENSOR_UNITS.get(int(model.sensor_type[number]))
            for index in range(size):
                named = (_PARTS[size][index],) if size in _PARTS else ()
                for part in dict.fromkeys((*named, f"[{index}]" if size > 1 else "")):
                    yield _Place(f"{name}{part}", "sensor", fits, first + index)

    def _actuators(self) -> Iterator[_Place]:
        """Yield what may be commanded, and how fast a position may. It is called as the actuator, or as its
        joint."""
        model, limits = self.model, list[_Place]()
        for number in range(model.nu):
            joint, units = None, None
            if int(model.actuator_trntype[number]) == int(mujoco.mjtTrn.mjTRN_JOINT):
                joint = int(model.actuator_trnid[number, 0])
                units = _UNITS.get(int(model.jnt_type[joint]))
            kind = self._kind_of(number)
            fits = units[kind] if units and kind else None
            own = model.actuator(number).name
            for name in dict.fromkeys((own, model.joint(joint).name if joint is not None else own)):
                yield _Place(name, "actuator", fits, number)
                if units and kind == "position":
                    limits.append(_Place(name, "limit", units["velocity"], number))
        yield from limits  # behind the others: a velocity belongs to a motor that wants one

    def _kind_of(self, number: int) -> str | None:
        """Return what an actuator wants: "position", "velocity" or "effort". None: something else."""
        model, biases = self.model, mujoco.mjtBias
        bias = int(model.actuator_biastype[number])
        if bias == int(biases.mjBIAS_NONE):
            return "effort"
        if bias != int(biases.mjBIAS_AFFINE):
            return None
        if model.actuator_biasprm[number, 1] != 0:
            return "position"
        return "velocity" if model.actuator_biasprm[number, 2] != 0 else None


def _bound(
    places: Sequence[_Place], elements: Sequence[Element], names: dict[str, set[str]], notes: list[str]
) -> Iterator[tuple[Element, _Place, float]]:
    """Yield (value, place, factor to SI) for each value that belongs to a place. Note the others."""
    taken: set[tuple[str, int]] = set()
    for element in elements:
        fitting = [(place, factor) for place in places if (factor := _factor(element, place)) is not None]
        found = [(place, factor) for place, factor in fitting if _is_called(place, names[element.path])]
        if found:
            place, factor = found[0]
            if (place.what, place.index) not in taken:
                taken.add((place.what, place.index))
                yield element, place, factor
            else:
                notes.append(
                    f"{element.path} is left out, because another value belongs to {place.name}, too"
                )
        elif other := [place for place in places if _is_called(place, names[element.path], "sensor")]:
            notes.append(
                f"{element.path} is left out: it has {element.unit or 'no unit'}, and the sensor "
                f"{other[0].name} measures {other[0].unit or 'a number of one word'}"
            )
        elif fitting and element.unit:
            near = get_close_matches(element.path, sorted({place.name for place, _ in fitting}), 3, 0.3)
            notes.append(
                f"{element.path} belongs to nothing in the model; nearest: {', '.join(near) or 'none'}"
            )
    for place in places:
        if place.what in ("position", "actuator") and (place.what, place.index) not in taken:
            if place.what == "position" or place.name:
                what = "shows the position of joint" if place.what == "position" else "drives the actuator"
                notes.append(f"no value {what} {place.name}")
            taken.add((place.what, place.index))


def _is_called(place: _Place, names: set[str], what: str = "") -> bool:
    return plain(place.name) in names and place.what in (what or place.what)


def _factor(element: Element, place: _Place) -> float | None:
    """Return the factor from a value to SI, or None if it cannot be this number of the model."""
    own = unit(element.unit)
    kind = element.type
    if (
        not kind.numeric
        or (kind.kind == "float" and kind.width != 32)
        or len(element.addresses) != 1
        or (own is not None and own.offset)
    ):
        return None
    if place.unit is None or (place.what == "sensor" and own is None):
        return float(own.factor) if own is not None else 1.0
    si = unit(place.unit)
    if own is None or si is None or own.dimension != si.dimension:
        return None
    return float(own.factor / si.factor)
