# SPDX-License-Identifier: BSD-3-Clause
"""Steppers, bus servos, speed controllers, current loops and absolute encoders at the joints of a model."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from unitylink import connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.machine import BRUSHLESS, STEPPERS, Stepper, Supply
from unitylink.simulate.plants.mujoco import MujocoPlant
from unitylink.spec import compile_text, load

MODEL = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body name="arm">
      <joint name="elbow" type="hinge" axis="0 0 1" range="-90 40" limited="true"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
    </body>
    <body name="sled" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="2" diaginertia="0.01 0.01 0.01"/>
      <site name="nose" zaxis="1 0 0"/>
    </body>
    <body name="finger" pos="0 1 0">
      <joint name="finger" type="hinge" axis="0 0 1" damping="0.1" armature="0.001"/>
      <inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>
    </body>
    <body name="rotor" pos="0 2 0">
      <joint name="rotor" type="hinge" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>
    </body>
  </worldbody>
  <actuator>
    <position name="finger_servo" joint="finger" kp="20" dampratio="1" forcerange="-2 2"/>
    <motor name="lift" site="nose" gear="0 0 1 0 0 0" ctrllimited="true" ctrlrange="0 12"/>
    <general name="odd" joint="finger" gaintype="fixed" biastype="affine" biasprm="0 0 -0.01"/>
  </actuator>
</mujoco>
"""
NEMA_17 = STEPPERS["17HS19-2004S1"]


@contextmanager
def robot(folder: Path, spec: str) -> Iterator[tuple[Any, Any, Any]]:
    (folder / "arm.ul").write_text(f"link arm (ADDRESS=8); {spec}")
    (folder / "arm.xml").write_text(MODEL)
    url = f"sim:{folder / 'arm.ul'}?plant=mujoco:{folder / 'arm.xml'}"
    with connect(url, time="lockstep") as link:
        yield link, load_spec_objects(load(folder / "arm.ul"), link), link.board.plant.data


STEPPED = """
public arm() {
   @mujoco(joint="elbow", stepper="17HS19-2004S1", supply_v=24)
   axis: stepgen(axes=1, scale=1.8/16/5 deg);
}
"""


def test_a_stepper_turns_a_joint_as_that_of_the_library_does_and_loses_steps_at_a_stop(
    tmp_path: Path,
) -> None:
    alone = Stepper(NEMA_17, Supply(24.0), load_inertia_kg_m2=0.01 / 25)
    with robot(tmp_path, STEPPED) as (link, arm, data):
        (drive,) = link.board.plant.drives
        arm["axis.speed[0]"].write(360)
        arm["axis.acceleration[0]"].write(8000)
        arm["axis.target[0]"].write(30)
        follows = {"enable": True, "velocity_mode": False, "stop_at_limit": False, "latch": "none"}
        arm["axis.control[0]"].write(follows)
        off = 0.0
        for _ in range(120):  # it speeds up, and swings in its field
            link.step(0.001)
            alone.follow(link.board.components["axis"].steps("step", "direction", 0), 0.001)
            off = max(off, abs(alone.angle_rad / 5 - data.joint("elbow").qpos[0]))
        assert alone.lost_steps == drive.lost_steps == 0
        assert math.degrees(off) < 0.5 * 1.8 / 5, "less than half of a whole step"
        link.step(0.2)
        assert math.degrees(data.joint("elbow").qpos[0]) == pytest.approx(30, abs=0.1)
        data.body("arm").xfrc_applied[5] = -0.6 * 0.59 * 5  # all at once; it holds 0.59 N m
        link.step(0.1)
        assert drive.lost_steps == 0 and 29.3 < math.degrees(data.joint("elbow").qpos[0]) < 29.95
        data.body("arm").xfrc_applied[5] = 0.0

        arm["axis.target[0]"].write(60)  # the joint ends at 40
        link.step(0.5)
        assert arm["axis.position[0]"].read() == pytest.approx(60, abs=0.02)
        assert math.degrees(data.joint("elbow").qpos[0]) < 41
        arm["axis.target[0]"].write(0)
        link.step(0.6)
        lost = drive.lost_steps
        assert lost >= 32 and lost % 4 == 0
        assert math.degrees(data.joint("elbow").qpos[0]) == pytest.approx(-lost * 1.8 / 5, abs=0.1)
        data.body("arm").xfrc_applied[5] = -1.15 * 0.59 * 5
        link.step(0.05)
        assert drive.lost_steps > lost


