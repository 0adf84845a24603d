# SPDX-License-Identifier: BSD-3-Clause
"""A servo of model making: its pulse says where it goes."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.errors import ValueRangeError

from ..components import BoardComponent
from .checks import check_number, check_positive

_NM_A_KG_CM = 0.0980665


@dataclass(frozen=True)
class RcServoData:
    """What is on the packet of a servo, at the voltage that it gets.

    A pulse of `centre_us` is 0 degrees, and `us_per_deg` more of it is a degree more. `settling_ms` is the
    time constant of its loop, and with that how far a load pushes it away. A pulse that differs by less than
    `dead_band_us` moves nothing.
    """

    name: str
    seconds_per_60_deg: float
    stall_torque_kg_cm: float
    centre_us: float = 1500.0
    us_per_deg: float = 10.0
    reach_deg: float = 90.0
    dead_band_us: float = 5.0
    settling_ms: float = 20.0
    source: str = ""
    estimated: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        what = f"servo {self.name}"
        for name in (
            "seconds_per_60_deg",
            "stall_torque_kg_cm",
            "centre_us",
            "reach_deg",
            "settling_ms",
        ):
            check_positive(what, name, getattr(self, name))
        check_number(what, "dead_band_us", self.dead_band_us, least=0.0)
        if check_number(what, "us_per_deg", self.us_per_deg) == 0:
            raise ValueRangeError(f"{what}: us_per_deg is 0; 10 is usual, and below 0 it turns the other way")


class RcServo:
    """Turns to where the pulses of a `pwm` or of an `rc_servo` say.

        servo = RcServo(SERVOS["Hitec HS-311"], registers.components["arm"], channel=0)
        servo.load_nm = 0.05           # pulls it back
        servo.step(self.period_s)      # in each step
        servo.angle_rad

    Without pulses its motor is off, and the friction of its gear holds it.
    """

    def __init__(self, data: RcServoData, component: BoardComponent, channel: int = 0) -> None:
        self.data = data
        self._pins, self._channel = component, channel
        component.level("pins", channel)  # is there such a pin?
        self._speed = math.radians(60.0) / data.seconds_per_60_deg
        self._stall_nm = data.stall_torque_kg_cm * _NM_A_KG_CM
        self.angle_rad = 0.0
        self.load_nm = 0.0
        self._pulse_us: float | None = None
        self._silent_s = 0.0

    @property
    def is_driven(self) -> bool:
        """Whether pulses have come in the last 50 ms."""
        return self._pulse_us is not None

    def step(self, seconds: float) -> None:
        """Let some time pass."""
        what = f"servo {self.data.name}"
        check_number(what, "seconds", seconds, least=0.0)
        check_number(what, "load_nm", self.load_nm, remedy="look at what the plant computes")
        pulse_s = self._pins.pulse_s("pins", self._channel)
        if pulse_s is None:
            self._silent_s += seconds
            if self._silent_s > 0.05:
                self._pulse_us = None
        else:
            self._silent_s = 0.0
            if self._pulse_us is None or abs(pulse_s * 1e6 - self._pulse_us) >= self.data.dead_band_us:
                self._pulse_us = pulse_s * 1e6
        if self._pulse_us is None:
            return
        reach = math.radians(self.data.reach_deg)
        goal = math.radians((self._pulse_us - self.data.centre_us) / self.data.us_per_deg)
        self._move(min(max(goal, -reach), reach), seconds)
        self.angle_rad = min(max(self.angle_rad, -reach), reach)

    def _move(self, goal: float, seconds: float) -> None:
        """Go at the speed that the load leaves, and settle. Both are exact."""
        settling_s = self.data.settling_ms / 1000
        near = self._speed * settling_s  # within it the motor gets less than all
        load = self.load_nm / self._stall_nm
        error, left = goal - self.angle_rad, seconds
        if abs(error) > near:
            speed = self._speed * (math.copysign(1.0, error) - load)
            closing = speed * error > 0
            full_s = (abs(error) - near) / abs(speed) if closing else math.inf
            passed = min(left, full_s)
            error -= speed * passed
            left -= passed
        if left > 0:
            # 1.0: a load above the stall torque pushes it back from here, and then at its own speed
            rest = load * near
            if abs(load) <= 1.0:
                error = rest + (error - rest) * math.exp(-left / settling_s)
            else:
                error += self._speed * load * left - math.copysign(self._speed, load) * left
        self.angle_rad = goal - error
