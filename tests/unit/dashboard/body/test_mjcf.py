# SPDX-License-Identifier: BSD-3-Clause
"""An MJCF is drawn where MuJoCo draws it, and what is wrong with it is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unitylink.dashboard.body.body import Body
from unitylink.dashboard.body.mjcf import Pose, read_mjcf
from unitylink.dashboard.body.turning import about, of_eulers
from unitylink.errors import UnityLinkError

CONTENT = """
  <compiler angle="degree" eulerseq="zYx"/>
  <default>
    <geom rgba="0 0 1 1"/>
    <default class="thin">
      <geom type="capsule" size="0.1 0.2" quat="1 1 0 0"/>
      <joint axis="0 1 0"/>
    </default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="base" pos="0.1 0.2 0.3" euler="10 20 30">
      <joint name="lift" type="slide" axis="0 0 2" ref="0.05"/>
      <joint name="waist" pos="0.3 0 0.1" axis="1 0 1" ref="15"/>
      <geom name="a" type="box" size="0.1 0.2 0.3" xyaxes="1 2 0 0 1 1"/>
      <geom name="hidden" type="sphere" size="1" group="3"/>
      <frame pos="0 0 1" zaxis="1 0 1">
        <body name="arm" childclass="thin" pos="0.2 0 0" axisangle="0 1 1 40">
          <joint name="elbow" pos="0 0.1 0"/>
          <geom name="b"/>
          <geom name="c" type="cylinder" size="0.05" fromto="0 0 0 0.3 0.4 0.5"/>
          <body name="tip" pos="0 0 0.5"><geom name="d" class="main" type="sphere" size="0.1"/></body>
        </body>
      </frame>
    </body>
    <body name="ball"><freejoint/><geom name="e" size="0.2"/></body>
  </worldbody>
  <equality><joint joint1="elbow" joint2="waist" polycoef="0.1 -1 0 0 0"/></equality>
"""
# Where MuJoCo 4.0.0 has the geoms at these values, and their z axes.
VALUES = {"lift": 0.2, "waist": 0.5, "elbow": -0.4}
PLACES = {
    (0.2, 0.4, 0.6): ([0.157223, 0.099561, 0.397056], [0.934217, -0.29797, -0.196094]),
    (0.1, 0.4): ([0.614447, -0.393955, 0.948912], [0.121624, -0.307856, -0.943627]),
    (0.05, 0.5**0.5): ([0.866936, -0.241062, 1.143523], [-0.714146, -0.432446, -0.550442]),
    (0.1,): ([1.095963, -0.490768, 1.04256], [0.963031, -0.193627, 0.187296]),
    (0.2,): ([0, 0, 0], [0, 0, 1]),
}


def written(folder: Path, content: str) -> Path:
    file = folder / "robot.xml"
    file.write_text(f"<mujoco>{content}</mujoco>", encoding="utf-8")
    return file


def places(body: Body, values: dict[str, float]) -> dict[tuple[float, ...], Pose]:
    """Return where each shape is, by its size."""
    at = {body.links[0].name: Pose(np.zeros(3), np.eye(3))}
    for joint in body.joints:
        value = values.get(joint.name, 0.0)
        at[joint.child] = at[joint.parent].then(Pose(np.array(joint.xyz), of_eulers(joint.rpy, "XYZ")))
        turned = about(joint.axis, value) if joint.turns else np.eye(3)
        moved = np.array(joint.axis) * value * (joint.kind == "prismatic")
        at[joint.child] = at[joint.child].then(Pose(moved, turned))
    return {
        shape.size: at[link.name].then(Pose(np.array(shape.xyz), of_eulers(shape.rpy, "XYZ")))
        for link in body.links
        for shape in link.shapes
    }


def test_each_shape_is_where_mujoco_has_it(tmp_path: Path) -> None:
    body = read_mjcf(written(tmp_path, CONTENT))
    found = places(body, VALUES)
    assert len(found) == len(PLACES)
    for size, (xyz, z_axis) in PLACES.items():
        (pose,) = [pose for one, pose in found.items() if one == pytest.approx(size)]
        np.testing.assert_allclose(pose.at, xyz, atol=2e-6)
        np.testing.assert_allclose(pose.turned[:, 2], z_axis, atol=2e-6)


def test_colours_joints_and_what_is_left_out(tmp_path: Path) -> None:
    body = read_mjcf(written(tmp_path, CONTENT))
    assert {shape.colour for link in body.links for shape in link.shapes} == {(0, 0, 1, 1)}
    kinds = {joint.name: joint.kind for joint in body.joints}
    assert kinds == {
        "lift": "prismatic",
        "waist": "revolute",
        "elbow": "revolute",
        "to tip": "fixed",
        "joint 0 of ball": "floating",
    }
    (elbow,) = [joint for joint in body.joints if joint.name == "elbow"]
    assert elbow.mimic is not None
    assert (elbow.mimic.joint, elbow.mimic.multiplier, elbow.mimic.offset) == ("waist", -1, 0.1)
    assert any("without its plane" in note for note in body.notes)
    assert any("free" in note for note in body.notes)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ('<include file="other.xml"/>', "<include> is not read; save the whole model"),
        ('<worldbody><geom class="x"/></worldbody>', "no default class 'x'"),
        ('<worldbody><geom type="box" size="1 2"/></worldbody>', "expected 3 numbers"),
        ('<worldbody><geom type="pyramid" size="1"/></worldbody>', "the shape 'pyramid' is not known"),
        ('<worldbody><geom mesh="m"/></worldbody>', "there is no mesh 'm'"),
        ('<worldbody><geom type="capsule" size="1" fromto="1 1 1 1 1 1"/></worldbody>', "no length"),
        ('<worldbody><geom size="1" quat="0 0 0 0"/></worldbody>', "quat has no direction"),
        ('<worldbody><geom size="1" zaxis="0 0 0"/></worldbody>', "zaxis has no direction"),
        ('<worldbody><geom size="1" axisangle="0 0 0 1"/></worldbody>', "axisangle has no direction"),
        ('<worldbody><geom size="1" xyaxes="1 0 0 2 0 0"/></worldbody>', "xyaxes has no direction"),
        ('<worldbody><geom size="1" zaxis="0 0 1" euler="0 0 0"/></worldbody>', "one orientation is enough"),
        ('<compiler eulerseq="xyq"/><worldbody><geom size="1" euler="1 2 3"/></worldbody>', "three letters"),
        ('<worldbody><body><joint type="screw"/></body></worldbody>', "the type 'screw' is none of"),
        ('<worldbody><body><joint axis="0 0 0"/></body></worldbody>', "its axis has no direction"),
        ('<worldbody><body name="a"/><body name="a"/></worldbody>', "two links have the name 'a'"),
        ("<worldbody/><worldbody/>", "two links have the name 'world'"),
        ("", "0 links"),
        (
            '<worldbody><body><joint name="a"/></body></worldbody>'
            '<equality><joint joint1="a" joint2="b"/></equality>',
            "mimics 'b', which is not there",
        ),
        (
            '<asset><mesh name="m" file="../../m.stl"/></asset><worldbody><geom mesh="m"/></worldbody>',
            "outside",
        ),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, content: str, said: str) -> None:
    with pytest.raises(UnityLinkError, match=said):
        read_mjcf(written(tmp_path, content))


def test_another_file(tmp_path: Path) -> None:
    file = tmp_path / "robot.xml"
    file.write_text("<robot/>", encoding="utf-8")
    with pytest.raises(UnityLinkError, match="no MJCF: its root is 'robot'"):
        read_mjcf(file)
