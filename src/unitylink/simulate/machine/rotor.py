# SPDX-License-Identifier: BSD-3-Clause
"""The winding and the rotor of a DC motor, with friction that holds it at a standstill."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from .dc_motor_data import DcMotorData
from .linear_pair import LinearPair

_MOST_EVENTS = 1000  # starts, stops and turns back in one step
_KEPT = 64


class Circuit(NamedTuple):
    """What is at the winding in a step. Without `volts` it is open, and its current flows into the supply
    through diodes until it has ended. A `supply_v` of 0 is no supply."""

    volts: float | None
    ohm: float
    supply_v: float = 0.0


class Shaft(NamedTuple):
    """What the rotor moves in a step: its torque must be above `forward_nm` to turn it forward, and below
    `backward_nm` to turn it back. In between it holds."""

    inertia_kg_m2: float
    forward_nm: float
    backward_nm: float

    def against(self, direction: float) -> float:
        return self.forward_nm if direction > 0 else self.backward_nm


class Rotor:
    """Current, speed and angle. A step is the exact solution from event to event: a stop, a start, the end of
    a current. So it is right for each length of a step, also if the winding is much quicker than that.
    """

    def __init__(self, data: DcMotorData) -> None:
        self._constant, self._damping = data.constant, data.damping_nm_s
        self._inductance = data.inductance_h
        self._pairs: dict[tuple[float, float], LinearPair] = {}
        self.current_a = self.speed = self.angle = 0.0  # A, rad/s, rad

    def turn(self, seconds: float, circuit: Circuit, shaft: Shaft) -> None:
        """Let some time pass."""
        left, leaving, refused = seconds, 0.0, 0
        for _ in range(_MOST_EVENTS):
            if left <= 0:
                return
            volts = self._volts(circuit)
            direction = leaving or _sign(self.speed) or self._pushed(shaft)
            if direction and not math.isfinite(shaft.against(direction)):
                direction = self.speed = 0.0  # a stop is in the way
            if direction and refused < 2:
                passed = self._moving(left, direction, volts, circuit, shaft)
                # it does not move that way, not even for a rounding: so it moves the other way, or stands
                refused = refused + 1 if passed == 0 else 0
                leaving = -direction if refused else 0.0
            else:
                firm = Shaft(shaft.inertia_kg_m2, math.inf, -math.inf) if refused else shaft
                passed, leaving = self._held(left, volts, circuit, firm)
                refused = 0
            left -= passed
        self.speed = 0.0  # it trembles: there is no shorter way to say what it does

    def _volts(self, circuit: Circuit) -> float | None:
        """Return the voltage at the winding, or None if no current flows."""
        if circuit.volts is not None:
            return circuit.volts
        back_v = self._constant * self.speed
        if circuit.supply_v <= 0 or (self.current_a == 0 and abs(back_v) <= circuit.supply_v):
            self.current_a = 0.0
            return None
        return math.copysign(circuit.supply_v, -self.current_a if self.current_a else back_v)

    def _pushed(self, shaft: Shaft) -> float:
        torque = self._constant * self.current_a
        return float(torque > shaft.forward_nm) - float(torque < shaft.backward_nm)

    def _moving(
        self, seconds: float, direction: float, volts: float | None, circuit: Circuit, shaft: Shaft
    ) -> float:
        """Move for `seconds`, or until the next event. Return how long."""
        against = shaft.against(direction)
        if volts is None:
            return self._rolling(seconds, against, shaft.inertia_kg_m2)
        pair = self._pair(circuit.ohm, shaft.inertia_kg_m2)
        inductance, current, speed = self._inductance(circuit.ohm), self.current_a, self.speed
        given = volts / inductance, -against / shaft.inertia_kg_m2

        def after(passed: float) -> tuple[float, float, float]:
            return pair.step(current, speed, *given, passed, keep=False)

        end_a, end_speed, way = pair.step(current, speed, *given, seconds)
        until = seconds
        if end_speed * direction < 0:
            until = _zero(lambda passed: after(passed)[1] * direction, until, starts_at_zero=speed == 0)
        if until == 0:
            return 0.0
        ends = circuit.volts is None and current != 0 and end_a * current < 0
        if ends:
            if after(until)[0] * current < 0:
                until = _zero(lambda passed: after(passed)[0] * current, until)
            else:
                ends = False
        if until < seconds:
            end_a, end_speed, way = after(until)
            if ends:
                end_a = 0.0
            else:
                end_speed = 0.0
        self.current_a, self.speed = end_a, end_speed
        self.angle += way
        return until

    def _rolling(self, seconds: float, against: float, inertia: float) -> float:
        """Move without a current."""
        pull, rate, speed = -against / inertia, self._damping / inertia, self.speed
        stops = math.inf
        if pull * _sign(speed or pull) < 0:
            damped = -speed * rate / pull
            stops = math.log1p(damped) / rate if damped > 1e-12 else -speed / pull
        passed = min(seconds, stops)
        fallen = rate * passed
        if fallen > 1e-4:
            once = -math.expm1(-fallen) / rate
            twice = (passed - once) / rate
        else:
            once = passed * (1 - fallen / 2 + fallen * fallen / 6)
            twice = passed * passed * (1 / 2 - fallen / 6 + fallen * fallen / 24)
        self.angle += speed * once + pull * twice
        self.speed = speed * math.exp(-fallen) + pull * once
        if passed >= stops:
            self.speed = 0.0
        return passed

    def _held(
        self, seconds: float, volts: float | None, circuit: Circuit, shaft: Shaft
    ) -> tuple[float, float]:
        """Stand for `seconds`, or until the current has enough torque. Return how long, and where it goes."""
        if volts is None:
            return seconds, 0.0
        time_s, rest_a = self._inductance(circuit.ohm) / circuit.ohm, volts / circuit.ohm
        start_a = self.current_a

        def reaches(amps: float) -> float:
            """Return when the current passes `amps` on its way from its start to its rest."""
            share = (amps - rest_a) / (start_a - rest_a) if start_a != rest_a else 2.0
            return -time_s * math.log(share) if 0 < share <= 1 else math.inf

        events: list[tuple[float, float, float | None]] = [(seconds, 0.0, None)]
        for direction, needed in ((1.0, shaft.forward_nm), (-1.0, shaft.backward_nm)):
            beyond = direction * (self._constant * rest_a - needed) > 0
            if math.isfinite(needed) and beyond:
                events.append((reaches(needed / self._constant), direction, needed / self._constant))
        if circuit.volts is None and start_a * rest_a < 0:
            events.append((reaches(0.0), 0.0, 0.0))
        passed, direction, exact = min(events, key=lambda event: event[0])
        self.current_a = rest_a + (start_a - rest_a) * math.exp(-passed / time_s) if exact is None else exact
        return passed, direction

    def _pair(self, ohm: float, inertia: float) -> LinearPair:
        pair = self._pairs.get((ohm, inertia))
        if pair is None:
            if len(self._pairs) >= _KEPT:
                self._pairs.clear()
            inductance = self._inductance(ohm)
            pair = self._pairs[ohm, inertia] = LinearPair(
                -ohm / inductance,
                -self._constant / inductance,
                self._constant / inertia,
                -self._damping / inertia,
            )
        return pair


def _sign(number: float) -> float:
    return math.copysign(1.0, number) if number else 0.0


def _zero(of: Callable[[float], float], end: float, *, starts_at_zero: bool = False) -> float:
    """Return when a function that begins above 0 and is below 0 at `end` passes 0.

    One that begins at 0 may not have been above it at all. Then this is 0.
    """
    low, high = 0.0, end
    if starts_at_zero:
        low = end
        for _ in range(30):
            low /= 4
            if of(low) > 0:
                break
            high = low
        else:
            return 0.0
    at_low, at_high = of(low), of(high)
    side = 0
    near = 1e-13 * max(at_low, -at_high)
    for _ in range(60):  # Illinois: a secant whose ends cannot stay
        if high - low <= 1e-14 * end:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        at = of(middle)
        if abs(at) <= near:
            return middle
        if at > 0:
            low, at_low = middle, at
            at_high = at_high / 2 if side == 1 else at_high
            side = 1
        else:
            high, at_high = middle, at
            at_low = at_low / 2 if side == -1 else at_low
            side = -1
    return high
