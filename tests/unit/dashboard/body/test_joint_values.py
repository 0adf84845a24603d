# SPDX-License-Identifier: BSD-3-Clause
"""Which value moves which joint: found by name and unit, or told with the nearest ones."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from unitylink.dashboard.body.body import Body, Joint, Link, Mimic
from unitylink.dashboard.body.joint_values import with_values
from unitylink.dashboard.body.urdf import read_urdf
from unitylink.errors import UnityLinkError
from unitylink.spec import compile_text, load

EXAMPLE = Path(__file__).resolve().parents[4] / "examples" / "dashboard"
SPEC = """
axis(name: string): @ (position, old, target) {
   @position: i32 READ(UNIT="deg", PUBLISH(100 Hz));
   @old: i32 READ(UNIT="deg");
   @target: i32 WRITE(UNIT="deg");
}
public arm() {
   j1: axis("waist") @ (0x1, 0x2, 0x3);
   j2: axis("elbow") @ (0x4, 0x5, 0x6);
   @height = 0x8: i32 READ(UNIT="mm");
   @grip = 0x9: i32 READ();
}
"""


def body(*joints: tuple[str, str]) -> Body:
    links = [Link(str(number)) for number in range(len(joints) + 1)]
    made = [Joint(name, kind, str(n), str(n + 1)) for n, (name, kind) in enumerate(joints)]
    return Body("arm", tuple(links), tuple(made))


def root():  # type: ignore[no-untyped-def]
    spec = compile_text(SPEC, "arm.ul").spec
    assert spec is not None
    return spec.root()


def test_joints_are_found_by_name_and_unit() -> None:
    joints = [("waist", "revolute"), ("J2_joint", "continuous"), ("height", "prismatic"), ("end", "fixed")]
    found = with_values(body(*joints), root())
    paths = {name: moved.path for name, moved in found.moved.items()}
    assert paths == {"waist": "j1.position", "J2_joint": "j2.position", "height": "height"}
    assert found.moved["waist"].factor == pytest.approx(math.pi / 180)
    assert found.moved["height"].factor == pytest.approx(0.001)
    assert [element.path for element in root().walk()][found.moved["height"].item] == "height"
    assert found.notes == ()


def test_what_does_not_fit_is_told_with_the_nearest() -> None:
    (note,) = with_values(body(("waste", "revolute")), root()).notes
    assert note == "no value moves joint waste; nearest: j1.position, j1.target (--joint waste=ITEM)"
    (note,) = with_values(body(("waist", "prismatic")), root()).notes
    assert "nearest: height" in note
    (note,) = with_values(body(("grip", "revolute")), root()).notes
    assert note.startswith("no value moves joint grip"), "a value without a unit is no angle"
    twice = SPEC.replace("@old: i32 READ(", "@old: i32 READ(PUBLISH(100 Hz), ")
    spec = compile_text(twice, "arm.ul").spec
    assert spec is not None
    (note,) = with_values(body(("waist", "revolute")), spec.root()).notes
    assert note == "joint waist could move with j1.position, j1.old; choose one with --joint waist=ITEM"


def test_somebody_says_which() -> None:
    found = with_values(body(("spin", "revolute")), root(), {"spin": "j2.old"})
    assert found.moved["spin"].path == "j2.old" and found.notes == ()
    for name, path, said in (
        ("spun", "j2.old", "there are spin"),
        ("spin", "j2.odl", "nearest: j2.old"),
        ("spin", "height", "height has mm, but the joint is revolute"),
        ("spin", "grip", "grip has no unit"),
    ):
        with pytest.raises(UnityLinkError, match=said):
            with_values(body(("spin", "revolute")), root(), {name: path})


def test_a_joint_that_mimics_needs_no_value() -> None:
    follows = Joint("follows", "revolute", "0", "1", mimic=Mimic("waist"))
    assert with_values(Body("arm", (), (follows,)), root()).notes == ()


def test_the_example_moves_with_its_published_positions() -> None:
    found = with_values(read_urdf(EXAMPLE / "arm.urdf"), load(EXAMPLE / "arm.ul").root())
    assert {name: moved.path for name, moved in found.moved.items()} == {
        "shoulder": "j1.cpos",
        "elbow": "j2.cpos",
        "lift": "j3.cpos",
        "tool": "j4.cpos",
    }
    assert found.notes == ()
