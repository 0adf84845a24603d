# SPDX-License-Identifier: BSD-3-Clause
"""Values of a spec that say to which joint of a model they belong, and what is told if they cannot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from unitylink import connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.plants.mujoco import MujocoPlant
from unitylink.spec import compile_text, load

MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint name="pan" axis="0 0 1" armature=".02"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0" mass="1"/>
      <body pos=".3 0 0">
        <joint name="tilt" axis="0 1 0" armature=".02"/>
        <geom type="capsule" size=".02" fromto="0 0 0 .2 0 0" mass=".5"/>
        <site name="tip"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="servo_a" joint="pan" kp="80" dampratio="1"/>
    <position name="servo_b" joint="tilt" kp="80" dampratio="1"/>
  </actuator>
  <sensor><gyro name="rate" site="tip"/></sensor>
</mujoco>
"""
SPEC = """
public arm() {
   @mujoco(joint="pan", actuator="servo_a", sign=-1, zero=90)
   j[1]: axis() @ (0x10, 0x11, 0x20, 0x21);
   @mujoco(joint="tilt")
   @elbow = 0x12: f32 READ(UNIT="rad");
   @mujoco(actuator="servo_b")
   @elbow_goal = 0x22: f32 WRITE(UNIT="rad", SAFE=0);
   @mujoco(sensor="rate.z")
   @turn = 0x13: f32 READ(UNIT="deg/s");
   @raw = 0x14: READ();
   @lamp = 0x23: bool WRITE();
}
axis(): @ (position, speed, target, limit) {
   @position: i32 READ(UNIT="deg", SCALE=0.001);
   @speed: u32 READ(UNIT="deg/s", SCALE=0.001);
   @target: i32 WRITE(UNIT="deg", SCALE=0.001, MIN=-100, MAX=300);
   @limit: u32 WRITE(UNIT="deg/s", SCALE=0.001);
}
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "arm.xml").write_text(MODEL)
    return tmp_path


def plant_of(files: Path, spec: str, file: str = "arm.xml") -> MujocoPlant:
    plant = MujocoPlant(str(files / file))
    with Board(compile_text(spec, "arm.ul").spec, plant=plant):
        return plant


def refused(files: Path, spec: str, file: str = "arm.xml") -> str:
    with pytest.raises(UnityLinkError) as caught:
        plant_of(files, spec, file)
    return str(caught.value)


def test_a_joint_of_another_name_turns_the_other_way_and_has_another_zero(files: Path) -> None:
    (files / "arm.ul").write_text(SPEC)
    url = f"sim:{files / 'arm.ul'}?plant=mujoco:{files / 'arm.xml'}"
    with connect(url, time="lockstep") as link:
        arm: Any = load_spec_objects(load(files / "arm.ul"), link)
        data = link.board.plant.data
        link.step(0.0)
        assert arm["j[0].position"].read() == 90.0
        arm["j[0].limit"].write(1000.0)
        arm["j[0].target"].write(120.0)  # 30 degrees further, which is the other way for the model
        arm.elbow_goal.write(0.25)
        link.step(0.02)
        assert data.joint("pan").qvel[0] < -0.5
        assert arm["j[0].speed"].read() > 30.0  # it cannot be negative: how fast, whatever the direction
        assert arm.turn.read() == pytest.approx(57.3 * data.sensor("rate").data[2], rel=1e-3)
        link.step(0.8)
        assert data.joint("pan").qpos[0] == pytest.approx(-0.5236, abs=1e-3)
        assert arm["j[0].position"].read() == pytest.approx(120.0, abs=0.1)
        assert data.joint("tilt").qpos[0] == pytest.approx(0.25, abs=1e-3)
        assert arm.elbow.read() == pytest.approx(0.25, abs=1e-3)
        assert link.board.plant.notes == ()


COUNTS = """
public arm() {
   j[2]: axis() @ (0x10+i, 0x18+i, 0x20+i);
}
axis(): @ (position, speed, target) {
   @position: signed READ();
   @speed: READ();
   @target: signed WRITE();
}
"""
MAP = """
model = "arm.xml"
[values]
"j[0]" = {joint = "pan"}
"j[1]" = {joint = "tilt", sign = -1}
"*.position" = {unit = "deg", scale = 0.01, zero = -10}
"*.target" = {unit = "deg", scale = 0.01, zero = -10}
"*.speed" = {unit = "deg/s", scale = 0.01}
"""


def test_a_file_beside_the_model_gives_units_to_a_spec_that_has_none(files: Path) -> None:
    (files / "arm.ul").write_text(COUNTS)
    (files / "arm.toml").write_text(MAP)
    with connect(f"sim:{files / 'arm.ul'}?plant=mujoco:{files / 'arm.toml'}", time="lockstep") as link:
        arm: Any = load_spec_objects(load(files / "arm.ul"), link)
        data = link.board.plant.data
        link.step(0.0)
        assert arm["j[0].position"].read() == -1000  # its zero is at -10 degrees
        arm["j[0].target"].write(2000)
        arm["j[1].target"].write(2000)
        link.step(1.0)
        assert data.qpos == pytest.approx([0.5236, -0.5236], abs=1e-3)
        assert arm["j[1].position"].read() == pytest.approx(2000, abs=2)
        assert link.board.plant.notes == ()


ONE = "public arm() {{ {} @elbow = 0x10: {} }}"


@pytest.mark.parametrize(
    ("spec", "told"),
    [
        (
            ONE.format('@mujoco(joint="tlit")', 'f32 READ(UNIT="rad");'),
            "the model has no joint 'tlit'; nearest: tilt",
        ),
        (
            ONE.format('@mujoco(actuator="servo_c")', 'f32 WRITE(UNIT="rad");'),
            "elbow: @mujoco of elbow: the model has no actuator 'servo_c'; nearest: servo_",
        ),
        (
            ONE.format('@mujoco(joint="tilt")', 'f32 READ(UNIT="mm");'),
            "it has mm in 1 words, and does not fit there: position of tilt (rad), velocity of tilt (rad/s), "
            "effort of tilt (N m)",
        ),
        (
            ONE.format('@mujoco(actuator="servo_a")', 'f32 WRITE(UNIT="N m");'),
            "it has N m in 1 words, and does not fit there: actuator servo_a (rad), speed limit of servo_a (",
        ),
        (
            ONE.format('@mujoco(actuator="servo_a")', "f32 READ();"),
            "the PC reads it; name a joint or a sensor",
        ),
        (ONE.format('@mujoco(jiont="tilt")', "f32 READ();"), "there is no key 'jiont'; nearest: joint"),
        (ONE.format('@mujoco("tilt")', "f32 READ();"), "'tilt' has no key; there are joint, actuator"),
        (ONE.format('@mujoco(joint="tilt", sign=2)', "f32 READ();"), "sign is 2; it must be 1 or -1"),
        (
            ONE.format('@mujoco(unit="deg")', 'f32 READ(UNIT="rad");'),
            "elbow: it has the unit rad in the spec",
        ),
        (
            ONE.format('@mujoco(actuator="servo_a")', 'f32 WRITE(UNIT="rad"); ')[:-1]
            + '@mujoco(joint="pan") @other = 0x11: f32 WRITE(UNIT="rad"); }',
            "other: @mujoco of other: elbow commands the actuator servo_a (rad) already; name another",
        ),
    ],
)
def test_what_a_spec_says_and_cannot_be_is_told(files: Path, spec: str, told: str) -> None:
    assert told in refused(files, spec)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('model = "arm.xml"\n[values."j[0].positon"]\nunit="deg"', "of this name; nearest: j[0].position"),
        ('model = "arm.xml"\n[values."j[0].speed"]\nunit="furlong"', "there is no unit 'furlong'"),
        ('model = "arm.xml"\n[values."*"]\nscale=0', "scale is 0; it must be"),
        ('model = "arm.xml"\n[values]\n"*" = 3', 'values."*": it is 3; write { joint'),
        ('model = "other.xml"', "other.xml: there is no such file"),
        ("[values]", 'it must name the model: model = "robot.xml"'),
        ('models = "arm.xml"', "there is no key 'models'; there are model, shared, values"),
        ("model =", "arm.toml: Invalid value"),
    ],
)
def test_a_file_beside_the_model_with_a_mistake_is_told(files: Path, text: str, told: str) -> None:
    (files / "arm.toml").write_text(text)
    assert told in refused(files, COUNTS, "arm.toml")


def test_a_place_without_a_value_is_named_with_the_nearest_values(files: Path) -> None:
    spec = ONE.format('@mujoco(joint="pan")', 'f32 READ(UNIT="rad"); @servo_x = 0x11: f32 WRITE(UNIT="rad");')
    assert plant_of(files, spec).notes == (
        "servo_x belongs to nothing in the model; nearest: servo_b, servo_a",
        "no value shows the position of joint tilt; nearest: none",
        "no value drives the actuator servo_a; nearest: servo_x",
        "no value drives the actuator servo_b; nearest: servo_x",
    )


LINK = (
    '<robot name="arm"><link name="base"/><link name="upper">{}</link><joint name="elbow" type="continuous">'
)
LINK += '<parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint></robot>'


def test_a_urdf_without_inertia_is_told(files: Path) -> None:
    spec = ONE.format("", 'f32 READ(UNIT="rad");')
    (files / "arm.xml").write_text(LINK.format(""))
    assert "Links without <inertial>: upper; give them mass and inertia" in refused(files, spec)
    box = '<collision><geometry><box size=".1 .1 .1"/></geometry></collision>'
    (files / "arm.xml").write_text(LINK.format(box))
    plant = plant_of(files, spec)
    assert plant.notes == ("link upper of arm.xml has no <inertial>; it has the mass of its shapes in water",)
    assert plant.model.body_mass[1] == pytest.approx(1.0)