READ = """
public arm() {
   @mujoco(joint="elbow")
   plain: ssi_encoder(bits=13, lead_bits=2, tail_bits=1, sample_hz=1000, scale=2*pi/8192 rad);
   @mujoco(joint="elbow", sign=-1, zero=1.5)
   fine: biss_encoder(bits=18, sample_hz=1000, scale=2*pi/262144 rad);
   @mujoco(joint="slide")
   chip: as5047p(zero=100, sample_hz=1000, scale=0.01 mm);
   @mujoco(joint="slide", channel=1)
   bank: encoder_bank(channels=2, scale=0.01 mm);
}
"""


def test_absolute_encoders_know_where_a_joint_is(tmp_path: Path) -> None:
    with robot(tmp_path, READ) as (link, arm, data):
        data.joint("elbow").qpos[0] = -0.25
        link.step(0.005)
        assert arm["plain.position"].read() == pytest.approx(-0.25, abs=2 * math.pi / 8192)
        assert arm["fine.position"].read() == pytest.approx(0.25 + 1.5, abs=2 * math.pi / 262144)
        assert arm["fine.failures"].read() == arm["plain.failures"].read() == arm["chip.failures"].read() == 0
        for _ in range(6):  # more than a turn of the chip, whose line has 16384 counts
            data.joint("slide").qpos[0] += 0.04
            link.step(0.003)
        assert arm["chip.position"].read() == pytest.approx(240, abs=0.02)
        assert arm["chip.raw"].read() == (24000 + 100) % 16384
        assert arm["bank.position[1]"].read() == pytest.approx(240, abs=0.02)

        fine, chip = (link.board.components[name].serial_encoder() for name in ("fine", "chip"))
        fine.warning = chip.error = True
        link.step(0.005)
        assert arm["fine.status"].read().warning and arm["fine.status"].read().valid
        assert arm["chip.status"].read().failure.name == "device_error"
        fine.error, chip.error = True, False
        link.board.components["plain"].serial_encoder().plugged = False
        link.step(0.005)
        assert arm["chip.status"].read().valid, "its error was read, which clears it"
        assert arm["fine.status"].read().failure.name == "device_error"
        assert arm["plain.status"].read().failure.name == "no_answer"
        link.board.components["plain"].serial_encoder().plugged = True
        link.step(0.005)
        assert arm["plain.status"].read().valid


SERVO = """
public arm() {{
   @mujoco(joint="finger", channel=1, sign=-1, zero=10)
   bus: servo_bus(servos=2, protocol={}, cycle_hz=500, scale=360/4096 deg, offset=-180);
}}
"""


@pytest.mark.parametrize("protocol", [0, 1])
def test_a_servo_of_a_bus_holds_a_joint_and_tells_how_it_is(tmp_path: Path, protocol: int) -> None:
    with robot(tmp_path, SERVO.format(protocol)) as (link, arm, data):
        link.step(0.02)
        assert arm["bus.position[1]"].read() == pytest.approx(10, abs=0.1)
        data.joint("finger").qvel[0] = -2.0  # without torque somebody turns it
        link.step(0.006)
        assert arm["bus.position[1]"].read() > 10.2
        arm["bus.goal[1]"].write(40)
        arm["bus.drive[1]"].write("follow")
        link.step(0.05)
        assert arm["bus.speed[1]"].read() > 20, "counts a second have the unit of the position"
        link.step(0.6)
        assert math.degrees(data.joint("finger").qpos[0]) == pytest.approx(-30, abs=0.3)
        assert arm["bus.position[1]"].read() == pytest.approx(40, abs=0.3)
        data.joint("finger").qfrc_applied[0] = 0.5  # somebody leans on it
        link.step(0.3)
        assert arm["bus.load[1]"].read() == pytest.approx(250, abs=20), "0.1 % of 2 N m, the other way"


