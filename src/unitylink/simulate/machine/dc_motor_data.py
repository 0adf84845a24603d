# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a DC motor, in the units of its datasheet."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.errors import ValueRangeError

from .checks import check_number, check_positive, check_share

RPM = 2 * math.pi / 60  # rad/s
_LEAST_ELECTRICAL_S = 1e-9  # stands for no inductance


@dataclass(frozen=True)
class DcMotorData:
    """A DC motor with brushes, as its datasheet says it.

    `no_load_current_ma` at the nominal voltage is its friction. `viscous_share` is how much of that grows
    with the speed; the rest is the same at each speed. `estimated` names figures that the source does not
    have. Raises ValueRangeError for a figure that cannot be, by its name.
    """

    name: str
    nominal_v: float
    resistance_ohm: float
    inductance_mh: float
    torque_constant_mnm_a: float
    rotor_inertia_g_cm2: float
    no_load_current_ma: float = 0.0
    viscous_share: float = 0.0
    source: str = ""
    estimated: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        what = f"motor {self.name}"
        for name, remedy in (
            ("nominal_v", "take the nominal voltage of the datasheet"),
            ("resistance_ohm", "take the terminal resistance, or nominal voltage over stall current"),
            ("torque_constant_mnm_a", "take the torque constant, or 9549.3 over the rpm for each volt"),
            ("rotor_inertia_g_cm2", "take the rotor inertia; 1 g cm² is 1e-7 kg m²"),
        ):
            check_positive(what, name, getattr(self, name), remedy=remedy)
        for name in ("inductance_mh", "no_load_current_ma"):
            check_number(what, name, getattr(self, name), least=0.0)
        check_share(what, "viscous_share", self.viscous_share)
        _check_no_load(what, self.no_load_current_ma, self.stall_current_a)

    @classmethod
    def of_curve(
        cls,
        name: str,
        *,
        nominal_v: float,
        no_load_speed_rpm: float,
        no_load_current_ma: float,
        stall_current_a: float,
        rotor_inertia_g_cm2: float,
        inductance_mh: float = 0.0,
        source: str = "",
        estimated: tuple[str, ...] = (),
    ) -> DcMotorData:
        """Return the data of a motor of which only the ends of its curve are known, without a gear."""
        what = f"motor {name}"
        check_positive(what, "nominal_v", nominal_v)
        check_positive(what, "stall_current_a", stall_current_a)
        check_positive(
            what, "no_load_speed_rpm", no_load_speed_rpm, remedy="give that of the motor, before its gear"
        )
        check_number(what, "no_load_current_ma", no_load_current_ma, least=0.0)
        _check_no_load(what, no_load_current_ma, stall_current_a)
        ohm = nominal_v / stall_current_a
        constant = (nominal_v - ohm * no_load_current_ma / 1000) / (no_load_speed_rpm * RPM)
        return cls(
            name,
            nominal_v,
            ohm,
            inductance_mh,
            1000 * constant,
            rotor_inertia_g_cm2,
            no_load_current_ma,
            source=source,
            estimated=estimated,
        )

    # ---- in SI, and what follows from them

    @property
    def constant(self) -> float:
        """The torque for each A in N m, which is the voltage for each rad/s."""
        return self.torque_constant_mnm_a / 1000

    @property
    def inertia_kg_m2(self) -> float:
        return self.rotor_inertia_g_cm2 * 1e-7

    def inductance_h(self, resistance_ohm: float) -> float:
        """Return the inductance. None at all is one with a time constant of a nanosecond."""
        return max(self.inductance_mh / 1000, resistance_ohm * _LEAST_ELECTRICAL_S)

    @property
    def stall_current_a(self) -> float:
        return self.nominal_v / self.resistance_ohm

    @property
    def stall_torque_nm(self) -> float:
        """The torque on the shaft at a standstill, at the nominal voltage."""
        return self.constant * self.stall_current_a - self.friction_nm

    @property
    def no_load_speed_rpm(self) -> float:
        return (self.nominal_v - self.resistance_ohm * self.no_load_current_ma / 1000) / self.constant / RPM

    @property
    def friction_nm(self) -> float:
        """The friction that is the same at each speed."""
        return self.constant * self.no_load_current_ma / 1000 * (1 - self.viscous_share)

    @property
    def damping_nm_s(self) -> float:
        """The friction for each rad/s."""
        lost = self.constant * self.no_load_current_ma / 1000 * self.viscous_share
        return lost / (self.no_load_speed_rpm * RPM)

    @property
    def electrical_s(self) -> float:
        """The time constant of the current, at a standstill."""
        return self.inductance_h(self.resistance_ohm) / self.resistance_ohm

    @property
    def mechanical_s(self) -> float:
        """The time constant of the speed, without a load."""
        return self.resistance_ohm * self.inertia_kg_m2 / self.constant**2


def _check_no_load(what: str, no_load_current_ma: float, stall_current_a: float) -> None:
    if no_load_current_ma / 1000 >= stall_current_a:
        raise ValueRangeError(
            f"{what}: no_load_current_ma is {no_load_current_ma:g}, and at a standstill it takes "
            f"{1000 * stall_current_a:g} mA; the first must be less, and is in mA"
        )
