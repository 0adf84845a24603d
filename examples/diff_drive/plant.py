# SPDX-License-Identifier: BSD-3-Clause
"""The cart on the floor: two DC motors, a mass that rolls and turns, a battery, and what its sensors say."""

from __future__ import annotations

import math
import struct

from unitylink.simulate import Registers
from unitylink.spec import Spec

PERIOD_S = 0.002
RADIUS_M, TRACK_M = 0.04, 0.24
SLIP = 1.03  # its tyres are wide: it turns as if its wheels were so much further apart
COUNTS_A_TURN = 2048
MASS_KG, INERTIA = 4.0, 0.05  # kg, kg m^2, with the wheels
VOLTS, CELL_OHM = 12.4, 0.12  # of the battery at rest, and inside it
MOTOR_V_S, MOTOR_OHM = 0.55, 2.5  # volts for each rad/s of a wheel (and N m for each A), and its winding
FRICTION_NM = 0.06  # of a wheel with its gear
BIAS_DEG_S = 0.6  # of the gyroscope
ICM_IDENTITY, ICM_FIRST = 0x75, 0x1D


class Motor:
    """A motor with its wheel. `angle` is in rad, `speed` in rad/s, `current` in A."""

    def __init__(self) -> None:
        self.angle = self.speed = self.current = 0.0

    def torque(self, share: float, open_circuit: bool, volts: float) -> float:
        """Return the torque of the wheel on the cart, in N m. `share` of the time it is driven, -1 to 1."""
        drive_v = share * volts - MOTOR_V_S * self.speed
        self.current = 0.0 if open_circuit else drive_v / MOTOR_OHM
        given = MOTOR_V_S * self.current
        if abs(self.speed) < 0.05 and abs(given) < FRICTION_NM:
            return -self.speed * FRICTION_NM / 0.05  # it sticks
        return given - math.copysign(FRICTION_NM, self.speed or given)


class Plant:
    period_s = PERIOD_S

    def __init__(self) -> None:
        self.x_m = self.y_m = self.heading = self.speed = self.turn = 0.0
        self.motors = Motor(), Motor()
        self.volts = VOLTS

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        parts = registers.components
        self.bridges = parts["left_motor"], parts["right_motor"]
        self.wheels = parts["left_wheel"], parts["right_wheel"]
        self.imu, self.converter = parts["imu"].device, parts["battery"].device
        self.imu[ICM_IDENTITY] = 0x47
        self.tell(0.0)

    def step(self, time_s: float) -> None:
        """Roll and turn for a period."""
        torques = []
        for motor, bridge in zip(self.motors, self.bridges, strict=True):
            first, second = bridge.duty("pins", 0), bridge.duty("pins", 1)
            is_open = first == second == 0.0  # both inputs low: the motor coasts
            torques.append(motor.torque(first - second, is_open, self.volts))
        left, right = torques
        pull = (left + right) / RADIUS_M / MASS_KG
        self.turn += (right - left) * TRACK_M / (2 * RADIUS_M) / INERTIA * PERIOD_S
        self.speed += pull * PERIOD_S
        self.heading += self.turn * PERIOD_S
        self.x_m += self.speed * math.cos(self.heading) * PERIOD_S
        self.y_m += self.speed * math.sin(self.heading) * PERIOD_S
        for motor, wheel, side in zip(self.motors, self.wheels, (-1, 1), strict=True):
            motor.speed = (self.speed + side * self.turn * SLIP * TRACK_M / 2) / RADIUS_M
            motor.angle += motor.speed * PERIOD_S
            wheel.turn(motor.angle * COUNTS_A_TURN / (2 * math.pi), PERIOD_S)
        self.volts = VOLTS - CELL_OHM * sum(abs(motor.current) for motor in self.motors)
        self.tell(pull)

    def tell(self, pull: float) -> None:
        """Put what the sensors measure into their registers: temperature, acceleration, rate of turn."""
        counts_a_g, counts_a_deg_s = 2048, 32768 / 2000
        sideways = self.speed * self.turn
        pulls = (round(one / 9.80665 * counts_a_g) for one in (pull, sideways, 9.80665))
        turns = (0, 0, round((math.degrees(self.turn) + BIAS_DEG_S) * counts_a_deg_s))
        words = [0, *pulls, *turns]
        sample = struct.pack(">7h", *(min(max(word, -32768), 32767) for word in words))
        self.imu[ICM_FIRST : ICM_FIRST + 14] = sample
        self.converter[0x10:0x12] = round(self.volts * 1000).to_bytes(2, "big")
