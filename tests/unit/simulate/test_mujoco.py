# SPDX-License-Identifier: BSD-3-Clause
"""A model of MuJoCo behind a virtual board: bound by name and unit, in steps, and what goes wrong."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from unitylink import connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.plants.mujoco import MujocoPlant
from unitylink.spec import compile_text, load

SPEC = """
public arm() {
   shoulder: joint("shoulder") @ (0x10, 0x11, 0x12, 0x20);
   @lift = 0x13: u16 READ(UNIT="mm", SCALE=0.1, OFFSET=-100);
   @lift_force = 0x21: i16 WRITE(UNIT="N", SCALE=0.1, MIN=-200, MAX=200, SAFE=0);
   @tilt = 0x14: f32 READ(UNIT="m/s^2");
}
joint(n: string): @ (position, speed, torque, target) {
   @position: i16 READ(UNIT="deg", SCALE=0.01, PUBLISH(100 Hz));
   @speed: i16 READ(UNIT="rad/s", SCALE=0.001);
   @torque: i32 READ(UNIT="N m", SCALE=0.0001);
   @target: i16 WRITE(UNIT="deg", SCALE=0.01, MIN=-170, MAX=170, SAFE=0);
}
"""
MODEL = """
<mujoco>
  <option timestep="0.0005" integrator="implicitfast"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder_joint" type="hinge" axis="0 1 0" damping="0.2" armature="0.02"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0" mass="1"/>
      <body name="carriage" pos=".3 0 0">
        <joint name="lift" type="slide" axis="0 0 1" range="-.1 .1" limited="true" damping="5"/>
        <geom type="sphere" size=".03" mass=".5"/>
        <site name="tip"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder" joint="shoulder_joint" kp="80" dampratio="1"/>
    <motor name="lift_force" joint="lift"/>
  </actuator>
  <sensor><actuatorfrc name="tilt" actuator="lift_force"/></sensor>
</mujoco>
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "arm.ul").write_text(SPEC)
    (tmp_path / "arm.xml").write_text(MODEL)
    return tmp_path


@contextmanager
def robot(files: Path) -> Iterator[tuple[Any, Any]]:
    url = f"sim:{files / 'arm.ul'}?plant=mujoco:{files / 'arm.xml'}"
    with connect(url, time="lockstep") as link:
        yield link, load_spec_objects(load(files / "arm.ul"), link)


def test_values_are_those_of_the_model_in_the_units_of_the_spec(files: Path) -> None:
    with robot(files) as (link, arm):
        arm.shoulder.target.write(30.0)
        arm.lift_force.write(7.5)
        for _ in range(50):
            link.step(0.001)
        model = mujoco.MjModel.from_xml_path(str(files / "arm.xml"))
        data = mujoco.MjData(model)
        steps = link.board.statistics.plant_steps
        data.ctrl[:] = 0.0
        # the first step of the board is at its reset, and shows where the model begins
        moved = round((link.board.plant.data.time) / model.opt.timestep)
        assert moved == 2 * (steps - 1)
        data.ctrl[:] = np.radians(30.0), 7.5
        mujoco.mj_step(model, data, moved)
        np.testing.assert_allclose(link.board.plant.data.qpos, data.qpos, rtol=1e-9)
        link.step(0.0)
        assert arm.shoulder.position.read() == pytest.approx(np.degrees(data.qpos[0]), abs=0.006)
        assert arm.shoulder.speed.read() == pytest.approx(data.qvel[0], abs=0.0006)
        assert arm.shoulder.torque.read() == pytest.approx(data.qfrc_actuator[0], abs=0.0001)
        assert arm.lift.read() == pytest.approx(data.qpos[1] * 1000, abs=0.06)
        assert arm.tilt.read() == pytest.approx(data.sensordata[0], rel=1e-6)
        assert abs(data.qpos[0]) > 0.05


def test_a_set_point_is_reached(files: Path) -> None:
    with robot(files) as (link, arm):
        arm.shoulder.target.write(-45.0)
        link.step(3.0)
        assert arm.shoulder.position.read() == pytest.approx(-45.0, abs=6.0)  # it carries its weight
        assert link.board.plant.notes == ()


