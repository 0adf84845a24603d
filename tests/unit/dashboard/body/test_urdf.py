# SPDX-License-Identifier: BSD-3-Clause
"""A URDF is read with care: what is wrong is named, and nothing outside of the robot's folder is opened."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from unitylink.dashboard.body import robot_file, stl, xml_tree
from unitylink.dashboard.body.body import Shape
from unitylink.dashboard.body.mesh_files import mesh_file
from unitylink.dashboard.body.urdf import read_urdf
from unitylink.errors import UnityLinkError

ROOT = Path(__file__).resolve().parents[4]
TWO = """
<robot name="two">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="a"><visual><geometry>{shape}</geometry><material name="red"/></visual></link>
  <link name="b">
    <collision><origin xyz="1 2 3" rpy="0 0 1"/><geometry><sphere radius="2"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 2"/></joint>
  {more}
</robot>
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "robot.urdf"
    file.write_text(text)
    return file


def two(folder: Path, shape: str = '<box size="1 2 3"/>', more: str = "") -> Path:
    return written(folder, TWO.format(shape=shape, more=more))


def binary_stl(triangles: int) -> bytes:
    each = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    return b"\0" * 80 + struct.pack("<I", triangles) + each * triangles


def test_links_shapes_and_joints(tmp_path: Path) -> None:
    body = read_urdf(two(tmp_path))
    (box,), (ball,) = (link.shapes for link in body.links)
    assert box == Shape("box", (1.0, 2.0, 3.0), colour=(1.0, 0.0, 0.0, 1.0))
    assert (ball.kind, ball.size, ball.xyz, ball.rpy) == ("sphere", (2.0,), (1.0, 2.0, 3.0), (0.0, 0.0, 1.0))
    (hinge,) = body.joints
    assert (hinge.parent, hinge.child, hinge.axis, hinge.turns) == ("a", "b", (0.0, 0.0, 1.0), True)
    told = body.told()
    assert told["links"][0]["shapes"][0]["kind"] == "box" and told["joints"][0]["mimic"] is None


def test_the_arm_of_the_example() -> None:
    body = read_urdf(ROOT / "examples" / "dashboard" / "arm.urdf")
    assert [joint.name for joint in body.joints if joint.moves] == ["shoulder", "elbow", "lift", "tool"]
    assert body.notes == ()


def test_meshes(tmp_path: Path) -> None:
    robot = tmp_path / "my_arm"
    (robot / "urdf").mkdir(parents=True)
    (robot / "meshes").mkdir()
    (robot / "meshes" / "a b.stl").write_bytes(binary_stl(3))
    text = (
        "solid x\n facet normal 0 0 1\n outer loop\n"
        + "vertex 0 0 1\nvertex 1 0 0\nvertex 0 1 0\n"
        + "endloop\n"
    )
    (robot / "urdf" / "b.STL").write_text(text)
    mesh = '<mesh filename="package://my_arm/meshes/a%20b.stl" scale="0.001 0.001 0.001"/>'
    body = read_urdf(two(robot / "urdf", mesh))
    assert body.links[0].shapes[0].size == (0.001, 0.001, 0.001) and len(body.meshes[0].triangles) == 3 * 36
    body = read_urdf(two(robot / "urdf", '<mesh filename="b.STL"/>'))
    assert struct.unpack("<9f", body.meshes[0].triangles) == (0, 0, 1, 1, 0, 0, 0, 1, 0)
    (robot / "urdf" / "c.dae").write_text("")
    body = read_urdf(two(robot / "urdf", '<mesh filename="c.dae"/>'))
    assert body.links[0].shapes == () and "only STL meshes are drawn" in body.notes[0]


@pytest.mark.parametrize(
    "name",
    [
        "../../../etc/passwd",
        "/etc/passwd",
        "file:///etc/passwd",
        "https://example.org/a.stl",
        "package://my_arm/../../secret.stl",
        "package://other/a.stl",
        "package:///a.stl",
        "../secret.stl",
        "link.stl",
        "loop.stl",
        "absent.stl",
        "",
        "%00",
    ],
)
def test_no_mesh_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    robot = tmp_path / "my_arm"
    robot.mkdir()
    (tmp_path / "secret.stl").write_bytes(binary_stl(1))
    (robot / "link.stl").symlink_to(tmp_path / "secret.stl")
    (robot / "loop.stl").symlink_to(robot / "loop.stl")
    with pytest.raises(UnityLinkError, match=r"robot\.urdf: mesh"):
        mesh_file(name, robot / "robot.urdf")


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE r [<!ENTITY a "ha">'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True))
    + ']><robot name="&i;"/>'
)
READER = '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="x">&x;</robot>'
LINKS = '<link name="a"/><link name="b"/>'
JOINT = '<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/>{}</joint>'


