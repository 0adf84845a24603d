# SPDX-License-Identifier: BSD-3-Clause
"""Components at the joints of a model of MuJoCo: motors turn them by pins, and encoders show them at pins."""

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
from unitylink.simulate.machine import BRUSHLESS, MOTORS, DcMotor, Gear
from unitylink.simulate.plants.mujoco import MujocoPlant
from unitylink.spec import compile_text, load

MODEL = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body name="arm">
      <joint name="elbow" type="hinge" axis="0 0 1"/>
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
      <site name="pad"/>
    </body>
    <geom type="box" size=".1 1 1" pos="1.6 0 1"/>
  </worldbody>
  <actuator>
    <motor name="elbow_motor" joint="elbow" gear="2" ctrllimited="true" ctrlrange="-40 40"/>
    <position name="finger_servo" joint="finger" kp="20" dampratio="1"/>
  </actuator>
  <sensor>
    <rangefinder name="ahead" site="nose"/>
    <force name="grip" site="pad"/>
  </sensor>
</mujoco>
"""
DRIVEN = """
link axis (ADDRESS=8);
public axis() {
   @mujoco(motor="maxon RE 40", ratio=26, supply_v=24)
   elbow: geared();
}
geared() {
   drive: h_bridge(form=1, dead_minimum_ns=20);
   wheel: quadrature_encoder(scale=2*pi/52000 rad, with_velocity=1);
}
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "arm.xml").write_text(MODEL)
    return tmp_path


@contextmanager
def robot(files: Path, spec: str, plant: str = "arm.xml") -> Iterator[tuple[Any, Any, Any]]:
    (files / "arm.ul").write_text(spec)
    with connect(f"sim:{files / 'arm.ul'}?plant=mujoco:{files / plant}", time="lockstep") as link:
        yield link, load_spec_objects(load(files / "arm.ul"), link), link.board.plant.data


def _turned(motor: DcMotor, seconds: float) -> float:
    before = motor.angle_rad
    motor.step(12.0, seconds)
    return motor.angle_rad - before


def test_a_bridge_turns_a_joint_as_the_motor_of_the_library_does_and_an_encoder_counts(files: Path) -> None:
    motor = DcMotor(MOTORS["maxon RE 40"], Gear(ratio=26), load_inertia_kg_m2=0.01)
    with robot(files, DRIVEN) as (link, axis, data):
        axis["elbow.drive.duty"].write(0.5)
        axis["elbow.drive.control"].write({"enable": True, "coast": False})
        link.step(0.15)
        before = axis["elbow.wheel.position"].read()
        assert before == pytest.approx(_turned(motor, 0.15), abs=0.15)  # it has to be switched on first
        link.step(0.15)
        counted = axis["elbow.wheel.position"].read()
        assert counted - before == pytest.approx(_turned(motor, 0.15), rel=0.005)
        assert counted == pytest.approx(data.joint("elbow").qpos[0], abs=0.02)  # what it does in a step
        assert axis["elbow.wheel.velocity"].read() == pytest.approx(motor.speed_rad_s, rel=0.01)
        assert abs(counted / (2 * math.pi / 52000) - round(counted / (2 * math.pi / 52000))) < 1e-6

        axis["elbow.drive.control"].write({"enable": False, "coast": False})  # all gates off: it rolls
        link.step(0.05)
        assert data.joint("elbow").qvel[0] > 0.8 * motor.speed_rad_s
        link.reset()
        link.step(0.1)
        assert axis["elbow.wheel.position"].read() == 0.0 and data.joint("elbow").qpos[0] == 0.0


BY_FILE = """
link bench (ADDRESS=8);
public bench() {
   drive: pwm(channels=4, scale=1/4096);
   lines: quadrature_encoder(scale=0.01 mm);
   pads: gpio(pins=2);
   wing: rc_servo(channels=2);
   front: sonar();
   axes: stepgen(axes=1, scale=0.1 deg);
}
"""
FILE = """
model = "arm.xml"
[motors."mine"]
nominal_v = 12
resistance_ohm = 1.2
inductance_mh = 0.5
torque_constant_mnm_a = 25
rotor_inertia_g_cm2 = 50
no_load_current_ma = 100
[values]
"drive" = {joint = "slide", motor = "mine", turn_m = 0.02, channel = 2, reverse_channel = 3, sign = -1}
"lines" = {joint = "slide", sign = -1}
"pads" = [{joint = "slide", above = -0.005}, {joint = "slide", channel = 1, below = -30, unit = "mm"}]
"wing" = {joint = "finger", channel = 1, zero = -10}
"front" = {sensor = "ahead"}
"""


