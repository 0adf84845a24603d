# SPDX-License-Identifier: BSD-3-Clause
"""A DC motor with its gear, and with what it moves."""

from __future__ import annotations

import math

from unitylink.errors import ValueRangeError

from .checks import check_number
from .dc_motor_data import DcMotorData
from .gear import Gear
from .rotor import Circuit, Rotor, Shaft

_PART_S = 0.0002  # in a gear with play, contact is looked for so often
_MOST_PARTS = 1000
_AT_STOP = 1e-9  # rad: nearer is at it
_DIRECT = Gear()


class DcMotor:
    """A motor, its gear, and a load of some inertia. Angles and torques are at the output of the gear.

        motor = DcMotor(MOTORS["maxon RE 40"], Gear(ratio=43, backlash_deg=1), load_inertia_kg_m2=0.02)
        motor.load_nm = 0.3                    # pulls it back
        motor.step(12.0, seconds=0.001)        # 12 V for a millisecond
        motor.angle_rad, motor.speed_rad_s, motor.current_a

    `load_nm` may change between steps: weight, a spring, or what a tool needs. `stops_rad` are two angles
    beyond which the load cannot go. Raises ValueRangeError for what cannot be, by its name.
    """

    def __init__(
        self,
        data: DcMotorData,
        gear: Gear = _DIRECT,
        *,
        load_inertia_kg_m2: float = 0.0,
        load_friction_nm: float = 0.0,
        stops_rad: tuple[float, float] | None = None,
    ) -> None:
        what = f"motor {data.name}"
        self.data, self.gear = data, gear
        remedy = "a gear with backlash needs an inertia behind it" if gear.backlash_deg else ""
        check_number(what, "load_inertia_kg_m2", load_inertia_kg_m2, least=0.0)
        if gear.backlash_deg and load_inertia_kg_m2 <= 0:
            raise ValueRangeError(f"{what}: load_inertia_kg_m2 is 0; {remedy}")
        check_number(what, "load_friction_nm", load_friction_nm, least=0.0)
        if stops_rad is not None and not -math.inf < stops_rad[0] <= stops_rad[1] < math.inf:
            raise ValueRangeError(f"{what}: stops_rad is {stops_rad}; it must be two angles, the lower first")
        self._load_inertia, self._load_friction = load_inertia_kg_m2, load_friction_nm
        self._stops = stops_rad or (-math.inf, math.inf)
        self._own_inertia = data.inertia_kg_m2 + gear.inertia_kg_m2
        self._rotor = Rotor(data)
        self._gap = gear.backlash_rad / 2
        self._side = 0  # of the play at which the gear touches: 1 forward, -1 back, 0 neither
        self._speed = 0.0  # of the load, in a gear with play
        self.angle_rad = min(max(0.0, self._stops[0]), self._stops[1])
        self._rotor.angle = self.angle_rad * gear.ratio
        self.load_nm = 0.0

    @property
    def current_a(self) -> float:
        return self._rotor.current_a

    @property
    def speed_rad_s(self) -> float:
        """The speed of the load."""
        return self._speed if self._gap else self._rotor.speed / self.gear.ratio

    @property
    def rotor_angle_rad(self) -> float:
        """The angle before the gear, where many encoders are."""
        return self._rotor.angle

    @property
    def rotor_speed_rad_s(self) -> float:
        return self._rotor.speed

    @property
    def torque_nm(self) -> float:
        """The torque of the winding, at the output, without what friction takes."""
        return self.data.constant * self.current_a * self.gear.ratio

    def step(
        self,
        volts: float | None,
        seconds: float,
        *,
        series_ohm: float = 0.0,
        supply_v: float = 0.0,
    ) -> None:
        """Let it run for some time at a voltage. Without one (None) its wires are open, and it coasts.

        `series_ohm` is in its circuit, too: the bridge, the wires, the battery. If the wires open while a
        current flows, it flows on into a supply of `supply_v`, through the diodes of the bridge.
        """
        what = f"motor {self.data.name}"
        if volts is not None:
            volts = check_number(what, "volts", volts, remedy="look at what the plant computes")
        seconds = check_number(what, "seconds", seconds, least=0.0)
        series_ohm = check_number(what, "series_ohm", series_ohm, least=0.0)
        supply_v = check_number(what, "supply_v", supply_v, least=0.0)
        check_number(what, "load_nm", self.load_nm, remedy="look at what the plant computes")
        circuit = Circuit(volts, self.data.resistance_ohm + series_ohm, supply_v)
        if not self._gap:
            self._turn_both(seconds, circuit)
            self._follow()
            return
        parts = min(max(1, math.ceil(seconds / _PART_S)), _MOST_PARTS)
        for _ in range(parts):
            self._step_with_play(seconds / parts, circuit)

    # ---- motor and load together

    def _turn_both(self, seconds: float, circuit: Circuit) -> None:
        ratio = self.gear.ratio
        inertia = self._own_inertia + self._load_inertia / ratio**2
        self._rotor.turn(seconds, circuit, Shaft(inertia, self._against(1), self._against(-1)))

    def _against(self, direction: int) -> float:
        """Return the torque at the motor that turns the load in a direction, against all friction."""
        if self._is_at_stop(direction):
            return direction * math.inf
        needed = self.load_nm + direction * self._load_friction
        gear = self.gear
        # what the load gives the motor comes through the gear the other way
        lossy = needed / gear.efficiency if needed * direction > 0 else needed * gear.efficiency
        return lossy / gear.ratio + direction * self.data.friction_nm

    def _is_at_stop(self, direction: int) -> bool:
        return direction * (self._stops[direction > 0] - self.angle_rad) <= _AT_STOP

    def _follow(self) -> None:
        """Put the load where the motor is, or both at a stop."""
        self.angle_rad = self._rotor.angle / self.gear.ratio
        stopped = min(max(self.angle_rad, self._stops[0]), self._stops[1])
        if stopped != self.angle_rad:
            self.angle_rad = stopped
            self._rotor.angle, self._rotor.speed = stopped * self.gear.ratio, 0.0

    # ---- apart, in a gear with play

    def _step_with_play(self, seconds: float, circuit: Circuit) -> None:
        if self._side:
            self._push(seconds, circuit)
        else:
            friction = self.data.friction_nm
            self._rotor.turn(seconds, circuit, Shaft(self._own_inertia, friction, -friction))
            self._roll(seconds)
        off = self._rotor.angle / self.gear.ratio - self.angle_rad
        if abs(off) < self._gap or self._side:
            return
        side = 1 if off > 0 else -1
        self._meet(side)

    def _push(self, seconds: float, circuit: Circuit) -> None:
        """Move together. If the gear would have to pull, it lets go."""
        before, ratio, side = self._rotor.speed, self.gear.ratio, self._side
        self._turn_both(seconds, circuit)
        self.angle_rad = self._rotor.angle / ratio - side * self._gap
        stopped = min(max(self.angle_rad, self._stops[0]), self._stops[1])
        if stopped != self.angle_rad:
            self.angle_rad = stopped
            self._rotor.angle, self._rotor.speed = (stopped + side * self._gap) * ratio, 0.0
        self._speed = self._rotor.speed / ratio
        gained = (self._rotor.speed - before) / ratio / seconds if seconds > 0 else 0.0
        resisting = self.load_nm + math.copysign(self._load_friction, self._speed or side)
        if not self._is_at_stop(side) and side * (self._load_inertia * gained + resisting) < 0:
            self._side = 0

    def _roll(self, seconds: float) -> None:
        """Move the load by what pulls at it alone."""
        pulled, friction, left = -self.load_nm, self._load_friction, seconds
        for _ in range(2):  # it may stop, and go back
            direction = math.copysign(1.0, self._speed or pulled)
            if self._speed == 0 and abs(pulled) <= friction:
                return
            gain = (pulled - direction * friction) / self._load_inertia
            stops = -self._speed / gain if gain * self._speed < 0 else math.inf
            passed = min(left, stops)
            self.angle_rad += self._speed * passed + gain * passed * passed / 2
            self._speed = 0.0 if passed == stops else self._speed + gain * passed
            left -= passed
            if left <= 0:
                break
        stopped = min(max(self.angle_rad, self._stops[0]), self._stops[1])
        if stopped != self.angle_rad:
            self.angle_rad, self._speed = stopped, 0.0

    def _meet(self, side: int) -> None:
        """Let motor and load meet, without a bounce, at the side of the play where they are."""
        ratio = self.gear.ratio
        load = self._load_inertia / ratio**2
        at = self._rotor.angle / ratio - side * self._gap
        self.angle_rad = min(max(at, self._stops[0]), self._stops[1])
        self._rotor.angle = (self.angle_rad + side * self._gap) * ratio
        # apart again at once, if the load is already faster
        if side * (self._rotor.speed - self._speed * ratio) < 0:
            return
        both = self._own_inertia * self._rotor.speed + load * self._speed * ratio
        self._rotor.speed = both / (self._own_inertia + load)
        self._speed = self._rotor.speed / ratio
        self._side = side