def jointed(more: str) -> str:
    return f"<robot>{LINKS}{JOINT.format('j', 'a', 'b', more)}</robot>"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (BOMB, "a DOCTYPE is not read"),
        (READER, "a DOCTYPE is not read"),
        ("", "no element found"),
        ("<robot", "line 1"),
        ("<robot>" * 100, "within each other"),
        ('<robot xmlns:xacro="x"><xacro:macro/></robot>', "xacro FILE"),
        ("<mujoco/>", "no URDF: its root is"),
        ("<robot/>", "0 links"),
        (f"<robot>{LINKS}</robot>", "2 links without a parent"),
        ('<robot><link name="a"/><link name="a"/></robot>', "two links have the name"),
        ("<robot><link/></robot>", "has no name"),
        (f"<robot>{LINKS}{JOINT.format('j', 'a', 'c', '')}</robot>", "there is no link 'c'"),
        (f"<robot>{LINKS}{JOINT.format('j', 'a', 'b', '') * 2}</robot>", "two joints have the name"),
        (
            f"<robot>{LINKS}{JOINT.format('j', 'a', 'b', '')}{JOINT.format('k', 'b', 'a', '')}</robot>",
            "0 links without a parent",
        ),
        (
            jointed("").replace("</robot>", JOINT.format("k", "b", "a", "") + '<link name="c"/></robot>'),
            "above itself",
        ),
        (jointed('<mimic joint="x"/>'), "which is not there"),
        (jointed('<axis xyz="0 0 0"/>'), "no direction"),
        (jointed('<origin xyz="nan 0 0"/>'), "expected 3 numbers"),
        (jointed('<origin xyz="1e300 0 0"/>'), "expected 3 numbers"),
        (TWO.format(shape='<box size="1 2"/>', more=""), "expected 3 numbers"),
        (TWO.format(shape="<teapot/>", more=""), "the shape 'teapot' is not known"),
        (TWO.format(shape="", more=""), "one geometry with one shape"),
        ('<?xml version="1.0" encoding="klingon"?><robot/>', "encoding"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UnityLinkError) as raised:
        read_urdf(written(tmp_path, text))
    assert said in str(raised.value) and "robot.urdf" in str(raised.value) and len(str(raised.value)) < 1000


def test_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.stl").write_bytes(binary_stl(100))
    file = two(tmp_path, '<mesh filename="a.stl"/>')
    for module, name, value, said in (
        (stl, "MOST_TRIANGLES", 99, "more than the 99"),
        (stl, "MOST_BYTES", 1000, "simplify the mesh"),
        (robot_file, "MOST_BYTES", 1000, "simplify them"),
        (robot_file, "MOST_LINKS", 1, "2 links"),
        (xml_tree, "MOST_BYTES", 100, "no URDF needs"),
        (xml_tree, "MOST_ELEMENTS", 5, "5 in all"),
    ):
        with monkeypatch.context() as patched:
            patched.setattr(module, name, value)
            with pytest.raises(UnityLinkError, match=said):
                read_urdf(file)
    with pytest.raises(UnityLinkError, match="absent"):
        read_urdf(tmp_path / "absent.urdf")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"solid",
        b"solid x\nfacet\nvertex 1 2 3\n",
        b"solid x\nfacet\nvertex a b c\n" * 3,
        b"solid x\nfacet\n" + b"vertex 1 nan 3\n" * 3,
        binary_stl(3)[:-1],
        binary_stl(1)[:80] + b"\xff\xff\xff\xff",
        binary_stl(1)[:96] + b"\xff\xff\xff\x7f" + binary_stl(1)[100:],
    ],
)
def test_damaged_meshes(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "a.stl").write_bytes(data)
    with pytest.raises(UnityLinkError, match=r"a\.stl: "):
        read_urdf(two(tmp_path, '<mesh filename="a.stl"/>'))
