# SPDX-License-Identifier: BSD-3-Clause
"""A brushless motor: three windings, a rotor with magnets, and a load."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

from unitylink.errors import ValueRangeError

from .brushless_data import BrushlessData
from .checks import check_number

_PART_S = 50e-6
_LONGEST_S = 0.1
_PART_RAD = 0.2  # of an electrical turn, at most, in a part of a step
_HALF_ROOT_3 = math.sqrt(3) / 2


class Brushless:
    """The motor, with a load of some inertia and a torque that may change.

        motor = Brushless(BRUSHLESS["GBM2804H-100T"], load_inertia_kg_m2=1e-5)
        motor.load_nm = 0.01                        # pulls it back
        motor.step((8.0, 4.0, 4.0), self.period_s)  # volts at the terminals; `Inverter` does this from pins
        motor.angle_rad, motor.speed_rad_s, motor.currents_a, motor.torque_nm

    A current into a terminal is positive. The currents are those along alpha and beta, as one complex number:
    alpha is the axis of the first phase. At angle 0 the magnets lie along it.

    A step goes in parts of 50 µs or less. In each, the current is the exact solution for a rotor that turns
    evenly.
    """

    def __init__(
        self,
        data: BrushlessData,
        *,
        load_inertia_kg_m2: float = 0.0,
        load_friction_nm: float = 0.0,
        load_damping_nm_s: float = 0.0,
        angle_rad: float = 0.0,
    ) -> None:
        self._what = f"motor {data.name}"
        self.data = data
        load = check_number(self._what, "load_inertia_kg_m2", load_inertia_kg_m2, least=0.0)
        self._inertia = data.rotor_inertia_g_cm2 * 1e-7 + load
        friction = check_number(self._what, "load_friction_nm", load_friction_nm, least=0.0)
        self._friction = data.friction_mnm / 1000 + friction
        self._damping = check_number(self._what, "load_damping_nm_s", load_damping_nm_s, least=0.0)
        self._flux = data.flux_mwb / 1000
        self._henry = data.inductance_mh / 1000
        self._constant = data.torque_constant
        self.angle_rad = check_number(self._what, "angle_rad", angle_rad)
        self.speed_rad_s = 0.0
        self.load_nm = 0.0
        self.torque_nm = 0.0  # that of the magnets, at the end of the last step
        self.current = 0j

    @property
    def currents_a(self) -> tuple[float, float, float]:
        """The currents of the three phases. Their sum is 0."""
        alpha, beta = self.current.real, self.current.imag * _HALF_ROOT_3
        return alpha, beta - alpha / 2, -beta - alpha / 2

    @property
    def currents_dq_a(self) -> tuple[float, float]:
        """The current along the magnets, and the one across them, which makes the torque."""
        turned = self.current * cmath.exp(-1j * self.data.pole_pairs * self.angle_rad)
        return turned.real, turned.imag

    def step(self, volts: Sequence[float], seconds: float, *, series_ohm: float = 0.0) -> float:
        """Let some time pass with voltages at the terminals. Return the energy in J that came from there.

        `series_ohm` is the resistance of the transistors of a phase.
        """
        first, second, third = volts
        alpha, beta = (2 * first - second - third) / 3, (second - third) / (2 * _HALF_ROOT_3)
        return self._run(complex(alpha, beta), seconds, series_ohm)

    def coast(self, supply_v: float, seconds: float) -> None:
        """Let some time pass with all gates off: the currents end in the diodes, against the supply.

        A back-EMF above the supply does not flow into it.
        """
        left = self._checked(seconds)
        while left > 0 and self.current != 0:
            part, before = min(left, _PART_S / 10), self.current
            volts = [-math.copysign(supply_v / 2, amps) if amps else 0.0 for amps in self.currents_a]
            self.step(volts, part)
            if (self.current * before.conjugate()).real <= 0:
                self.current = 0j
            left -= part
        while left > 0:  # it only rolls
            part = min(left, _PART_S)
            self._move(0.0, part)
            left -= part
        self.torque_nm = self._torque()

    def _checked(self, seconds: float) -> float:
        check_number(self._what, "load_nm", self.load_nm, remedy="look at what the plant computes")
        if not 0 <= seconds <= _LONGEST_S:
            raise ValueRangeError(
                f"{self._what}: a step of {seconds!r} s; it must be from 0 to {_LONGEST_S:g} s, so choose "
                "a shorter period_s"
            )
        return seconds

    def _run(self, volts: complex, seconds: float, series_ohm: float) -> float:
        if not cmath.isfinite(volts):
            raise ValueRangeError(f"{self._what}: its voltage is {volts}; look at what the plant computes")
        left, charge = self._checked(seconds), 0j
        henry, flux, poles = self._henry, self._flux, self.data.pole_pairs
        rate = (self.data.resistance_ohm + series_ohm) / henry
        rest = volts / (rate * henry)
        while left > 0:
            turning = poles * self.speed_rad_s  # electrical rad/s
            part = left if left < _PART_S else _PART_S
            if abs(turning) * part > _PART_RAD:
                part = _PART_RAD / abs(turning)
            magnets, turned = cmath.rect(1.0, poles * self.angle_rad), cmath.rect(1.0, turning * part)
            before, kept = self.current, math.exp(-rate * part)
            pulled = 1j * turning * magnets * (turned - kept) / (rate + 1j * turning)
            after = self.current = rest + kept * (before - rest) - flux / henry * pulled
            # the charge follows from the voltages: what the windings keep, and what the magnets make
            made = flux * magnets * (turned - 1)
            charge += rest * part - (made + henry * (after - before)) / (rate * henry)
            across = (before * magnets.conjugate()).imag + (after * (magnets * turned).conjugate()).imag
            self._move(self._constant * across / 2, part)
            left -= part
        self.torque_nm = self._torque()
        return 1.5 * (volts * charge.conjugate()).real

    def _torque(self) -> float:
        return self._constant * self.currents_dq_a[1]

    def _move(self, torque: float, seconds: float) -> None:
        given = torque - self.load_nm - self._damping * self.speed_rad_s
        before = self.speed_rad_s
        if before == 0 and abs(given) <= self._friction:
            return  # it sticks
        given -= math.copysign(self._friction, before or given)
        self.speed_rad_s += given / self._inertia * seconds
        if before * self.speed_rad_s < 0:
            self.speed_rad_s = 0.0  # friction stops it, and does not turn it round
        self.angle_rad += (before + self.speed_rad_s) / 2 * seconds
