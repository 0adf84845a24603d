# SPDX-License-Identifier: BSD-3-Clause
"""The transistors between the pins of the FPGA, a supply and a DC motor."""

from __future__ import annotations

from typing import Any, Union

from unitylink.errors import ValueRangeError

from ..components import BoardComponent
from .checks import check_number, check_whole
from .dc_motor import DcMotor
from .supply import Supply
from .turned_motor import TurnedMotor

AnyMotor = Union[DcMotor, TurnedMotor]
_DEAD = 0.1  # of the time no gate is on: as much may be dead time, in which the current hardly changes
_MOST_PERIODS = 50


class Bridge:
    """Drives a motor as the pins of an `h_bridge` or of a `pwm` say.

        bridge = Bridge(registers.components["drive"], Supply(12.0))
        bridge.drive(motor, self.period_s)  # in each step

    An `h_bridge` says by its `form` what its pins are. Of a `pwm`, `channels` are the inputs IN1 and IN2 of a
    chip, or the one gate of a switch to ground with a diode at the motor. `resistance_mohm` is that of the
    transistors that conduct. If the supply is off, the motor coasts.

    With both sides off in the rest of each period, current ends in the diodes. Then each period is computed.
    """

    def __init__(
        self,
        component: BoardComponent,
        supply: Supply,
        *,
        resistance_mohm: float = 0.0,
        channels: tuple[int, ...] = (0, 1),
    ) -> None:
        self._pins, self.supply = component, supply
        where = f"bridge at {component.configuration.path}"
        self._ohm = check_number(where, "resistance_mohm", resistance_mohm, least=0.0) / 1000
        facts: dict[str, Any] = dict(component.configuration.generics)
        entity = component.configuration.entity
        if entity == "h_bridge":
            self._form = int(facts["form"])
            self._channels: tuple[int, ...] = (0, 1)
        elif entity == "pwm":
            if not 1 <= len(channels) <= 2:
                raise ValueRangeError(f"{where}: channels is {channels}; give one, or IN1 and IN2")
            for channel in channels:
                check_whole(where, "channels", channel, least=0)
            self._form, self._channels = 1 if len(channels) == 2 else 3, channels
        else:
            raise ValueRangeError(f"{where}: {entity} does not drive a bridge; take an h_bridge or a pwm")
        self._frequency_hz = float(facts["frequency_hz"])

    def drive(self, motor: AnyMotor, seconds: float) -> None:
        """Let a motor run for a period of the plant, with what the pins did in the last one."""
        share, idle = self.seen()
        supply = self.supply
        before_a = motor.current_a
        if not supply.is_on or idle >= 1.0:
            motor.step(None, seconds, series_ohm=self._ohm, supply_v=supply.volts)
        elif idle <= _DEAD:
            self._drive(motor, share, seconds)
        else:
            self._pulse(motor, share, idle, seconds)
            return
        supply.take(self, share * (before_a + motor.current_a) / 2, seconds)

    def _drive(self, motor: AnyMotor, share: float, seconds: float) -> None:
        """Use the mean voltage. The supply's own resistance is in the circuit, so it cannot ring."""
        ohm = self._ohm + share * share * self.supply.ohm
        motor.step(share * self.supply.without(self), seconds, series_ohm=ohm)

    def _pulse(self, motor: AnyMotor, share: float, idle: float, seconds: float) -> None:
        """Compute each period: driven, then idle. What is left is braked."""
        periods = min(max(1, round(seconds * self._frequency_hz)), _MOST_PERIODS)
        one_s, charge = seconds / periods, 0.0
        driven = min(1.0, max(1.0 - idle, abs(share)))
        within = share / driven if driven else 0.0
        for _ in range(periods):
            before_a = motor.current_a
            self._drive(motor, within, driven * one_s)
            charge += within * (before_a + motor.current_a) / 2 * driven * one_s
            before_a = motor.current_a
            motor.step(None, (1 - driven) * one_s, series_ohm=self._ohm, supply_v=self.supply.volts)
            charge -= abs(before_a) / 2 * (1 - driven) * one_s if motor.current_a == 0 else 0.0
        self.supply.take(self, charge / seconds if seconds > 0 else 0.0, seconds)

    def seen(self) -> tuple[float, float]:
        """Return the share of the time in which it drives, with its sign, and that in which no gate is on."""
        duty = self._pins.duty
        if self._form == 0:
            high_a, low_a, high_b, low_b = (duty("pins", pin) for pin in range(4))
            return high_a - high_b, 1.0 - max(high_a + low_a, high_b + low_b)
        if self._form == 2:
            forward, enabled = duty("pins", 0), duty("pins", 1)
            return (2 * forward - 1) * enabled, 0.0  # such chips brake while EN is low
        if self._form == 3:
            share = duty("pins", self._channels[0])
            return share, 0.0 if share else 1.0
        first, second = (duty("pins", channel) for channel in self._channels)
        return first - second, 1.0 - max(first, second)