def test_a_slide_a_servo_switches_and_a_sonar_are_at_the_model_by_its_file(files: Path) -> None:
    (files / "arm.toml").write_text(FILE)
    with robot(files, BY_FILE, "arm.toml") as (link, bench, data):
        link.step(0.002)
        assert bench["pads.levels"].read() == 0b01  # closed above -5 mm
        bench["drive.width[2]"].write(0.5)
        bench["drive.control"].write({"enable": True})
        bench["wing.width[1]"].write(1800)
        bench["wing.control"].write({"enable": True})
        link.step(0.4)
        slide = data.joint("slide").qpos[0]
        assert -0.5 < slide < -0.03  # the other way, as sign says
        assert bench["lines.position"].read() == pytest.approx(-1000 * slide, abs=2.0)
        assert bench["pads.levels"].read() == 0b10
        assert data.joint("finger").qpos[0] == pytest.approx(math.radians(30 + 10), abs=0.01)
        assert bench["front.distance"].read() == pytest.approx(1500 - 1000 * slide, abs=60)


HALL = """
link joint (ADDRESS=8);
public joint() {
   @mujoco(joint="elbow", motor="GBM2804H-100T", supply_v=12)
   motor: three_phase_pwm();
   @mujoco(joint="elbow")
   rotor: hall(scale=2*pi/42 rad);
   @mujoco(joint="elbow")
   current: sigma_delta_adc(channels=2, full_scale=8 A);
}
"""


def test_the_field_of_an_inverter_takes_a_joint_along_and_hall_sensors_count_its_sectors(files: Path) -> None:
    (files / "arm.xml").write_text(MODEL.replace("0.01 0.01 0.01", "5e-4 5e-4 5e-4"))
    with robot(files, HALL) as (link, joint, data):
        duty = [joint[f"motor.duty[{phase}]"] for phase in range(3)]
        joint["motor.control"].write({"enable": True, "sample_start": False, "sample_middle": False})
        joint["current.control"].write({"enable": True})
        for tenth in range(16):  # a field that turns by a sixth of an electrical turn in 40 ms
            angle = math.pi / 3 * tenth / 4
            for phase in range(3):
                duty[phase].write(0.8 * math.cos(angle - 2 * math.pi / 3 * phase))
            link.step(0.01)
        assert data.joint("elbow").qpos[0] == pytest.approx(2 * math.pi * 16 / 4 / 6 / 7, abs=0.2)
        sectors = joint["rotor.position"].read() / (2 * math.pi / 42)
        assert abs(sectors - data.joint("elbow").qpos[0] / (2 * math.pi / 42)) <= 1
        assert abs(joint["current.value[0]"].read()) < 12 / BRUSHLESS["GBM2804H-100T"].resistance_ohm
        assert any(abs(joint[f"current.value[{channel}]"].read()) > 0.1 for channel in range(2))


ONE = "link a(ADDRESS=8); public a() {{ {} {} }}"


@pytest.mark.parametrize(
    ("said", "part", "told"),
    [
        ('@(joint="elbo")', "w: encoder(scale=1 deg);", "no joint 'elbo'; nearest: elbow"),
        (
            '@(joint="elbow")',
            "w: encoder();",
            "w.position has no unit, so nobody knows what",
        ),
        (
            '@(joint="slide")',
            "w: encoder(scale=1 deg);",
            "has deg, and does not fit there: m",
        ),
        (
            '@(joint="elbow", zero=3)',
            "w: encoder(scale=1 deg);",
            "zero says nothing about a",
        ),
        ('@(joint="slide")', "d: h_bridge();", 'say motor="…" (maxon RE 40'),
        (
            '@(joint="elbow", motor="maxon RE 04")',
            "d: h_bridge();",
            "nearest: maxon RE 40, maxon RE 30",
        ),
        ('@(joint="finger", motor="maxon RE 40")', "d: h_bridge();", "would work against a motor"),
        ('@(actuator="elbow_moter", motor="maxon RE 40")', "d: h_bridge();", "nearest: elbow_motor"),
        ('@(joint="slide", motor="maxon RE 40")', "d: h_bridge();", "is a slide; say turn_m"),
        ('@(joint="elbow", motor="Mini Cheetah")', "d: three_phase_pwm();", "say supply_v"),
        ('@(joint="elbow")', "s: stepgen(axes=1, scale=1 deg);", "give it a <position> actuator"),
        ('@(joint="elbow", below=1)', "e: h_bridge();", "say port: which input of the h_bridge"),
        ('@(joint="elbow")', "p: gpio(pins=1);", "give either below or above"),
        ('@(sensor="grip.x")', "f: sonar();", "and sensor grip.x (N) is none; name a rangefinder"),
        ('@(joint="elbow")', "u: uart_bridge();", "uart_bridge is at no joint"),
        ('@(jiont="elbow")', "p: gpio(pins=1);", "there is no key 'jiont'; nearest: joint"),
    ],
)
def test_what_is_said_of_a_component_and_cannot_be_is_told(
    files: Path, said: str, part: str, told: str
) -> None:
    text = ONE.format(said.replace("@(", "@mujoco("), part.replace("encoder(", "quadrature_encoder("))
    spec = compile_text(text, "a.ul").spec
    with pytest.raises(UnityLinkError) as caught, Board(spec, plant=MujocoPlant(str(files / "arm.xml"))):
        pass
    assert told in str(caught.value)
