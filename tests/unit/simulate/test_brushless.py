# SPDX-License-Identifier: BSD-3-Clause
"""A brushless motor and its inverter, against what the equations and the figures of its data say."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from typing import Any

import pytest

from unitylink.errors import ValueRangeError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.machine import BRUSHLESS, Brushless, BrushlessData, HallSensors, Inverter, Supply
from unitylink.spec import compile_text

GIMBAL = BRUSHLESS["GBM2804H-100T"]
HEAVY = 1e3  # kg m^2: it does not turn


def rotating(volts: complex) -> list[float]:
    """Return the voltages of the three terminals for one along alpha and beta."""
    return [(volts * cmath.exp(-2j * math.pi * phase / 3)).real for phase in range(3)]


@pytest.mark.parametrize("parts", [1, 7, 200])
def test_a_current_rises_as_resistance_and_inductance_say(parts: int) -> None:
    motor = Brushless(GIMBAL, load_inertia_kg_m2=HEAVY)
    for _ in range(parts):
        motor.step((6.0, 0.0, 0.0), 2e-3 / parts)
    tau = GIMBAL.inductance_mh / 1000 / GIMBAL.resistance_ohm
    expected = (
        4.0 / GIMBAL.resistance_ohm * (1 - math.exp(-2e-3 / tau))
    )  # two thirds of it at the first phase
    assert motor.currents_a == pytest.approx((expected, -expected / 2, -expected / 2), rel=1e-9)


@pytest.mark.parametrize(
    ("electrical_deg", "part"), [(0, 0.0), (90, -1.0), (270, 1.0), (180, 0.0), (300, 0.866)]
)
def test_the_torque_is_that_of_the_current_across_the_magnets(electrical_deg: float, part: float) -> None:
    at = math.radians(electrical_deg) / GIMBAL.pole_pairs
    motor = Brushless(GIMBAL, load_inertia_kg_m2=HEAVY, angle_rad=at)
    motor.step((5.29 * 1.5, 0.0, 0.0), 0.1)
    assert motor.currents_a[0] == pytest.approx(1.0, rel=1e-3)
    assert GIMBAL.torque_constant == pytest.approx(0.0567)
    assert motor.torque_nm == pytest.approx(part * GIMBAL.torque_constant, abs=2e-4)


def test_it_runs_as_the_equations_of_its_two_axes_say() -> None:
    """A voltage that turns with the rotor, across the magnets, and a load: speed and currents at rest."""
    data = replace(GIMBAL, friction_mnm=0.0)
    motor, volts, load = Brushless(data), 4.0, 0.01
    motor.load_nm = load
    for _ in range(20_000):
        lead = cmath.exp(
            1j * (data.pole_pairs * (motor.angle_rad + 12.5e-6 * motor.speed_rad_s) + math.pi / 2)
        )
        motor.step(rotating(volts * lead), 25e-6)
    ohm, henry, flux = data.resistance_ohm, data.inductance_mh / 1000, data.flux_mwb / 1000
    turning = data.pole_pairs * motor.speed_rad_s
    d, q = motor.currents_dq_a
    assert q == pytest.approx(load / data.torque_constant, rel=2e-3)
    assert d == pytest.approx(turning * henry * q / ohm, rel=0.02)
    assert volts == pytest.approx(ohm * q + turning * (henry * d + flux), rel=2e-3)


def test_no_energy_is_made_or_lost() -> None:
    data = replace(GIMBAL, friction_mnm=0.0)
    motor, given, heat, work = Brushless(data), 0.0, 0.0, 0.0
    motor.load_nm = 0.005
    for number in range(20_000):
        lead = cmath.exp(1j * 2 * math.pi * 8e-6 * number**2 / 400)  # it is led to a speed
        before, angle = motor.current, motor.angle_rad
        given += motor.step(rotating(6.0 * lead), 20e-6)
        mean = abs((before + motor.current) / 2)
        heat += 1.5 * data.resistance_ohm * mean**2 * 20e-6
        work += motor.load_nm * (motor.angle_rad - angle)
    kept = 0.5 * data.rotor_inertia_g_cm2 * 1e-7 * motor.speed_rad_s**2
    kept += 0.75 * data.inductance_mh / 1000 * abs(motor.current) ** 2
    assert motor.speed_rad_s > 30
    assert given == pytest.approx(heat + work + kept, rel=0.003)


def test_without_gates_the_currents_end_and_it_rolls() -> None:
    motor = Brushless(GIMBAL, angle_rad=0.3)
    motor.step((6.0, 0.0, 0.0), 1e-3)
    motor.speed_rad_s = 100.0
    motor.coast(12.0, 1e-3)
    assert motor.current == 0 and motor.torque_nm == 0
    assert 90.0 < motor.speed_rad_s < 100.0
    motor.coast(12.0, 0.1)
    friction = GIMBAL.friction_mnm / 1000 / (GIMBAL.rotor_inertia_g_cm2 * 1e-7)
    before = motor.speed_rad_s
    motor.coast(12.0, 0.01)
    assert motor.speed_rad_s == pytest.approx(max(0.0, before - 0.01 * friction), abs=1e-6)


def test_figures_of_a_datasheet_from_terminal_to_terminal() -> None:
    data = BrushlessData.of_terminals(
        "mine",
        pole_pairs=8,
        resistance_ohm=1.0,
        inductance_mh=0.5,
        torque_constant_mnm_a=33.5,
        rotor_inertia_g_cm2=100.0,
    )
    assert (data.resistance_ohm, data.inductance_mh) == (0.5, 0.25)
    turned = [math.radians(deg) for deg in range(60, 120)]
    # the voltage between two terminals, in the sixth of a turn in which they are used, for each rad/s
    mean = (
        sum(math.sqrt(3) * 8 * data.flux_mwb * math.sin(angle + math.radians(0.5)) for angle in turned) / 60
    )
    assert mean == pytest.approx(33.5, rel=1e-3)
    for name, value in (
        ("resistance_ohm", 0.0),
        ("flux_mwb", -1.0),
        ("pole_pairs", 0),
        ("inductance_mh", 0.0),
    ):
        with pytest.raises(ValueRangeError, match=f"motor GBM2804H-100T: {name} is"):
            replace(GIMBAL, **{name: value})


RIG = """
link rig (ADDRESS=8);
public rig() {
   motor: three_phase_pwm(frequency_hz=20000, dead_minimum_ns=300);
   rotor: hall();
   other: gpio(pins=2);
}
"""


class Plant:
    period_s = 50e-6

    def attach(self, spec: Any, registers: Any) -> None:
        parts = registers.components
        parts["motor"].drive("fault", False)
        self.supply = Supply(12.0)
        self.inverter = Inverter(parts["motor"], self.supply)
        self.motor = Brushless(GIMBAL, load_damping_nm_s=2e-4, angle_rad=0.05)
        self.rotor = HallSensors(parts["rotor"], GIMBAL.pole_pairs)
        with pytest.raises(ValueRangeError, match="gpio does not drive an inverter; take a three_phase_pwm"):
            Inverter(parts["other"], self.supply)

    def step(self, time_s: float) -> None:
        self.inverter.drive(self.motor, self.period_s)
        self.rotor.show(self.motor.angle_rad, self.period_s)


def test_duties_of_three_phases_turn_it_and_hall_sensors_count() -> None:
    spec = compile_text(RIG, "rig.ul").spec
    plant = Plant()
    with Board(spec, plant=plant, endpoint="lockstep") as board, Link(board.url) as link:
        rig: Any = load_spec_objects(spec, link)
        duties = [rig[f"motor.duty[{phase}]"] for phase in range(3)]
        rig["motor.control"].write(1)
        for number in range(97):  # the voltage turns by eight electrical turns, and the rotor follows
            for duty, share in zip(duties, rotating(0.6 * cmath.exp(1j * math.pi / 6 * number)), strict=True):
                duty.write(share)
            link.step(0.004)
        link.step(0.05)
        motor = plant.motor
        assert motor.angle_rad * GIMBAL.pole_pairs == pytest.approx(16 * math.pi, abs=0.15)
        # a duty of 0.6 is 0.3 of the supply, less what the dead time takes
        dead_v = 2 * 300e-9 * 20_000 * 12.0 * 2 / 3
        assert motor.currents_a[0] == pytest.approx((0.3 * 12.0 - dead_v) / GIMBAL.resistance_ohm, rel=0.05)
        assert rig["rotor.position"].read() == pytest.approx(48, abs=1)  # six sectors of each
        assert plant.supply.current_a == pytest.approx(1.5 * 3.6 * motor.currents_a[0] / 12.0, rel=0.1)
        rig["motor.control"].write(0)
        link.step(0.01)
        assert motor.current == 0 and plant.supply.current_a == 0
