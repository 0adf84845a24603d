# SPDX-License-Identifier: BSD-3-Clause
"""The DC motor: it is what its datasheet says, and what the equations say, whatever the steps are."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.errors import ValueRangeError
from unitylink.simulate.machine import GEARS, MOTORS, DcMotor, DcMotorData, Gear
from unitylink.simulate.machine.dc_motor_data import RPM
from unitylink.simulate.machine.linear_pair import LinearPair

RE_40 = MOTORS["maxon RE 40"]
SIZES = st.floats(-3.0, 3.0).map(lambda power: 10**power)
MADE = st.builds(
    DcMotorData,
    name=st.just("any"),
    nominal_v=st.just(24.0),
    resistance_ohm=SIZES,
    inductance_mh=st.one_of(st.just(0.0), SIZES),
    torque_constant_mnm_a=SIZES,
    rotor_inertia_g_cm2=SIZES,
    viscous_share=st.floats(0.0, 1.0),
)


def solved(data: DcMotorData, volts: float, against_nm: float, seconds: float) -> tuple[float, float]:
    """Return current and speed from a standstill, by the eigenvalues of the equations."""
    k, j, r, h = data.constant, data.inertia_kg_m2, data.resistance_ohm, data.inductance_mh / 1000
    matrix = np.array([[-r / h, -k / h], [k / j, -data.damping_nm_s / j]])
    rest = np.linalg.solve(matrix, -np.array([volts / h, -against_nm / j]))
    values, vectors = np.linalg.eig(matrix.astype(complex))
    kept = vectors @ np.diag(np.exp(values * seconds)) @ np.linalg.inv(vectors)
    current, speed = rest - (kept @ rest).real
    return float(current), float(speed)


# what datasheets say beside the figures in the catalogue: rpm, stall torque in mNm, stall A, mechanical ms
@pytest.mark.parametrize(
    ("name", "rpm", "stall_mnm", "stall_a", "time_ms"),
    [
        ("maxon RE 40", 7580, 2280, 75.7, 4.8),
        ("maxon RE 30", 8490, 1050, 19.6, 2.94),
        ("maxon DCX 22 L", 12300, 371, 53.4, None),
        ("Faulhaber 1331T012SR", 9900, 9.90, None, 7),
        ("Pololu 37D 12 V", 10000, None, 5.5, None),
    ],
)
def test_the_catalogue_gives_what_the_datasheets_promise(
    name: str, rpm: float, stall_mnm: float | None, stall_a: float | None, time_ms: float | None
) -> None:
    data = MOTORS[name]
    motor = DcMotor(data)
    for _ in range(20):
        motor.step(data.nominal_v, 10 * data.mechanical_s)
    assert motor.speed_rad_s / RPM == pytest.approx(rpm, rel=0.005)
    assert 1000 * motor.current_a == pytest.approx(data.no_load_current_ma, rel=1e-6)
    held = DcMotor(data, stops_rad=(0.0, 0.0))
    held.step(data.nominal_v, 20 * data.electrical_s)
    assert held.angle_rad == held.speed_rad_s == 0
    if stall_a is not None:
        assert held.current_a == pytest.approx(stall_a, rel=0.005)
    if stall_mnm is not None:
        assert 1000 * (held.torque_nm - data.friction_nm) == pytest.approx(stall_mnm, rel=0.005)
    if time_ms is not None:
        assert 1000 * data.mechanical_s == pytest.approx(time_ms, rel=0.02)


@pytest.mark.parametrize(("ratio", "stall_kg_mm"), [("30", 140), ("50", 210), ("100", 340)])
def test_the_gears_give_the_stall_torque_of_their_datasheet(ratio: str, stall_kg_mm: float) -> None:
    gear = GEARS[f"Pololu 37D {ratio}:1"]
    motor = DcMotor(MOTORS["Pololu 37D 12 V"], gear)
    motor.load_nm = 0.97 * stall_kg_mm * 9.80665e-3
    motor.step(12.0, 0.2)
    assert motor.angle_rad > 0
    motor = DcMotor(MOTORS["Pololu 37D 12 V"], gear)
    motor.load_nm = 1.03 * stall_kg_mm * 9.80665e-3
    motor.step(12.0, 0.2)
    assert motor.angle_rad <= 0


@pytest.mark.parametrize("name", list(MOTORS))
def test_a_step_of_the_voltage_gives_the_analytic_response(name: str) -> None:
    data = replace(MOTORS[name], no_load_current_ma=0.0)
    for seconds in (0.1 * data.electrical_s, data.electrical_s, data.mechanical_s, 7 * data.mechanical_s):
        motor = DcMotor(data)
        for _ in range(10):
            motor.step(0.5 * data.nominal_v, seconds / 10)
        current, speed = solved(data, 0.5 * data.nominal_v, 0.0, seconds)
        assert motor.current_a == pytest.approx(current, rel=1e-9, abs=1e-12)
        assert motor.speed_rad_s == pytest.approx(speed, rel=1e-9)


def test_with_friction_it_starts_when_the_current_suffices() -> None:
    data = RE_40
    volts = 2.0
    starts_s = -data.electrical_s * math.log(
        1 - data.friction_nm / data.constant / (volts / data.resistance_ohm)
    )
    motor = DcMotor(data)
    motor.step(volts, 0.999 * starts_s)
    assert motor.speed_rad_s == 0 and motor.current_a < data.friction_nm / data.constant
    motor.step(volts, 0.01 * starts_s)
    assert motor.speed_rad_s > 0
    for _ in range(50):
        motor.step(volts, 0.001)
    wanted = (volts - data.resistance_ohm * data.no_load_current_ma / 1000) / data.constant
    assert motor.speed_rad_s == pytest.approx(wanted, rel=1e-4)
    held = DcMotor(data)
    held.step(0.99 * data.resistance_ohm * data.no_load_current_ma / 1000, 100.0)
    assert held.angle_rad == 0


def test_it_holds_when_friction_has_stopped_it() -> None:
    motor = DcMotor(RE_40)
    motor.step(12.0, 0.05)
    for _ in range(100):
        motor.step(0.0, 0.001)
    assert motor.speed_rad_s == motor.current_a == 0 or motor.speed_rad_s == 0
    at = motor.angle_rad
    motor.step(0.0, 1000.0)
    assert (motor.angle_rad, motor.speed_rad_s) == (at, 0.0)


@settings(max_examples=many(60), deadline=None)
@given(data=MADE, load_share=st.floats(-0.9, 0.9), times=SIZES, parts=st.integers(2, 30))
def test_one_long_step_is_as_many_short_ones(
    data: DcMotorData, load_share: float, times: float, parts: int
) -> None:
    seconds = times * min(data.mechanical_s, 1000.0)
    whole, split = DcMotor(data), DcMotor(data)
    whole.load_nm = split.load_nm = load_share * data.stall_torque_nm
    whole.step(24.0, seconds)
    for _ in range(parts):
        split.step(24.0, seconds / parts)
    speed = 24.0 / data.constant
    assert whole.current_a == pytest.approx(split.current_a, rel=1e-6, abs=1e-9 * data.stall_current_a)
    assert whole.speed_rad_s == pytest.approx(split.speed_rad_s, rel=1e-6, abs=1e-9 * speed)
    assert whole.angle_rad == pytest.approx(split.angle_rad, rel=1e-5, abs=1e-9 * speed * seconds)


def with_friction(data: DcMotorData, share: float) -> DcMotorData:
    return replace(data, no_load_current_ma=1000 * share * data.stall_current_a)


@settings(max_examples=many(100), deadline=None)
@given(
    data=st.builds(with_friction, MADE, st.floats(0.0, 0.9)),
    gear=st.builds(Gear, SIZES, st.floats(0.1, 1.0), st.sampled_from([0.0, 0.1, 3.0])),
    inertia=SIZES,
    calls=st.lists(
        st.tuples(
            st.one_of(st.none(), st.floats(-24.0, 24.0)),
            st.floats(-9.0, 3.0).map(lambda power: 10**power),
            st.floats(-1.0, 1.0),
        ),
        max_size=8,
    ),
)
def test_nothing_is_unstable(
    data: DcMotorData, gear: Gear, inertia: float, calls: list[tuple[float | None, float, float]]
) -> None:
    ratio = gear.ratio
    motor = DcMotor(data, gear, load_inertia_kg_m2=inertia, stops_rad=(-2.0, 3.0))
    fastest = 0.0
    for volts, seconds, load in calls:
        motor.load_nm = load * data.stall_torque_nm * ratio
        motor.step(volts, seconds, supply_v=24.0)
        assert math.isfinite(motor.current_a) and math.isfinite(motor.speed_rad_s)
        assert -2.0 <= motor.angle_rad <= 3.0
        off = motor.rotor_angle_rad / ratio - motor.angle_rad
        assert abs(off) <= gear.backlash_rad / 2 + 1e-9
        # what the supply and the turning motor have, together, is the most that can be at the winding
        fastest = max(fastest, abs(motor.rotor_speed_rad_s))
        most_a = (24.0 + data.constant * fastest) / data.resistance_ohm
        assert abs(motor.current_a) <= 1.001 * most_a


def test_open_wires_end_the_current_and_it_coasts() -> None:
    braked, coasting, dead = DcMotor(RE_40), DcMotor(RE_40), DcMotor(RE_40)
    for motor in (braked, coasting, dead):
        motor.step(24.0, 0.005)
        assert motor.current_a > 20
    braked.step(0.0, 0.01)
    coasting.step(None, 0.01, supply_v=24.0)
    dead.step(None, 0.01)
    assert coasting.current_a == dead.current_a == 0
    assert coasting.speed_rad_s > 0.9 * dead.speed_rad_s > 2 * braked.speed_rad_s > 0
    assert braked.current_a < -1  # it brakes
    coasting.step(None, 100.0, supply_v=24.0)
    assert coasting.speed_rad_s == 0


def test_a_motor_that_is_driven_feeds_its_supply() -> None:
    motor = DcMotor(RE_40)
    motor.load_nm = -0.5
    for _ in range(200):
        motor.step(None, 0.001, supply_v=12.0)
    assert motor.current_a < -10  # through the diodes
    assert motor.speed_rad_s > 12.0 / RE_40.constant


def test_a_gear_that_loses_most_of_its_torque_holds_by_itself() -> None:
    weight = 0.4
    for efficiency, holds in ((0.3, True), (1.0, False)):
        motor = DcMotor(MOTORS["Pololu 37D 12 V"], Gear(10.0, efficiency), load_inertia_kg_m2=1e-3)
        motor.load_nm = weight * MOTORS["Pololu 37D 12 V"].friction_nm * 10 / 0.4 * 1.2
        motor.step(None, 1.0)
        assert (motor.angle_rad == 0) is holds


def test_the_play_of_a_gear_is_lost_motion() -> None:
    gear = Gear(50.0, 0.8, backlash_deg=2.0)
    motor = DcMotor(RE_40, gear, load_inertia_kg_m2=0.01, load_friction_nm=0.5)
    ends = []
    for volts in (3.0, -3.0, 3.0):
        for _ in range(300):
            motor.step(volts, 0.001)
        ends.append(motor.rotor_angle_rad / 50 - motor.angle_rad)
        assert motor.speed_rad_s == pytest.approx(motor.rotor_speed_rad_s / 50)
    half = gear.backlash_rad / 2
    assert ends == pytest.approx([half, -half, half], abs=1e-9)


def test_without_a_load_to_push_the_play_changes_nothing() -> None:
    """A gear that only pushes moves its load as one without play does."""
    runs = []
    for play in (0.0, 1e-3):
        motor = DcMotor(RE_40, Gear(20.0, backlash_deg=play), load_inertia_kg_m2=0.002, load_friction_nm=0.1)
        for _ in range(100):
            motor.step(12.0, 0.001)
        runs.append((motor.speed_rad_s, motor.angle_rad, motor.current_a))
    assert runs[1] == pytest.approx(runs[0], rel=1e-3)


def test_a_stop_is_a_stop() -> None:
    for play in (0.0, 1.0):
        motor = DcMotor(RE_40, Gear(10.0, backlash_deg=play), load_inertia_kg_m2=1e-3, stops_rad=(-1.0, 2.0))
        for volts, stop in ((24.0, 2.0), (-24.0, -1.0)):
            for _ in range(400):
                motor.step(volts, 0.001)
            assert motor.angle_rad == pytest.approx(stop, abs=1e-8)
            assert abs(motor.current_a) == pytest.approx(RE_40.stall_current_a, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"resistance_ohm": -1.0},
            r"motor maxon RE 40: resistance_ohm is -1\.0; .*above 0; take the terminal",
        ),
        ({"rotor_inertia_g_cm2": 0.0}, r"rotor_inertia_g_cm2 is 0\.0.*1 g cm² is 1e-7 kg m²"),
        ({"inductance_mh": math.nan}, "inductance_mh is nan"),
        ({"torque_constant_mnm_a": math.inf}, "torque_constant_mnm_a is inf"),
        ({"nominal_v": "24"}, "nominal_v is '24'"),
        ({"no_load_current_ma": 1e6}, "no_load_current_ma is 1e.06, and at a standstill it takes 75709.8 mA"),
        ({"viscous_share": 1.5}, "viscous_share is 1.5; it must be from 0 to 1"),
    ],
)
def test_figures_that_cannot_be_are_refused_by_name(change: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueRangeError, match=said):
        replace(RE_40, **change)


def test_what_a_motor_cannot_do_is_refused_by_name() -> None:
    with pytest.raises(ValueRangeError, match="ratio is 0"):
        Gear(0)
    with pytest.raises(ValueRangeError, match=r"efficiency is 70.*0.7 means 70 %"):
        Gear(5, 70)
    with pytest.raises(ValueRangeError, match="gear with backlash needs an inertia behind it"):
        DcMotor(RE_40, Gear(5, backlash_deg=1))
    with pytest.raises(ValueRangeError, match="two angles, the lower first"):
        DcMotor(RE_40, stops_rad=(1.0, -1.0))
    with pytest.raises(ValueRangeError, match=r"no_load_speed_rpm is 0.*before its gear"):
        DcMotorData.of_curve(
            "x",
            nominal_v=12,
            no_load_speed_rpm=0,
            no_load_current_ma=1,
            stall_current_a=1,
            rotor_inertia_g_cm2=1,
        )
    motor = DcMotor(RE_40)
    for volts, seconds, name in (
        (math.nan, 0.1, "volts"),
        (1.0, -0.1, "seconds"),
        (1.0, math.inf, "seconds"),
    ):
        with pytest.raises(ValueRangeError, match=f"{name} is"):
            motor.step(volts, seconds)
    motor.load_nm = math.nan
    with pytest.raises(ValueRangeError, match=r"load_nm is nan; .*look at what the plant computes"):
        motor.step(1.0, 0.1)
    motor.load_nm = 0.0
    motor.step(1.0, 0.0)
    assert motor.angle_rad == motor.current_a == 0


@settings(max_examples=many(80), deadline=None)
@given(
    matrix=st.tuples(SIZES, SIZES, SIZES, st.one_of(st.just(0.0), SIZES)),
    start=st.tuples(st.floats(-9, 9), st.floats(-9, 9)),
    long=st.floats(-4.0, 4.0).map(lambda power: 10**power),
)
def test_a_pair_keeps_its_equations(
    matrix: tuple[float, float, float, float], start: tuple[float, float], long: float
) -> None:
    """The states are those of the eigenvalues, and what has gone in and out is their change."""
    (a, b, c, d), (x, y) = matrix, start
    pair = LinearPair(-a, -b, c, -d)
    seconds = long / (a + d)
    x_end, y_end, way = pair.step(x, y, 1.0, -1.0, seconds)
    rest = -np.linalg.solve(np.array([[-a, -b], [c, -d]]), np.array([1.0, -1.0]))
    half = np.array(pair.step(*pair.step(x, y, 1.0, -1.0, seconds / 2)[:2], 1.0, -1.0, seconds / 2)[:2])
    size = max(abs(x), abs(y), *np.abs(rest))
    assert (x_end, y_end) == pytest.approx(tuple(half), rel=1e-9, abs=1e-9 * size)
    x_way = (x_end - x - seconds + b * way) / -a  # by the first equation
    assert y_end - y == pytest.approx(
        c * x_way - d * way - seconds, rel=1e-6, abs=1e-9 * (size + (c / a + 1) * (size + seconds))
    )
    final = pair.step(x, y, 1.0, -1.0, 1e13)
    assert final[:2] == pytest.approx(tuple(rest), rel=1e-6, abs=1e-6 * size)


@pytest.mark.parametrize("apart", [0.0, 1e-9, 1e-6, 1e-4, 1e-2, -1e-6, -1e-2])
def test_two_poles_that_are_nearly_one_are_no_trouble(apart: float) -> None:
    # the poles of [[-2, -b], [1, 0]] are -1 and -1, if b is 1
    pair = LinearPair(-2.0, -(1.0 + apart), 1.0, 0.0)
    for seconds in (1e-3, 0.4, 1.0, 5.0):
        split = (1.0, 0.0)
        for _ in range(16):
            split = pair.step(*split, 0.0, 0.0, seconds / 16)[:2]
        assert pair.step(1.0, 0.0, 0.0, 0.0, seconds)[:2] == pytest.approx(split, rel=1e-7, abs=1e-9)
    assert LinearPair(-2.0, -1.0, 1.0, 0.0).step(1.0, 0.0, 0.0, 0.0, 2.0)[1] == pytest.approx(
        2 * math.exp(-2)
    )
