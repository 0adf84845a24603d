# SPDX-License-Identifier: BSD-3-Clause
"""Motors, gears and servos that one can buy, with where their figures are from.

`estimated` names what a source does not say. Look at the datasheet of yours before you rely on a figure.
"""

from __future__ import annotations

from .brushless_data import BrushlessData
from .dc_motor_data import DcMotorData
from .gear import Gear
from .rc_servo import RcServoData
from .stepper import StepperData

MOTORS: dict[str, DcMotorData] = {
    one.name: one
    for one in (
        DcMotorData(
            "maxon RE 40",
            nominal_v=24.0,
            resistance_ohm=0.317,
            inductance_mh=0.0823,
            torque_constant_mnm_a=30.2,
            rotor_inertia_g_cm2=138.0,
            no_load_current_ma=137.0,
            source="maxon catalogue, RE 40, 150 W, 24 V winding (an older edition, with 138 g cm²)",
        ),
        DcMotorData(
            "maxon RE 30",
            nominal_v=48.0,
            resistance_ohm=2.45,
            inductance_mh=0.513,
            torque_constant_mnm_a=53.8,
            rotor_inertia_g_cm2=34.7,
            no_load_current_ma=78.6,
            source="maxon catalogue, RE 30, 60 W, 48 V winding",
        ),
        DcMotorData(
            "maxon DCX 22 L",
            nominal_v=9.0,
            resistance_ohm=0.168,
            inductance_mh=0.018,
            torque_constant_mnm_a=6.95,
            rotor_inertia_g_cm2=9.37,
            no_load_current_ma=118.0,
            source="maxon, configuration sheet of a DCX 22 L with a 9 V winding",
        ),
        DcMotorData(
            "Faulhaber 1331T012SR",
            nominal_v=12.0,
            resistance_ohm=13.7,
            inductance_mh=0.31,
            torque_constant_mnm_a=11.4,
            rotor_inertia_g_cm2=0.67,
            no_load_current_ma=10.5,
            source="Faulhaber datasheet 1331 T … SR, column 012 SR",
        ),
        DcMotorData.of_curve(
            "Pololu 37D 12 V",
            nominal_v=12.0,
            no_load_speed_rpm=10000.0,
            no_load_current_ma=200.0,
            stall_current_a=5.5,
            rotor_inertia_g_cm2=20.0,
            inductance_mh=1.5,
            source="Pololu datasheet 37D Metal Gearmotors, revision 1.2, item 4750 without a gear",
            estimated=("rotor_inertia_g_cm2", "inductance_mh"),
        ),
    )
}

BRUSHLESS: dict[str, BrushlessData] = {
    one.name: one
    for one in (
        BrushlessData(
            "GBM2804H-100T",
            pole_pairs=7,
            resistance_ohm=5.29,
            inductance_mh=1.05,
            flux_mwb=5.4,
            rotor_inertia_g_cm2=30.0,
            friction_mnm=1.0,
            source="iPower GBM2804H-100T, a gimbal motor, as measured for the motor tables of NuttX and ST",
            estimated=("rotor_inertia_g_cm2", "friction_mnm"),
        ),
        BrushlessData(
            "Mini Cheetah",
            pole_pairs=21,
            resistance_ohm=0.13,
            inductance_mh=0.025,
            flux_mwb=2.5,
            rotor_inertia_g_cm2=630.0,
            friction_mnm=5.0,
            source="MIT Mini Cheetah, its actuator without the gear of 6, as in its firmware and simulator",
            estimated=("friction_mnm",),
        ),
    )
}

GEARS: dict[str, Gear] = {
    "Pololu 37D 30:1": Gear(
        30.0, 0.78, source="stall torque 140 kg mm at 5.5 A, same datasheet as the motor"
    ),
    "Pololu 37D 50:1": Gear(
        50.0, 0.70, source="stall torque 210 kg mm at 5.5 A, same datasheet as the motor"
    ),
    "Pololu 37D 100:1": Gear(
        102.08, 0.56, source="stall torque 340 kg mm at 5.5 A, same datasheet as the motor"
    ),
}

STEPPERS: dict[str, StepperData] = {
    one.name: one
    for one in (
        StepperData(
            "17HS19-2004S1",
            current_a=2.0,
            resistance_ohm=1.4,
            inductance_mh=3.0,
            holding_torque_ncm=59.0,
            rotor_inertia_g_cm2=82.0,
            source="StepperOnline 17HS19-2004S1, NEMA 17",
            estimated=("rotor_inertia_g_cm2", "friction_ncm"),
        ),
    )
}

SERVOS: dict[str, RcServoData] = {
    one.name: one
    for one in (
        RcServoData(
            "Hitec HS-311",
            seconds_per_60_deg=0.19,
            stall_torque_kg_cm=3.0,
            source="on the packet of the HS-311, at 4.8 V",
            estimated=("reach_deg", "dead_band_us", "settling_ms"),
        ),
    )
}
