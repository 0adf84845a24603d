# SPDX-License-Identifier: BSD-3-Clause
"""The joint behind the board: a brushless motor with its windings, an arm, friction and gravity."""

from __future__ import annotations

import math

from unitylink.simulate import Registers
from unitylink.spec import Spec

PERIOD_S = 50e-6  # a period of the PWM
DEAD = 2 * 300e-9 / PERIOD_S  # the share of the time in which neither gate of a phase is on
SUPPLY_V, OHM, HENRY = 24.0, 0.2, 200e-6  # of a phase
POLE_PAIRS, NM_A_AMPERE = 7, 0.05
INERTIA = 2e-3  # kg m^2, with the arm
WEIGHT_NM = 0.2  # of the arm, when it is level
FRICTION_NM, DAMPING_NM_S = 0.02, 1e-3
FULL_SCALE_A = 32.0
COUNTS_A_RAD = 4096 / (2 * math.pi)
ROOT_3 = math.sqrt(3.0)
BEGINS_AT = 0.05  # rad


class Plant:
    """A motor whose currents are those along alpha and beta. The arm hangs down at 0 rad."""

    period_s = PERIOD_S

    def __init__(self) -> None:
        self.alpha = self.beta = 0.0  # A
        self.at, self.speed = BEGINS_AT, 0.0  # rad, rad/s
        self.torque = 0.0  # N m, of the motor
        self.is_stopped = False  # somebody presses the button

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        parts = registers.components
        self.stop, self.bridge, self.current = parts["stop"], parts["motor"], parts["current"]
        self.shaft = parts["shaft"]
        self.cut = self.pressed = None
        self.steps = 0
        self.tell()
        self.obey()

    def step(self, time_s: float) -> None:
        """Move on by a period, with the mean voltages of the last one."""
        highs = [self.bridge.duty("high", phase) for phase in range(3)]
        if any(highs):
            self.drive(highs)
        else:
            self.alpha = self.beta = 0.0  # all gates are off: the diodes end the currents within this period
        self.move()
        self.tell()
        self.steps += 1
        if self.steps % 10 == 0:
            self.obey()

    def drive(self, highs: list[float]) -> None:
        """Change the currents. In the dead time a current flows on through a diode, against its own sense."""
        half = ROOT_3 / 2 * self.beta
        currents = self.alpha, half - self.alpha / 2, -half - self.alpha / 2
        volts = [
            SUPPLY_V * (high if current > 0 else high + DEAD)
            for high, current in zip(highs, currents, strict=True)
        ]
        alpha_v = (2 * volts[0] - volts[1] - volts[2]) / 3
        beta_v = (volts[1] - volts[2]) / ROOT_3
        angle = POLE_PAIRS * self.at
        back_v = NM_A_AMPERE / 1.5 * self.speed
        kept = math.exp(-OHM / HENRY * PERIOD_S)
        end_alpha = (alpha_v + back_v * math.sin(angle)) / OHM
        end_beta = (beta_v - back_v * math.cos(angle)) / OHM
        self.alpha = end_alpha + kept * (self.alpha - end_alpha)
        self.beta = end_beta + kept * (self.beta - end_beta)

    def move(self) -> None:
        angle = POLE_PAIRS * self.at
        self.torque = NM_A_AMPERE * (self.beta * math.cos(angle) - self.alpha * math.sin(angle))
        given = self.torque - WEIGHT_NM * math.sin(self.at) - DAMPING_NM_S * self.speed
        if self.speed == 0.0 and abs(given) <= FRICTION_NM:
            return  # it sticks
        given -= math.copysign(FRICTION_NM, self.speed or given)
        before, self.speed = self.speed, self.speed + given / INERTIA * PERIOD_S
        if before * self.speed < 0:
            self.speed = 0.0  # friction stops it, and does not turn it round
        self.at += self.speed * PERIOD_S

    def tell(self) -> None:
        """Show what the sensors measure."""
        phase_b = ROOT_3 / 2 * self.beta - self.alpha / 2
        self.current.modulate(self.alpha / FULL_SCALE_A, PERIOD_S, channel=0)
        self.current.modulate(phase_b / FULL_SCALE_A, PERIOD_S, channel=1)
        self.shaft.turn((self.at - BEGINS_AT) * COUNTS_A_RAD, PERIOD_S)

    def obey(self) -> None:
        """Lead the button to the chain, and what the chain says to the fault input of the bridge."""
        if self.is_stopped is not self.pressed:
            self.pressed = self.is_stopped
            self.stop.drive("chain", not self.pressed)
        cut = not self.stop.level("run")
        if cut is not self.cut:
            self.cut = cut
            self.bridge.drive("fault", cut)
