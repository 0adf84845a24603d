# SPDX-License-Identifier: BSD-3-Clause
"""Components in the nodes of a ring: which words travel, in which node each is, and what is refused."""

from __future__ import annotations

import pytest

from unitylink.generate.spec_plan import SpecPlan
from unitylink.generate.vhdl import vhdl_files
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.interface.components import components_of
from unitylink.spec import Spec, compile_text
from unitylink.spec.model import Carried

RING = "public net(u) {{ TOSNET(COMM=u, NODES=ring); {} }} {}"
JOINT = """joint(): @ (first) {
   motor: h_bridge() @control=first+6, @status=first+2;
   shaft: quadrature_encoder(scale=0.001 rad, rate=100 Hz) @position=first;
   loop: pid(feedback=shaft.position, output=motor.duty, kp=8) @target=first+4;
}"""
WIDE = '@component("gpio") wide(): @base[2] { @value = base: u64 READ(); }'
MOTOR = "m: h_bridge() @control=0x84;"


def clean(members: str, further: str = "") -> Spec:
    result = compile_text(RING.format(members, further), "net.ul")
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def test_the_pc_sees_the_words_that_travel() -> None:
    spec = clean("j[2]: joint() @ (0x80+64*i);", JOINT)
    found = {
        path: (e.address, e.access, e.unit, e.safe) for path, e in spec.walk() if path.startswith("j[1]")
    }
    assert found == {
        "j[1].motor.control": (0xC6, "WRITE", "", 0),
        "j[1].motor.status": (0xC2, "READ", "", None),
        "j[1].shaft.position": (0xC0, "READ", "rad", None),
        "j[1].loop.target": (0xC4, "WRITE", "rad", None),
    }
    position = dict(spec.walk())["j[0].shaft.position"]
    assert position.publish is not None and position.publish.rate_hz == 100
    motor, shaft, loop = (one.component for one in spec.root().instances[1].instances)
    assert motor and shaft and loop
    assert [one.node for one in (motor, shaft, loop)] == [3, 3, 3]
    assert [one.base for one in (motor, shaft, loop)] == [0, 8, 16]  # on the bus of the node
    assert motor.carried == (Carried(0, 0xC6, True), Carried(1, 0xC2, False))
    constants = {one.name: one.initial for one in loop.constants}
    assert constants == {"control": 0, "target_velocity": 0, "target_acceleration": 0, "kp": 8}


def test_a_board_has_the_words_as_raw_ones() -> None:
    spec = clean("j: joint() @ (0x80);", JOINT)
    _, _, loop = components_of(spec, 50_000_000)
    assert (loop.node, loop.carried) == (2, ((2, 0x84, True),))
    kp = round(8 / ((1 / 4095) / 0.001 / 65536))
    assert (5, kp, kp) in loop.constants
    assert BoardConfiguration.for_spec(spec).address_bits == 11  # that of the ring: no block is on the bus


def test_parts_of_one_node_may_be_in_two_constructors() -> None:
    spec = clean(
        "a: left() @ (0x80); b: left() @ (0x81);", "left(): @ (p) { e: quadrature_encoder() @position=p; }"
    )
    first, second = components_of(spec, 50_000_000)
    assert (first.node, second.node, first.base, second.base) == (2, 2, 0, 8)


def test_a_node_may_have_parts_beside_words_for_other_logic() -> None:
    spec = clean("@lamp = 0x85: u8 WRITE(); @lit[2] = 0x81: READ(); e: quadrature_encoder() @position=0x80;")
    node = vhdl_files(SpecPlan(spec))["vhdl/net_node_2.vhd"]
    for line in (
        "    lamp     : out std_ulogic_vector(31 downto 0);",
        "    lit_1    : in  std_ulogic_vector(31 downto 0);",
        "    e_a      : in  std_ulogic;",
        "  outputs(0) <= taken(0);",
    ):
        assert line in node
    assert "position" not in node.partition("architecture")[0]


def test_a_part_without_a_word_that_travels_stays_with_the_others() -> None:
    links = "link one (BAUD=3 MHz); link two (BAUD=3 MHz); "
    text = """public net(u) { TOSNET(COMM=u, NODES=ring, LINK=one);
          m: h_bridge() @control=0x84; e: quadrature_encoder(); l: pid(e.position, m.duty) @target=0x85; }
       public other(u) { MEMORY(COMM=u, LINK=two); @x = 0x0: READ(); }"""
    spec = compile_text(links + text, "net.ul").spec
    assert spec is not None
    first, second = spec.boards
    assert [one.path for one in components_of(first, 50_000_000)] == ["m", "e", "l"]
    assert components_of(second, 50_000_000) == ()
    assert "entity unitylink.quadrature_encoder" in vhdl_files(SpecPlan(first))["vhdl/net_node_2.vhd"]


