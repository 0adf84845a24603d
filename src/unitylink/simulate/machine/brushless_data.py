# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a brushless motor, of a phase or from terminal to terminal."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .checks import check_number, check_positive, check_whole
from .dc_motor_data import DcMotorData

# The mean of a sine over the sixth of a turn in which a block commutation uses it.
_BLOCK = 3 / math.pi


@dataclass(frozen=True)
class BrushlessData:
    """A brushless motor with three phases in a star, and a back-EMF that is a sine.

    Resistance and inductance are of a phase, from its terminal to the star. `flux_mwb` is the linkage of the
    magnets with a phase: its peak voltage for each electrical rad/s. `friction_mnm` is the same at each
    speed. `estimated` names figures that the source does not have. Raises ValueRangeError for a figure that
    cannot be, by its name.
    """

    name: str
    pole_pairs: int
    resistance_ohm: float
    inductance_mh: float
    flux_mwb: float
    rotor_inertia_g_cm2: float
    friction_mnm: float = 0.0
    source: str = ""
    estimated: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        what = f"motor {self.name}"
        check_whole(what, "pole_pairs", self.pole_pairs, remedy="14 magnets are 7 pole pairs")
        for name, remedy in (
            ("resistance_ohm", "take half of what is from terminal to terminal"),
            ("inductance_mh", "take half of what is from terminal to terminal"),
            ("flux_mwb", "of_terminals computes it from a torque constant or from rpm for each volt"),
            ("rotor_inertia_g_cm2", "take the rotor inertia; 1 g cm² is 1e-7 kg m²"),
        ):
            check_positive(what, name, getattr(self, name), remedy=remedy)
        check_number(what, "friction_mnm", self.friction_mnm, least=0.0)

    @classmethod
    def of_terminals(
        cls,
        name: str,
        *,
        pole_pairs: int,
        resistance_ohm: float,
        inductance_mh: float,
        torque_constant_mnm_a: float,
        rotor_inertia_g_cm2: float,
        friction_mnm: float = 0.0,
        source: str = "",
        estimated: tuple[str, ...] = (),
    ) -> BrushlessData:
        """Return the data of a motor whose datasheet is for block commutation, from terminal to terminal.

        The torque constant is that of the current of two phases; it is 9549.3 over the rpm for each volt.
        """
        check_positive(f"motor {name}", "torque_constant_mnm_a", torque_constant_mnm_a)
        check_whole(f"motor {name}", "pole_pairs", pole_pairs)
        return cls(
            name,
            pole_pairs,
            resistance_ohm / 2,
            inductance_mh / 2,
            torque_constant_mnm_a / (math.sqrt(3) * _BLOCK * pole_pairs),
            rotor_inertia_g_cm2,
            friction_mnm,
            source,
            estimated,
        )

    def in_blocks(self, nominal_v: float) -> DcMotorData:
        """Return what the motor is for a speed controller that commutates it in blocks: a DC motor.

        It is the other way round from `of_terminals`. All of its friction is the same at each speed.
        """
        constant = math.sqrt(3) * _BLOCK * self.pole_pairs * self.flux_mwb
        return DcMotorData(
            self.name,
            nominal_v,
            2 * self.resistance_ohm,
            2 * self.inductance_mh,
            constant,
            self.rotor_inertia_g_cm2,
            no_load_current_ma=1000 * self.friction_mnm / constant,
            source=self.source,
            estimated=self.estimated,
        )

    @property
    def torque_constant(self) -> float:
        """The torque in N m for each A of the current across the magnets (q), the peak of a phase."""
        return 1.5 * self.pole_pairs * self.flux_mwb / 1000
