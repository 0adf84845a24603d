# SPDX-License-Identifier: BSD-3-Clause
"""A stepper motor: it follows its steps as long as its torque suffices, and then loses some."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.errors import ValueRangeError

from .checks import check_number, check_positive, check_whole
from .supply import Supply

_PART_S = 50e-6
_LONGEST_S = 0.1
_SWING = 0.1  # of a radian of its natural swing, at most, in a part of a step


@dataclass(frozen=True)
class StepperData:
    """A hybrid stepper motor with two phases, as its datasheet says it.

    `holding_torque_ncm` is with both phases at `current_a`. Raises ValueRangeError for a figure that cannot
    be, by its name.
    """

    name: str
    current_a: float
    resistance_ohm: float
    inductance_mh: float
    holding_torque_ncm: float
    rotor_inertia_g_cm2: float
    detent_torque_ncm: float = 0.0
    steps_per_turn: int = 200
    friction_ncm: float = 0.5
    source: str = ""
    estimated: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        what = f"stepper {self.name}"
        for name in (
            "current_a",
            "resistance_ohm",
            "inductance_mh",
            "holding_torque_ncm",
            "rotor_inertia_g_cm2",
        ):
            check_positive(what, name, getattr(self, name), remedy="it is on each datasheet of a stepper")
        for name in ("detent_torque_ncm", "friction_ncm"):
            check_number(what, name, getattr(self, name), least=0.0)
        check_whole(what, "steps_per_turn", self.steps_per_turn, least=4, remedy="1.8 degrees are 200 steps")
        if self.steps_per_turn % 4:
            raise ValueRangeError(
                f"{what}: steps_per_turn is {self.steps_per_turn}; it must be a multiple of 4"
            )

    @property
    def pole_pairs(self) -> int:
        return self.steps_per_turn // 4

    @property
    def constant(self) -> float:
        """The torque of a phase for each A, in N m."""
        return self.holding_torque_ncm / 100 / (math.sqrt(2) * self.current_a)


class Stepper:
    """The motor with a driver that regulates its currents, and a load of some inertia.

        stepper = Stepper(STEPPERS["17HS19-2004S1"], Supply(24.0), microsteps=16)
        stepper.load_nm = 0.1                                               # pulls it back
        stepper.follow(motor.steps("step", "direction", 0), self.period_s)  # in each step
        stepper.angle_rad, stepper.lost_steps

    The currents cannot rise faster than the supply and the inductance let them. So its torque falls with the
    speed, and a load or a speed that is too high makes it slip, by four whole steps at a time.
    """

    def __init__(
        self,
        data: StepperData,
        supply: Supply,
        *,
        microsteps: int = 16,
        current_a: float | None = None,
        load_inertia_kg_m2: float = 0.0,
    ) -> None:
        self._what = f"stepper {data.name}"
        self.data, self.supply = data, supply
        check_whole(self._what, "microsteps", microsteps, remedy="1 is full steps")
        chosen_a = data.current_a if current_a is None else current_a
        check_positive(self._what, "current_a", chosen_a, remedy="set is_enabled to switch it off")
        self._amplitude = math.sqrt(2) * chosen_a
        self._angle_a_step = 2 * math.pi / data.steps_per_turn / microsteps
        load = check_number(self._what, "load_inertia_kg_m2", load_inertia_kg_m2, least=0.0)
        self._inertia = data.rotor_inertia_g_cm2 * 1e-7 + load
        poles = data.pole_pairs
        stiff = poles * data.constant * self._amplitude + 4 * poles * data.detent_torque_ncm / 100
        self._part_s = min(_PART_S, _SWING / math.sqrt(stiff / self._inertia))
        self.angle_rad = self.speed_rad_s = 0.0
        self.load_nm = 0.0
        self.is_enabled = True
        self._currents = [0.0, 0.0]
        self._steps: float = 0

    @property
    def lost_steps(self) -> int:
        """Whole steps by which it is behind what was commanded. They are a multiple of 4."""
        off = self._steps * self._angle_a_step - self.angle_rad
        return 4 * round(off * self.data.pole_pairs / (2 * math.pi))

    @property
    def currents_a(self) -> tuple[float, float]:
        return self._currents[0], self._currents[1]

    def follow(self, steps: float, seconds: float) -> None:
        """Let some time pass, in which the microsteps come evenly until there were so many in all."""
        check_number(self._what, "steps", steps)
        check_number(self._what, "load_nm", self.load_nm, remedy="look at what the plant computes")
        if not 0 <= seconds <= _LONGEST_S:
            raise ValueRangeError(
                f"{self._what}: a step of {seconds!r} s; it must be from 0 to {_LONGEST_S:g} s, so choose "
                "a shorter period_s"
            )
        parts = math.ceil(seconds / self._part_s)
        before, charge = self._steps, 0.0
        for number in range(parts):
            at = math.floor(before + (steps - before) * (number + 1) / parts)
            charge += self._part(at * self._angle_a_step, seconds / parts)
        self._steps = steps
        if seconds > 0:
            self.supply.take(self, charge / seconds, seconds)

    def _part(self, commanded: float, seconds: float) -> float:
        """Move on by a short time. Return the charge that it took."""
        poles, constant = self.data.pole_pairs, self.data.constant
        electric = poles * self.angle_rad
        sine, cosine = math.sin(electric), math.cos(electric)
        back_v = constant * self.speed_rad_s
        charge = 0.0
        volts = self.supply.volts
        if self.is_enabled and volts > 0:
            wanted = poles * commanded
            goals = self._amplitude * math.cos(wanted), self._amplitude * math.sin(wanted)
            charge = self._regulate(goals, (-back_v * sine, back_v * cosine), volts, seconds)
        else:
            self._currents = [0.0, 0.0]
        first, second = self._currents
        torque = constant * (second * cosine - first * sine) - self.load_nm
        torque -= self.data.detent_torque_ncm / 100 * math.sin(4 * electric)
        self._move(torque, seconds)
        return charge

    def _regulate(
        self, goals: tuple[float, float], backs: tuple[float, float], volts: float, seconds: float
    ) -> float:
        """Bring the currents of both phases to their goals, as far as the voltage suffices."""
        ohm = self.data.resistance_ohm
        kept = math.exp(-ohm * seconds / (self.data.inductance_mh / 1000))
        energy = 0.0
        for phase in range(2):
            now = self._currents[phase]
            needed = ohm * (goals[phase] - kept * now) / (1 - kept) + backs[phase]
            given = min(max(needed, -volts), volts)
            rest = (given - backs[phase]) / ohm
            after = rest + kept * (now - rest)
            energy += given * (now + after) / 2 * seconds
            self._currents[phase] = after
        return energy / volts

    def _move(self, torque: float, seconds: float) -> None:
        friction = self.data.friction_ncm / 100
        if self.speed_rad_s == 0 and abs(torque) <= friction:
            return
        torque -= math.copysign(friction, self.speed_rad_s or torque)
        before = self.speed_rad_s
        self.speed_rad_s += torque / self._inertia * seconds
        if before * self.speed_rad_s < 0:
            self.speed_rad_s = 0.0  # friction stops it, and does not turn it round
        self.angle_rad += self.speed_rad_s * seconds
