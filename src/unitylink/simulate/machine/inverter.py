# SPDX-License-Identifier: BSD-3-Clause
"""The six transistors between the pins of a `three_phase_pwm`, a supply and a brushless motor."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from ..components import BoardComponent
from .brushless import Brushless
from .checks import check_number
from .supply import Supply

PHASES = 3
_LOOKS = 20  # the dead time is measured in one of so many steps: a look costs as much as a third of the motor


class Inverter:
    """Drives a motor as the gates of a `three_phase_pwm` say.

        inverter = Inverter(registers.components["motor"], Supply(24.0))
        inverter.drive(motor, self.period_s)  # in each step

    The mean voltage of a step is at each terminal. In the dead time neither gate of a phase is on, and its
    current flows on through a diode, against its own sense. With all gates off, or without a supply, the
    currents end and the motor rolls. `resistance_mohm` is that of a transistor that conducts.
    """

    def __init__(self, component: BoardComponent, supply: Supply, *, resistance_mohm: float = 0.0) -> None:
        where = f"inverter at {component.configuration.path}"
        entity = component.configuration.entity
        if entity != "three_phase_pwm":
            raise ValueRangeError(f"{where}: {entity} does not drive an inverter; take a three_phase_pwm")
        self._pins, self.supply = component, supply
        self._ohm = check_number(where, "resistance_mohm", resistance_mohm, least=0.0) / 1000
        self._dead = 0.0  # the share of the time in which neither gate of a phase is on
        self._steps = 0

    def drive(self, motor: Brushless, seconds: float) -> None:
        """Let a motor run for a period of the plant, with what the pins did in the last one."""
        highs = [self._pins.duty("high", phase) for phase in range(PHASES)]
        supply_v = self.supply.volts
        if supply_v <= 0 or not (any(highs) or self._brakes()):
            motor.coast(supply_v, seconds)
            self.supply.take(self, 0.0, seconds)
            return
        self._measure_dead_time(highs[0])
        dead = self._dead
        volts = [
            supply_v * (high if amps > 0 or not 0 < high < 1 else min(1.0, high + dead))
            for high, amps in zip(highs, motor.currents_a, strict=True)
        ]
        joule = motor.step(volts, seconds, series_ohm=self._ohm)
        self.supply.take(self, joule / seconds / supply_v if seconds > 0 else 0.0, seconds)

    def _brakes(self) -> bool:
        """Are the low sides on, though no high side is? Otherwise all gates are off."""
        return any(self._pins.level("low", phase) for phase in range(PHASES))

    def _measure_dead_time(self, high: float) -> None:
        """Measure it at the first phase, which must have edges."""
        self._steps += 1
        if self._steps % _LOOKS < 2:  # the first look is the start of what the second one measures
            low = self._pins.duty("low", 0)
            if self._steps % _LOOKS == 1 and 0 < high < 1:
                self._dead = max(0.0, 1.0 - high - low)