FLOWN = """
public arm() {
   @mujoco(joint="rotor", motor="GBM2804H-100T", supply_v=12)
   wheel: dshot(channels=1, bidirectional=1, pole_pairs=7);
   @mujoco(actuator="lift", channel=1)
   prop: dshot(channels=2);
}
"""


def test_a_speed_controller_turns_a_joint_or_gives_a_thrust(tmp_path: Path) -> None:
    motor = BRUSHLESS["GBM2804H-100T"]
    with robot(tmp_path, FLOWN) as (link, arm, data):
        arm["wheel.throttle[0]"].write(0.5)
        arm["prop.throttle[1]"].write(0.25)
        link.step(0.2)
        assert data.joint("slide").qvel[0] == pytest.approx(0.2 * 12 * 0.25 / 2, rel=0.05)
        link.step(2.0)
        turns = data.joint("rotor").qvel[0]
        block = motor.in_blocks(12.0)
        at_rest = (6.0 - 2 * motor.resistance_ohm * block.no_load_current_ma / 1000) / block.constant
        assert turns == pytest.approx(at_rest, rel=0.05), "it runs with 6 V"
        assert arm["wheel.speed[0]"].read() == pytest.approx(turns, rel=0.01)
        arm["wheel.throttle[0]"].write(0)
        link.step(0.1)
        assert 0 < data.joint("rotor").qvel[0] < turns, "its gates are off, and it rolls"


LOOP = """
public arm() {
   @mujoco(joint="rotor", motor="GBM2804H-100T", supply_v=12)
   motor: three_phase_pwm(frequency_hz=20000, dead_minimum_ns=300);
   @mujoco(joint="rotor")
   current: sigma_delta_adc(channels=2, full_scale=8 A);
   @mujoco(joint="rotor")
   shaft: as5047p(sample_hz=10000);
   loop: foc(current.value[0], current.value[1], shaft.position, motor.duty[0], motor.duty[1], motor.duty[2],
      pole_pairs=7, angle_bits=14, loop_hz=10000, supply=12 V);
}
"""


def test_a_loop_of_currents_in_the_gateware_gives_a_joint_its_torque(tmp_path: Path) -> None:
    motor = BRUSHLESS["GBM2804H-100T"]
    with robot(tmp_path, LOOP) as (link, arm, data):
        assert link.board.plant.period_s == pytest.approx(1e-4), "it looks as often as the loop runs"
        bandwidth = 2 * math.pi * 200
        arm["loop.kp"].write(motor.inductance_mh / 1000 * bandwidth)
        arm["loop.ki"].write(motor.resistance_ohm * bandwidth)
        arm["loop.apply"].pulse()
        link.step(0.001)  # until the modulators give bits
        arm["current.control"].write({"enable": True})
        link.step(0.001)  # until currents and angle are valid
        arm["motor.control"].write({"enable": True, "sample_start": False, "sample_middle": False})
        arm["loop.control"].write({"enable": True, "align": False})
        arm["loop.target_q"].write(0.5)
        link.step(0.02)
        before = data.joint("rotor").qvel[0]
        link.step(0.02)
        assert arm["loop.status"].read().running
        assert arm["loop.current_q"].read() == pytest.approx(0.5, abs=0.05)
        assert arm["loop.current_d"].read() == pytest.approx(0.0, abs=0.05)
        torque = 0.5 * motor.torque_constant - motor.friction_mnm / 1000
        inertia = 1e-4 + motor.rotor_inertia_g_cm2 * 1e-7
        assert (data.joint("rotor").qvel[0] - before) / 0.02 == pytest.approx(torque / inertia, rel=0.1)