def test_an_array_travels_word_by_word() -> None:
    spec = clean("drive: pwm(channels=2) @width=(0x84,0x87), @control=0x85;")
    assert {p: e.address for p, e in spec.walk()} == {
        "drive.control": 0x85,
        "drive.width[0]": 0x84,
        "drive.width[1]": 0x87,
    }


def test_a_group_of_a_whole_component_has_what_travels() -> None:
    spec = clean("e: quadrature_encoder() @position=0x80; g = e;")
    (group,) = spec.root().groups
    assert [one.path for one in group.elements] == ["e.position"]


def test_what_travels_is_part_of_the_hash() -> None:
    one, two = (clean(f"e: quadrature_encoder() @position=0x8{n};") for n in (0, 1))
    fixed = clean("m: h_bridge(duty_bits=12) @control=0x84;")
    other = clean("m: h_bridge(duty_bits=12, dead_minimum_ns=600) @control=0x84;")
    assert one.hash != two.hash and fixed.hash != other.hash


@pytest.mark.parametrize(
    ("members", "code", "message"),
    [
        ("e: quadrature_encoder() @index_position=0x84;", "UL110", "is a READ, and 0x84 is an IN word"),
        ("e: quadrature_encoder() @stamp=0x80, @stamp=0x81;", "UL033", "`stamp` is bound twice"),
        ("e: quadrature_encoder() @speed=0x80;", "UL026", "`quadrature_encoder` has no word `speed`"),
        ("e: quadrature_encoder() @velocity=0x80;", "UL110", "`velocity` is bound to 1 addresses"),
        ("d: pwm(channels=2) @width=0x84;", "UL110", "`width` is bound to 1 addresses, and there are 2"),
        ("e: quadrature_encoder() @ (0x80);", "UL110", "where the PC does not reach its registers"),
        ("e: quadrature_encoder();", "UL110", "no word of `e` travels, so it is in no node"),
        (f"{MOTOR} e: quadrature_encoder() @position=0xC0;", "UL110", "`e` has a word in node 3"),
        (
            "e: quadrature_encoder() @position=0x80; @x = 0x81: READ(PUBLISH(on e.failed));",
            "UL102",
            "nothing has the event `e.failed`",
        ),
        (
            "e: quadrature_encoder() @position=0x80; g = e.position, e.impossible;",
            "UL110",
            "`e.impossible` does not travel in the ring",
        ),
    ],
)
def test_what_a_node_cannot_have(members: str, code: str, message: str) -> None:
    result = compile_text(RING.format(members, ""), "net.ul")
    ((found, said),) = [(d.code, d.message) for d in result.diagnostics]
    assert found == code and message in said


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ("e: quadrature_encoder() @position=0x400;", "which is no word of a joint's node"),
        ("e: quadrature_encoder() @position=0x0;", "which is no word of a joint's node"),
        ("d: wide() @value=0x83;", "`d.value` has 2 words, and from 0x83 on there is no room"),
    ],
)
def test_a_word_has_its_place_in_one_node(members: str, message: str) -> None:
    result = compile_text(RING.format(members, WIDE), "net.ul")
    errors = [(d.code, d.message) for d in result.diagnostics if d.severity == "error"]
    assert [code for code, _ in errors] == ["UL110"] and message in errors[0][1]


def test_an_act_does_not_travel() -> None:
    members = f"{MOTOR} e: quadrature_encoder(); l: pid(feedback=e.position, output=m.duty) @apply=0x85;"
    result = compile_text(RING.format(members, ""), "net.ul")
    ((code, said),) = [(d.code, d.message) for d in result.diagnostics]
    assert code == "UL110" and "`l.apply` is a PULSE" in said


def test_a_wire_stays_in_its_node() -> None:
    members = "e: quadrature_encoder() @position=0x80; d: drive(e.position) @ (0xC4);"
    drive = """drive(at: wire): @ (p) { m: h_bridge() @control=p;
       l: pid(feedback=at, output=m.duty) @target=p+1; }"""
    result = compile_text(RING.format(members, drive), "net.ul")
    ((code, said),) = [(d.code, d.message) for d in result.diagnostics]
    assert code == "UL110" and said == "`d.l` has a wire to `e`, and they are in different FPGAs"


@pytest.mark.parametrize("link", ["", "MEMORY(COMM=u);", "TOSNET(COMM=u);"])
def test_words_are_bound_only_in_a_node(link: str) -> None:
    text = f"public a({'u' if link else ''}) {{ {link} e: quadrature_encoder() @position=0x80; }}"
    codes = [d.code for d in compile_text(text, "a.ul").diagnostics]
    assert codes[0] == "UL110"
