# SPDX-License-Identifier: BSD-3-Clause
"""Parts of machines at the pins of a board, and those without pins."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from unitylink.errors import ValueRangeError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, Registers
from unitylink.simulate.machine import (
    MOTORS,
    SERVOS,
    STEPPERS,
    Battery,
    Bridge,
    DcMotor,
    Encoder,
    EndSwitch,
    HallSensors,
    Measurement,
    RcServo,
    Stepper,
    Supply,
)
from unitylink.spec import Spec, compile_text

TEXT = """
link rig (ADDRESS=8);
public rig() {
   drive: h_bridge(form=FORM);
   chip: pwm(channels=2, frequency_hz=20000);
   arm: rc_servo(channels=1);
   shaft: quadrature_encoder(with_index=1);
   rotor: hall();
   ends: gpio(pins=2);
}
"""
RE_40 = MOTORS["maxon RE 40"]
NEMA_17 = STEPPERS["17HS19-2004S1"]


class Rig:
    """A plant whose step is a function of the parts."""

    period_s = 0.001

    def __init__(self, make: Callable[[Any], Callable[[], None]]) -> None:
        self._make = make

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self._do = self._make(registers.components)

    def step(self, time_s: float) -> None:
        self._do()


@contextmanager
def rig(make: Callable[[Any], Callable[[], None]], form: int = 0) -> Iterator[tuple[Any, Link]]:
    spec = compile_text(TEXT.replace("FORM", str(form)), "rig.ul").spec
    assert spec is not None
    with Board(spec, plant=Rig(make), endpoint="lockstep") as board, Link(board.url) as link:
        yield load_spec_objects(spec, link), link
        assert board.error is None


@pytest.mark.parametrize("form", [0, 1, 2])
def test_a_duty_turns_the_motor_and_the_encoder_counts(form: int) -> None:
    motor, supply = DcMotor(RE_40), Supply(24.0)

    def make(parts: Any) -> Callable[[], None]:
        bridge, encoder = Bridge(parts["drive"], supply), Encoder(parts["shaft"], 500, index=True)

        def step() -> None:
            bridge.drive(motor, 0.001)
            encoder.show(motor.angle_rad, 0.001)

        return step

    with rig(make, form) as (board, link):
        board["drive.duty"].write(-0.5)
        board["drive.control"].write({"enable": True, "coast": False})
        link.step(0.2)
        wanted = -(12.0 - RE_40.resistance_ohm * RE_40.no_load_current_ma / 1000) / RE_40.constant
        assert motor.speed_rad_s == pytest.approx(wanted, rel=0.025)  # the dead time takes 1 % of 24 V
        turns = motor.angle_rad / (2 * math.pi)
        assert board["shaft.position"].read() == pytest.approx(2000 * turns, abs=0.001 * 2000 * 70)
        assert board["shaft.index_count"].read() == pytest.approx(-turns, abs=1.2)
        assert board["shaft.impossible"].read() == 0
        assert supply.current_a == pytest.approx(0.137 / 2, rel=0.05)
        supply.is_on = False  # the plug is pulled
        link.step(0.01)
        assert motor.current_a == 0 and abs(motor.speed_rad_s) > 0.9 * abs(wanted)
        link.step(3.0)
        assert motor.speed_rad_s == 0


def test_coasting_periods_are_computed_one_by_one() -> None:
    """With both sides off in the rest of a period, the current ends there, and the speed is higher."""
    speeds = []
    for coast in (False, True):
        motor = DcMotor(replace(RE_40, no_load_current_ma=500.0, rotor_inertia_g_cm2=14.0))

        def make(parts: Any, motor: DcMotor = motor) -> Callable[[], None]:
            bridge = Bridge(parts["drive"], Supply(24.0))
            return lambda: bridge.drive(motor, 0.001)

        with rig(make) as (board, link):
            board["drive.duty"].write(0.3)
            board["drive.control"].write({"enable": True, "coast": coast})
            link.step(0.2)
        speeds.append(motor.speed_rad_s)
    assert speeds[0] == pytest.approx((0.3 * 24 - 0.5 * RE_40.resistance_ohm) / RE_40.constant, rel=0.05)
    back_v = RE_40.constant * speeds[1]
    # the current rises while it is driven, and falls twice as steep or more until it has ended
    driven_s = 0.3 / 20000 - 0.5e-6  # the dead time
    peak_a = (24 - back_v) * driven_s / (RE_40.inductance_mh / 1000)
    flows_s = driven_s + peak_a * RE_40.inductance_mh / 1000 / (24 + back_v)
    assert peak_a / 2 * flows_s * 20000 == pytest.approx(0.5, rel=0.1)
    assert speeds[1] > 1.4 * speeds[0]


def test_a_pwm_drives_a_chip_or_a_switch_to_ground() -> None:
    chip, switch = DcMotor(RE_40), DcMotor(RE_40)

    def make(parts: Any) -> Callable[[], None]:
        first = Bridge(parts["chip"], Supply(24.0), resistance_mohm=100)

        def step() -> None:
            first.drive(chip, 0.001)

        with pytest.raises(ValueRangeError, match="bridge at chip: channels is"):
            Bridge(parts["chip"], Supply(24.0), channels=())
        with pytest.raises(ValueRangeError, match="bridge at shaft: quadrature_encoder does not drive"):
            Bridge(parts["shaft"], Supply(24.0))
        return step

    with rig(make) as (board, link):
        board["chip.control"].write({"enable": True})
        board["chip.width[1]"].write(1.0)
        link.step(0.2)
        assert chip.speed_rad_s == pytest.approx(-RE_40.no_load_speed_rpm * math.pi / 30, rel=0.01)

    def make_switch(parts: Any) -> Callable[[], None]:
        one = Bridge(parts["chip"], Supply(24.0), channels=(0,))
        return lambda: one.drive(switch, 0.001)

    with rig(make_switch) as (board, link):
        board["chip.control"].write({"enable": True})
        board["chip.width[0]"].write(0.5)
        link.step(0.2)
        assert switch.speed_rad_s == pytest.approx(RE_40.no_load_speed_rpm * math.pi / 60, rel=0.02)
        board["chip.width[0]"].write(0.0)
        link.step(0.005)
        assert switch.current_a == 0 and switch.speed_rad_s > 100


def test_many_motors_on_a_weak_battery_share_it_without_ringing() -> None:
    supply = Supply(24.0, internal_mohm=2000)
    motors = [DcMotor(RE_40, stops_rad=(0.0, 0.0)) for _ in range(8)]

    def make(parts: Any) -> Callable[[], None]:
        bridges = [Bridge(parts["drive"], supply) for _ in motors]

        def step() -> None:
            for bridge, motor in zip(bridges, motors, strict=True):
                bridge._drive(motor, 1.0, 0.001)
                supply.take(bridge, motor.current_a, 0.001)

        return step

    with rig(make) as (_, link):
        link.step(0.3)
    alone = 24.0 / (RE_40.resistance_ohm / 8 + 2.0)
    assert supply.current_a == pytest.approx(alone, rel=0.01)
    assert supply.volts == pytest.approx(24.0 - 2.0 * alone, rel=0.05)
    assert max(motor.current_a for motor in motors) < 1.2 * min(motor.current_a for motor in motors)


def test_a_battery_sags_empties_and_switches_off() -> None:
    battery = Battery(cells=3, capacity_mah=1000, internal_mohm=50, cutoff_v=9.0)
    assert battery.volts == pytest.approx(12.6)
    battery.take("motor", 10.0, 180.0)
    assert battery.charge == pytest.approx(0.5)
    assert battery.volts == pytest.approx(3 * 3.84 - 0.5)
    assert battery.without("motor") == pytest.approx(3 * 3.84)
    battery.take("motor", 60.0, 0.001)
    assert battery.volts == battery.current_a == 0 and not battery.is_on  # its protection
    with pytest.raises(ValueRangeError, match="amps is nan"):
        battery.take("motor", math.nan, 0.001)
    empty = Battery(1, 100, 0)
    empty.take("lamp", 1.0, 3600.0)
    assert empty.charge == 0 and not empty.is_on
    whole: dict[str, Any] = {"cells": 1, "capacity_mah": 100, "internal_mohm": 1}
    for wrong, said in (
        ({"cells": 0}, "cells is 0"),
        ({"capacity_mah": -1}, "capacity_mah is -1"),
        ({"internal_mohm": math.nan}, "internal_mohm is nan"),
        ({"charge": 2.0}, "charge is 2.0"),
        ({"cell_v": ((0.0, 3.0),)}, "needs pairs"),
    ):
        with pytest.raises(ValueRangeError, match=said):
            Battery(**{**whole, **wrong})


def test_an_end_switch_has_a_hysteresis_and_bounces() -> None:
    place = {"at": 1.0}

    def make(parts: Any) -> Callable[[], None]:
        low = EndSwitch(parts["ends"], "pin_in", 0, below=0.0, hysteresis=0.1, bounce_ms=0.5)
        high = EndSwitch(parts["ends"], "pin_in", 1, above=2.0, closed_level=False)
        with pytest.raises(ValueRangeError, match="either below or above"):
            EndSwitch(parts["ends"], "pin_in")
        with pytest.raises(ValueRangeError, match="no input 'pin_on'"):
            EndSwitch(parts["ends"], "pin_on", below=0.0).show(1.0)

        def step() -> None:
            low.show(place["at"])
            high.show(place["at"])

        return step

    with rig(make) as (board, link):
        board["ends.watch"].write(1)
        for at, levels in ((1.0, 2), (-0.01, 3), (0.05, 3), (0.11, 2), (2.1, 0), (1.9, 2)):
            place["at"] = at
            link.step(0.004)
            assert board["ends.levels"].read() == levels, at
    seen: list[bool] = []

    class Pins:
        configuration = type("Configuration", (), {"path": "x"})

        def drive(self, port: str, level: bool, bit: int) -> None:
            seen.append(level)

        def play(self, port: str, levels: list[tuple[float, bool]], bit: int) -> None:
            assert [time_s for time_s, _ in levels] == sorted(time_s for time_s, _ in levels)
            assert levels[-1][0] == pytest.approx(0.003)
            seen.extend(level for _, level in levels)

    switch: Any = EndSwitch(Pins(), "a", above=0.0, bounce_ms=3)  # type: ignore[arg-type]
    switch.show(-1.0)
    switch.show(1.0)
    assert seen == [False, True, False, True, False, True, False, True]


def test_hall_sensors_pass_each_sector() -> None:
    angle = {"at": 0.1}

    def make(parts: Any) -> Callable[[], None]:
        sensors = HallSensors(parts["rotor"], pole_pairs=7)
        return lambda: (sensors.show(angle["at"], 0.001), None)[1]

    with rig(make) as (board, link):
        link.step(0.003)
        begun, failures = board["rotor.position"].read(), board["rotor.failures"].read()
        for turned in (1.0, 0.2, -0.4):
            angle["at"] = 0.1 + turned
            link.step(0.003)
            wanted = math.floor(7 * (0.1 + turned) * 3 / math.pi) - math.floor(7 * 0.1 * 3 / math.pi)
            assert board["rotor.position"].read() - begun == wanted
        assert board["rotor.failures"].read() == failures
        assert board["rotor.status"].read().sector == math.floor(7 * -0.3 * 3 / math.pi) % 6


def test_a_servo_follows_its_pulses_with_the_speed_on_its_packet() -> None:
    data = SERVOS["Hitec HS-311"]
    made: dict[str, RcServo] = {}

    def make(parts: Any) -> Callable[[], None]:
        servo = made["servo"] = RcServo(data, parts["arm"])
        return lambda: servo.step(0.001)

    with rig(make) as (board, link):
        servo = made["servo"]
        link.step(0.1)
        assert not servo.is_driven and servo.angle_rad == 0
        board["arm.control"].write({"enable": True})
        board["arm.width[0]"].write(1500 + 600)
        begun_s = link.now_s()
        while servo.angle_rad < math.radians(50):
            link.step(0.001)
        # a period of the pulses until the first, and then 60 degrees in 0.19 s
        assert link.now_s() - begun_s == pytest.approx(0.19 * 50 / 60 + 0.01, abs=0.015)
        link.step(0.5)
        assert math.degrees(servo.angle_rad) == pytest.approx(60, abs=0.1)
        servo.load_nm = 0.5 * 3.0 * 0.0980665
        link.step(0.5)
        sag = math.radians(60) / 0.19 * 0.020 * 0.5
        assert servo.angle_rad == pytest.approx(math.radians(60) - sag, abs=0.002)
        servo.load_nm = 2 * 3.0 * 0.0980665  # more than it can hold
        link.step(1.0)
        assert math.degrees(servo.angle_rad) == -90
        servo.load_nm = 0.0
        board["arm.control"].write({"enable": False})
        link.step(0.1)
        assert not servo.is_driven
    for name in ("seconds_per_60_deg", "us_per_deg", "settling_ms"):
        with pytest.raises(ValueRangeError, match=f"servo Hitec HS-311: {name} is 0"):
            replace(data, **dict[str, Any]({name: 0}))


def run_to(turns_s: float, load_nm: float = 0.0, **more: Any) -> Stepper:
    """Let a stepper speed up evenly for half a second, and go on for another half."""
    stepper = Stepper(NEMA_17, Supply(24.0), **more)
    stepper.load_nm = load_nm
    steps = 0.0
    for number in range(1000):
        steps += min(number / 500, 1.0) * turns_s * 200 * 16 / 1000
        stepper.follow(steps, 0.001)
    return stepper


def test_a_stepper_follows_until_its_torque_ends_and_loses_four_steps_at_a_time() -> None:
    good, fast, heavy = run_to(5.0, 0.1), run_to(40.0, 0.1), run_to(1.0, 0.7)
    assert good.lost_steps == 0
    assert good.speed_rad_s / (2 * math.pi) == pytest.approx(5.0, rel=0.1)
    for lost in (fast.lost_steps, heavy.lost_steps):
        assert lost > 100 and lost % 4 == 0


def test_a_stepper_holds_what_its_datasheet_says() -> None:
    for load, holds in ((0.57, True), (0.61, False)):
        stepper = Stepper(NEMA_17, Supply(24.0))
        for number in range(400):
            stepper.load_nm = load * min(1.0, number / 200)
            stepper.follow(0, 0.001)
        assert (stepper.lost_steps == 0) is holds
    stepper.is_enabled = False
    stepper.follow(0, 0.001)
    assert stepper.currents_a == (0.0, 0.0)


def test_a_stepper_swings_with_its_natural_frequency() -> None:
    data = replace(NEMA_17, friction_ncm=0.0)
    stepper = Stepper(data, Supply(240.0))
    stepper.load_nm = 0.05
    for _ in range(300):
        stepper.follow(0, 0.001)
    stepper.load_nm = 0.0
    angles = []
    for _ in range(400):
        stepper.follow(0, 0.0001)
        angles.append(stepper.angle_rad)
    falls = [n for n in range(1, 400) if angles[n - 1] >= 0 > angles[n]]
    period_s = 0.0001 * (falls[-1] - falls[0]) / (len(falls) - 1)
    wanted_hz = math.sqrt(50 * 0.59 / 82e-7) / (2 * math.pi)
    assert 1 / period_s == pytest.approx(wanted_hz, rel=0.03)
    assert wanted_hz == pytest.approx(302, rel=0.01)


def test_a_stepper_refuses_what_cannot_be() -> None:
    stepper = Stepper(NEMA_17, Supply(24.0))
    stepper.follow(3, 0.0)
    for seconds in (-1.0, 1.0, math.nan):
        with pytest.raises(ValueRangeError, match=r"stepper 17HS19-2004S1: a step of .* shorter period_s"):
            stepper.follow(0, seconds)
    with pytest.raises(ValueRangeError, match="steps is nan"):
        stepper.follow(math.nan, 0.001)
    with pytest.raises(ValueRangeError, match=r"microsteps is 0; .*1 is full steps"):
        Stepper(NEMA_17, Supply(24.0), microsteps=0)
    with pytest.raises(ValueRangeError, match="rotor_inertia_g_cm2 is 0"):
        replace(NEMA_17, rotor_inertia_g_cm2=0)
    with pytest.raises(ValueRangeError, match="multiple of 4"):
        replace(NEMA_17, steps_per_turn=201)


def test_a_measurement_is_late_noisy_limited_and_in_steps() -> None:
    late = Measurement(delay_s=0.003, bias=0.5)
    assert [late.of(float(number), number * 0.001) for number in range(6)] == [0.5, 0.5, 0.5, 0.5, 1.5, 2.5]
    noisy = Measurement(noise_rms=0.1, seed=3)
    seen = [noisy.of(1.0, number * 0.001) for number in range(4000)]
    assert statistics.fmean(seen) == pytest.approx(1.0, abs=0.01)
    assert statistics.pstdev(seen) == pytest.approx(0.1, rel=0.05)
    noisy.seed(3)
    assert [noisy.of(1.0, 9.0 + number) for number in range(9)] == seen[:9]
    steps = Measurement(resolution=0.25, least=0.0, most=1.0)
    assert [steps.of(value, 0.0) for value in (-3.0, 0.1, 0.2, 0.8, 7.0)] == [0.0, 0.0, 0.25, 0.75, 1.0]
    with pytest.raises(ValueRangeError, match="value is nan"):
        steps.of(math.nan, 0.0)
    with pytest.raises(ValueRangeError, match="cannot go back"):
        steps.of(0.0, -1.0)
    with pytest.raises(ValueRangeError, match="least must be below most"):
        Measurement(least=1.0, most=1.0)
    with pytest.raises(ValueRangeError, match="noise_rms is -1"):
        Measurement(noise_rms=-1)
