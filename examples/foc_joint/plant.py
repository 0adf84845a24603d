# SPDX-License-Identifier: BSD-3-Clause
"""The joint behind the board: a brushless motor with its windings, an arm, friction and gravity."""

from __future__ import annotations

import math

from unitylink.simulate import Registers
from unitylink.simulate.machine import Brushless, BrushlessData, Inverter, Supply
from unitylink.spec import Spec

MOTOR = BrushlessData(
    "of the joint",
    pole_pairs=7,
    resistance_ohm=0.2,
    inductance_mh=0.2,
    flux_mwb=0.05 / 1.5 / 7 * 1000,  # 0.05 N m for each A
    rotor_inertia_g_cm2=1000.0,
)
ARM_KG_M2, FRICTION_NM, DAMPING_NM_S = 1.9e-3, 0.02, 1e-3
WEIGHT_NM = 0.2  # of the arm, when it is level
SUPPLY_V, FULL_SCALE_A = 24.0, 32.0
COUNTS_A_RAD = 4096 / (2 * math.pi)
BEGINS_AT = 0.05  # rad


class Plant:
    """The arm hangs down at 0 rad. A step is a period of the PWM."""

    period_s = 50e-6

    def __init__(self) -> None:
        self.motor = Brushless(
            MOTOR,
            load_inertia_kg_m2=ARM_KG_M2,
            load_friction_nm=FRICTION_NM,
            load_damping_nm_s=DAMPING_NM_S,
            angle_rad=BEGINS_AT,
        )
        self.is_stopped = False  # somebody presses the button

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        parts = registers.components
        self.inverter = Inverter(parts["motor"], Supply(SUPPLY_V))
        self.stop, self.bridge, self.current = parts["stop"], parts["motor"], parts["current"]
        self.shaft = parts["shaft"]
        self.cut = self.pressed = None
        self.steps = 0
        self.tell()
        self.obey()

    def step(self, time_s: float) -> None:
        """Move on by a period, with what the gates did in the last one."""
        self.motor.load_nm = WEIGHT_NM * math.sin(self.motor.angle_rad)
        self.inverter.drive(self.motor, self.period_s)
        self.tell()
        self.steps += 1
        if self.steps % 10 == 0:
            self.obey()

    def tell(self) -> None:
        """Show what the sensors measure."""
        first, second, _ = self.motor.currents_a
        self.current.modulate(first / FULL_SCALE_A, self.period_s, channel=0)
        self.current.modulate(second / FULL_SCALE_A, self.period_s, channel=1)
        self.shaft.turn((self.motor.angle_rad - BEGINS_AT) * COUNTS_A_RAD, self.period_s)

    def obey(self) -> None:
        """Lead the button to the chain, and what the chain says to the fault input of the bridge."""
        if self.is_stopped is not self.pressed:
            self.pressed = self.is_stopped
            self.stop.drive("chain", not self.pressed)
        cut = not self.stop.level("run")
        if cut is not self.cut:
            self.cut = cut
            self.bridge.drive("fault", cut)