EFFORTS = """
public arm() {
   @mujoco(joint="rotor", motor="maxon RE 40", ratio=26, supply_v=24)
   bridge: h_bridge(form=1, dead_minimum_ns=20);
   @rotor = 0x40: f32 READ(UNIT="N m");
   @slide = 0x41: f32 READ(UNIT="N");
   @elbow = 0x42: f32 READ(UNIT="N m");
}
"""


def test_an_effort_is_that_of_a_component_or_an_actuator_and_never_a_silent_0(tmp_path: Path) -> None:
    with robot(tmp_path, EFFORTS) as (link, arm, data):
        (note,) = [one for one in link.board.plant.notes if "effort" in one]
        assert note.startswith("elbow is left out: joint elbow has no actuator, and no component drives it")
        data.actuator("lift").ctrl[0] = 3.0  # a site that pushes a slide
        arm["bridge.duty"].write(0.5)
        arm["bridge.control"].write({"enable": True, "coast": False})
        link.step(0.01)
        assert arm["slide"].read() == pytest.approx(3.0)
        assert arm["rotor"].read() == pytest.approx(data.joint("rotor").qfrc_applied[0], rel=1e-5)
        assert arm["rotor"].read() > 1.0
    said = EFFORTS.replace("@elbow", '@mujoco(joint="elbow") @elbow')
    with pytest.raises(UnityLinkError, match="elbow: @mujoco of elbow: joint elbow has no actuator"):
        robot(tmp_path, said).__enter__()


ONE = "link a(ADDRESS=8); public a() {{ {} {} }}"
ENCODER = "e: as5047p();"
STEPPER = "s: stepgen(axes=1, scale=0.1 deg);"


@pytest.mark.parametrize(
    ("said", "part", "told"),
    [
        ('joint="elbow", stepper="17HS19"', STEPPER, "no stepper '17HS19'; nearest: 17HS19-2004S1"),
        ('joint="elbow", stepper="17HS19-2004S1"', STEPPER, "say supply_v, the voltage of the driver"),
        ('joint="elbow", supply_v=24', STEPPER, "supply_v says nothing about a stepgen; there are"),
        ('joint="finger", stepper="17HS19-2004S1", supply_v=24', STEPPER, "would work against a motor"),
        ('joint="rotor", stepper="17HS19-2004S1", supply_v=24', "s: stepgen(axes=1, scale=0.001 deg);", "Hz"),
        ('joint="elbow", stepper="17HS19-2004S1", supply_v=24, microsteps=0', STEPPER, "must be above 0"),
        ('joint="elbo"', ENCODER, "no joint 'elbo'; nearest: elbow"),
        ('joint="slide"', ENCODER, "e.position has rad, and does not fit there: m"),
        ('joint="elbow", motor="maxon RE 40"', ENCODER, "motor says nothing about a absolute_encoder"),
        ('joint="finger"', "b: servo_bus();", "b.position[0] has no unit"),
        ('joint="elbow"', "b: servo_bus(scale=0.1 deg);", "give it a <position> actuator"),
        ('joint="finger", channel=6', "b: servo_bus(scale=0.1 deg);", "has 6 servos: choose 0 to 5"),
        ('joint="rotor", motor="GBM2804", supply_v=9', "d: dshot();", "nearest: GBM2804H-100T"),
        ('joint="rotor", motor="GBM2804H-100T"', "d: dshot();", "say supply_v"),
        ('actuator="lft"', "d: dshot();", "no actuator 'lft'; nearest: lift"),
        ('actuator="odd"', "d: dshot();", "'odd' is no motor with a ctrlrange"),
        ('actuator="lift"', "d: dshot(bidirectional=1);", 'it shows a speed, so say motor="…"'),
    ],
)
def test_what_is_said_of_a_drive_and_cannot_be_is_told(
    tmp_path: Path, said: str, part: str, told: str
) -> None:
    (tmp_path / "arm.xml").write_text(MODEL)
    spec = compile_text(ONE.format(f"@mujoco({said})", part), "a.ul").spec
    with pytest.raises(UnityLinkError) as caught, Board(spec, plant=MujocoPlant(str(tmp_path / "arm.xml"))):
        pass
    assert told in str(caught.value)
