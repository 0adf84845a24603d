# SPDX-License-Identifier: BSD-3-Clause
"""The axis behind the board: parts with the figures of their datasheets (docs/plants.md)."""

from __future__ import annotations

from dataclasses import replace

from unitylink.simulate import BoardValues, Registers
from unitylink.simulate.machine import (
    GEARS,
    MOTORS,
    Battery,
    Bridge,
    DcMotor,
    Encoder,
    EndSwitch,
    Measurement,
)
from unitylink.spec import Spec

RADIUS_M, CARRIAGE_KG, FRICTION_N = 0.02, 1.5, 2.0
HOME_M, LOW_M, HIGH_M = -0.1, -0.105, 0.5  # from where the carriage stands when the power comes


class Plant:
    period_s = 0.0005

    def __init__(self) -> None:
        self.battery = Battery(cells=3, capacity_mah=2200, internal_mohm=60)
        self.motor = DcMotor(
            MOTORS["Pololu 37D 12 V"],
            replace(GEARS["Pololu 37D 50:1"], backlash_deg=1.5),
            load_inertia_kg_m2=CARRIAGE_KG * RADIUS_M**2,
            load_friction_nm=FRICTION_N * RADIUS_M,
            stops_rad=(LOW_M / RADIUS_M, HIGH_M / RADIUS_M),
        )
        self.converter = Measurement(noise_rms=0.004, resolution=0.004, seed=1)

    def seed(self, number: int) -> None:
        self.converter.seed(number)

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        parts = registers.components
        self.bridge = Bridge(parts["motor"], self.battery, resistance_mohm=200)
        self.encoder = Encoder(parts["shaft"], pulses_per_turn=16)
        self.home = EndSwitch(parts["ends"], "pin_in", below=HOME_M, hysteresis=0.0005, bounce_ms=1.0)
        self.values = BoardValues(spec, registers)

    def step(self, time_s: float) -> None:
        self.bridge.drive(self.motor, self.period_s)
        self.encoder.show(self.motor.rotor_angle_rad, self.period_s)
        self.home.show(RADIUS_M * self.motor.angle_rad)
        self.values["battery"] = self.converter.of(self.battery.volts, time_s)