def test_two_runs_are_equal(files: Path) -> None:
    def run() -> list[float]:
        with robot(files) as (link, arm):
            told = []
            for turn in range(40):
                arm.lift_force.write(float(turn % 7))
                link.step(0.01)
                told.append(arm.lift.read())
            return told

    assert run() == run()


def test_what_belongs_to_nothing_is_named(files: Path, caplog: pytest.LogCaptureFixture) -> None:
    text = SPEC.replace("@lift_force", "@lfit_force").replace("@lift =", "@height =")
    (files / "arm.ul").write_text(text)
    with caplog.at_level(logging.WARNING), robot(files) as (link, _):
        notes = "\n".join(link.board.plant.notes)
    assert "height belongs to nothing in the model; nearest: " in notes
    assert "lfit_force belongs to nothing in the model; nearest: lift_force" in notes
    assert "no value shows the position of joint lift" in notes
    assert "no value drives the actuator lift_force" in notes
    assert "no value drives the actuator lift_force" in caplog.text


def test_a_model_that_blows_up_ends_the_plant_and_names_the_joint(
    files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(files)
    wild = MODEL.replace('timestep="0.0005" integrator="implicitfast"', 'timestep="0.01" integrator="Euler"')
    wild = wild.replace('kp="80" dampratio="1"', 'kp="1e9" kv="1e8"')
    (files / "arm.xml").write_text(wild)
    with robot(files) as (link, arm):
        arm.lift_force.write(7.5)
        arm.shoulder.target.write(90.0)
        link.step(5.0)
        told = r"unstable at \d\.\d+ s, first at joint '(shoulder_joint|lift)'; use a shorter timestep"
        assert re.search(told, str(link.board.error))
        assert (link.board.registers[0x20], link.board.registers[0x21]) == (0, 0)  # their SAFE values
        begun = arm.shoulder.position.read()
        link.step(0.1)
        assert arm.shoulder.position.read() == begun  # it has ended
    assert sorted(file.name for file in files.iterdir()) == ["arm.ul", "arm.xml"]  # and no log of MuJoCo


@pytest.mark.parametrize(
    ("text", "told"),
    [("<mujoco><nonsense/></mujoco>", "nonsense"), ("no xml", "XML"), (None, "there is no such file")],
)
def test_a_model_that_is_wrong_is_told(files: Path, text: str | None, told: str) -> None:
    file = files / "wrong.xml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(UnityLinkError, match=told):
        MujocoPlant(str(file))


def test_a_model_of_another_robot_is_refused(files: Path) -> None:
    spec = compile_text("public lamp() { @led = 0x1: bool WRITE(); }", "lamp.ul").spec
    with pytest.raises(
        UnityLinkError, match=r"no joint belongs to a value. Its joints: shoulder_joint, lift"
    ):
        Board(spec, plant=MujocoPlant(str(files / "arm.xml")))


def test_a_urdf_is_a_model_too(files: Path) -> None:
    (files / "arm.xml").write_text(
        '<robot name="arm"><link name="base"/><link name="upper"><inertial><mass value="1"/>'
        '<origin xyz="0.1 0 0"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>'
        '</link><joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="5"/></joint></robot>'
    )
    with robot(files) as (link, arm):
        link.step(0.2)
        assert arm.shoulder.position.read() > 1.0  # it falls


def test_another_board_goes_on_from_the_state_of_a_model(files: Path) -> None:
    url = f"sim:{files / 'arm.ul'}?plant=mujoco:{files / 'arm.xml'}"
    with robot(files) as (link, arm):
        arm.shoulder.target.write(30.0)
        link.step(0.05)
        state = link.board.save()
        link.step(0.05)
        went_on = link.board.plant.data.qpos.tolist(), arm.shoulder.position.read()
    for _ in range(2):
        with connect(url, time="lockstep", state=state) as link:
            link.step(0.05)
            arm = load_spec_objects(load(files / "arm.ul"), link)
            assert (link.board.plant.data.qpos.tolist(), arm.shoulder.position.read()) == went_on


IMU = """
public box() {
   imu: imu() @ (0x10, 0x20, 0x22, 0x30);
   @height = 0x40: u16 READ(UNIT="mm");
   @way[3] = 0x50: f32 READ(UNIT="m");
}
imu(): @ (acceleration, gyro_x, gyro_z, attitude_w) {
   @acceleration[3]: i16 READ(UNIT="m/s^2", SCALE=0.001);
   @gyro_x: i16 READ(UNIT="deg/s", SCALE=0.1);
   @gyro_z: i16 READ(UNIT="deg", SCALE=0.1);
   @attitude_w: f32 READ();
}
"""
FALLING = """
<mujoco>
  <option timestep="0.001" gravity="0 0 -9.81"/>
  <worldbody>
    <geom type="plane" size="5 5 .1"/>
    <body name="box" pos="0 0 .1">
      <freejoint/>
      <geom type="box" size=".1 .1 .1" mass="1"/>
      <site name="middle"/>
    </body>
  </worldbody>
  <sensor>
    <accelerometer name="acceleration" site="middle"/>
    <gyro name="gyro" site="middle"/>
    <framequat name="attitude" objtype="site" objname="middle"/>
    <framepos name="way" objtype="site" objname="middle"/>
    <rangefinder name="height" site="middle"/>
  </sensor>
</mujoco>
"""


def test_sensors_of_several_numbers_are_read_by_part(tmp_path: Path) -> None:
    (tmp_path / "arm.ul").write_text(IMU)
    (tmp_path / "arm.xml").write_text(FALLING)
    with robot(tmp_path) as (link, box):
        link.step(0.5)  # it has come to rest
        assert box["imu.acceleration[0]"].read() == pytest.approx(0, abs=0.02)
        assert box["imu.acceleration[2]"].read() == pytest.approx(9.81, abs=0.05)
        assert box.imu.gyro_x.read() == pytest.approx(0, abs=0.5)
        assert box.imu.attitude_w.read() == pytest.approx(1, abs=1e-4)
        assert box["way[2]"].read() == pytest.approx(0.1, abs=2e-3)
        notes = link.board.plant.notes
    assert "imu.gyro_z is left out: it has deg, and the sensor gyro.z measures rad/s" in notes


ROBOTS = Path(__file__).parents[3] / "examples"


def test_a_speed_limits_how_fast_a_position_moves_and_zero_holds_it() -> None:
    """The PA10 that comes along: its limits are SAFE=0, so the dead-man holds it where it is."""
    model = ROBOTS / "pa10" / "pa10_pair.toml"
    url = f"sim:{ROBOTS / 'pa10' / 'pa10_pair.ul'}?plant=mujoco:{model}&root=left_arm&deadman=0.05"
    with connect(url, time="lockstep") as link:
        arm: Any = load_spec_objects(link.board.spec, link)
        assert link.board.plant.notes == ()
        arm["arm.j[3].target"].write(1.0)
        link.step(0.2)
        assert arm["arm.j[3].pos"].read() == pytest.approx(0.0, abs=1e-3)
        arm["arm.j[3].limit"].write(2.0)
        link.step(0.3)
        assert arm["arm.j[3].speed"].read() == pytest.approx(2.0, rel=0.02)
        assert arm["arm.j[3].pos"].read() == pytest.approx(0.6, abs=0.06)
        link.trip()
        link.step(0.2)
        held = arm["arm.j[3].pos"].read()
        link.step(0.5)
        assert held == pytest.approx(0.6, abs=0.06)
        assert arm["arm.j[3].pos"].read() == pytest.approx(held, abs=1e-3)
        link.reset()
        assert arm["arm.j[3].pos"].read() == 0.0
        arm["arm.j[3].limit"].write(2.0)
        arm["arm.j[3].target"].write(1.0)
        link.step(0.7)
        assert arm["arm.j[3].pos"].read() == pytest.approx(1.0, abs=1e-3)


def test_the_scara_that_comes_along_moves_all_its_joints() -> None:
    folder = ROBOTS / "dashboard"
    with connect(f"sim:{folder / 'arm.ul'}?plant=mujoco:{folder / 'arm.xml'}", time="lockstep") as link:
        arm: Any = load_spec_objects(link.board.spec, link)
        assert link.board.plant.notes == ()
        goals = {"j1": 90.0, "j2": -45.0, "j3": 100.0, "j4": 200.0}
        for name, goal in goals.items():
            arm[f"{name}.spd_sp"].write(300.0)
            arm[f"{name}.pos_sp"].write(goal)
        link.step(1.5)
        for name, goal in goals.items():
            assert arm[f"{name}.cpos"].read() == pytest.approx(goal, abs=0.1), name
