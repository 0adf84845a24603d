# SPDX-License-Identifier: BSD-3-Clause
"""Which boards a spec has, and which part of it belongs to each."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.interface.wire_hash import wire_hash, wire_hashes
from unitylink.spec import Spec, compile_text, load

PAIR = Path(__file__).resolve().parents[3] / "examples" / "pa10" / "pa10_pair.ul"
RIG = """link lab.rig;
link left (DATA=32);
link right (DATA=16);
public rig(a, b) {
   l: part(a);
   r: other(b);
   both = l.x, r.x;
   mine = r.y;
}
public lamp(c) { MEMORY(CTRL=c, COMM=c, LINK=right); @on = 0x20: WRITE(); }
part(c) { MEMORY(CTRL=c, COMM=c, LINK=left); @x = 0x10: READ(PUBLISH(100 Hz)); }
other(c) { MEMORY(CTRL=c, COMM=c, LINK=right); @x = 0x10: READ(PUBLISH(50 Hz)); @y = 0x11: WRITE(SAFE=0); }
"""


def spec_of(text: str) -> Spec:
    result = compile_text(text, "rig.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def paths(spec: Spec) -> list[str]:
    return [path for path, _ in spec.walk()]


def test_a_board_behind_each_link() -> None:
    spec = load(PAIR)
    left, right = spec.boards
    assert (left.name, right.name) == ("left_arm", "right_arm")
    assert paths(left) == paths(right) and len(paths(left)) == 28
    assert [device.link.name for device in (*left.devices, *right.devices)] == ["left", "right"]
    assert left.hash == spec.hash, "it says from which text it comes"
    assert spec.only("left_arm") == spec.only("left") == left


def test_a_link_may_be_a_part_of_one_constructor_and_all_of_another() -> None:
    spec = spec_of(RIG)
    left, right = spec.boards
    assert left.name == "left" and paths(left) == ["l.x"], "not `rig`, which is more"
    assert right.name == "right" and paths(right) == ["rig.r.x", "rig.r.y", "lamp.on"]
    assert [[element.path for element in group.elements] for group in right.roots[0].groups] == [
        ["r.x"],
        ["r.y"],
    ]
    assert [group.name for group in left.roots[0].groups] == ["both"]
    assert [instance.name for instance in left.roots[0].instances] == ["l"]
    assert spec.only("rig").boards == (spec.only("left"), spec.only("rig").only("right"))


@pytest.mark.parametrize(
    "text",
    [
        "public a() { @x = 0x1: READ(); }",
        "public a() { @x = 0x1: READ(); } public b() { @y = 0x2: READ(); }",
        "public a() { }",
    ],
)
def test_behind_one_link_is_one_board(text: str) -> None:
    spec = spec_of(text)
    assert spec.boards == (spec,)
    assert spec.only("a").name == ("rig" if len(spec.roots) == 1 else "a")


def test_what_is_no_part_is_told() -> None:
    with pytest.raises(
        KeyError, match="no public constructor or link 'x'; there are: rig, lamp, left, right"
    ):
        spec_of(RIG).only("x")
    with pytest.raises(KeyError, match="no public constructor 'right_arm'; there are: left_arm"):
        load(PAIR).only("left_arm").only("right_arm")


def test_gateware_of_each_board_is_known_as_of_the_spec() -> None:
    spec = spec_of(RIG)
    for board in spec.boards:
        for device in board.devices:
            assert wire_hash(board) in wire_hashes(spec, device.root, device.comm)
    assert wire_hash(spec.only("left")) not in wire_hashes(spec, "lamp")
