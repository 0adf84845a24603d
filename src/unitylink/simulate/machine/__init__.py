# SPDX-License-Identifier: BSD-3-Clause
"""Parts of machines for plants, in the units of their datasheets. See docs/plants.md."""

from __future__ import annotations

from .battery import Battery
from .bridge import Bridge
from .brushless import Brushless
from .brushless_data import BrushlessData
from .catalogue import BRUSHLESS, GEARS, MOTORS, SERVOS, STEPPERS
from .dc_motor import DcMotor
from .dc_motor_data import DcMotorData
from .encoder import Encoder
from .end_switch import EndSwitch
from .gear import Gear
from .hall_sensors import HallSensors
from .inverter import Inverter
from .measurement import Measurement
from .rc_servo import RcServo, RcServoData
from .stepper import Stepper, StepperData
from .supply import Supply
from .turned_brushless import TurnedBrushless
from .turned_motor import TurnedMotor
from .turned_stepper import TurnedShaft, TurnedStepper

__all__ = [
    "BRUSHLESS",
    "GEARS",
    "MOTORS",
    "SERVOS",
    "STEPPERS",
    "Battery",
    "Bridge",
    "Brushless",
    "BrushlessData",
    "DcMotor",
    "DcMotorData",
    "Encoder",
    "EndSwitch",
    "Gear",
    "HallSensors",
    "Inverter",
    "Measurement",
    "RcServo",
    "RcServoData",
    "Stepper",
    "StepperData",
    "Supply",
    "TurnedBrushless",
    "TurnedMotor",
    "TurnedShaft",
    "TurnedStepper",
]
