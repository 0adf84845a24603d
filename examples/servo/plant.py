# SPDX-License-Identifier: BSD-3-Clause
"""The machine on which the board would be mounted: servo 0 turns the wheel, and at either end the limit
switch closes.
"""

from __future__ import annotations

from unitylink.simulate import Registers
from unitylink.spec import Spec

CENTRE_US = 1500
STEP_US = 1  # the servo follows no smaller change of its pulse. The board's pulses are exact to 0.05 %
COUNTS_A_US = 2  # counts of the wheel for each microsecond of pulse away from the centre
SPEED = 4000.0  # counts a second
LIMIT = 1600  # counts


class Plant:
    period_s = 0.001

    def __init__(self) -> None:
        self.position = self.goal = 0.0
        self.trips = 0
        self.at_limit = False

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the words by their names."""
        assert spec is not None
        self.registers = registers
        self.servo, self.wheel = registers.components["drive"], registers.components["wheel"]
        self.address = {path: element.address for path, element in spec.walk()}
        self.events = {group.event: group.number for device in spec.devices for group in device.groups}

    def step(self, time_s: float) -> None:
        """Let the wheel follow its servo for a millisecond."""
        words, at = self.registers, self.address
        pulse_s = self.servo.pulse_s("pins", 0)
        if pulse_s is not None:  # one comes every 20 ms, and none when the servo is limp
            pulse_us = STEP_US * round(pulse_s * 1e6 / STEP_US)
            self.goal = (pulse_us - CENTRE_US) * COUNTS_A_US
        most = SPEED * self.period_s
        self.position += min(max(self.goal - self.position, -most), most)
        self.wheel.turn(round(self.position), self.period_s)
        at_limit = abs(self.position) >= LIMIT
        tripped, self.at_limit = at_limit and not self.at_limit, at_limit
        self.trips += tripped
        words[at["trips"]] = self.trips
        words[at["uptime_ms"]] = round(time_s * 1000)
        if tripped:
            words.event(self.events["limit"])  # servo_board.vhd has a line of this name that does the same
