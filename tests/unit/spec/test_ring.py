# SPDX-License-Identifier: BSD-3-Clause
"""The TosNet ring that a spec needs: its nodes, what it costs, and what it cannot carry."""

from __future__ import annotations

import pytest

from unitylink.spec import Spec, compile_text
from unitylink.spec.isochrony.budget import budget
from unitylink.spec.isochrony.ring import RingBudget, ring_budget, ring_budgets
from unitylink.spec.model import RingOptions
from unitylink.spec.ring import Ring, RingWord, ring_at


def clean(text: str) -> Spec:
    """Compile a text that must give no diagnostic."""
    result = compile_text(text, "net.ul")
    assert [(d.code, d.message) for d in result.diagnostics] == []
    assert result.spec is not None
    return result.spec


def ring(members: str, options: str = "") -> Ring:
    """Return the ring of a spec with these members."""
    return ring_at(clean(f"public net(u) {{ TOSNET(COMM=u, BASE=0{options}); {members} }}"), 0)


def cost(members: str, options: str = "") -> RingBudget:
    return ring_budget(ring(members, options))


def values(nodes: int, options: str = "") -> str:
    """Return a TOSNET with this many nodes of one register, the PC's node 1 included."""
    words = " ".join(f"@v{n} = 0x{n * 64:X}: READ();" for n in range(2, nodes + 1))
    own = "@own = 0x44: WRITE();" if "NODE" not in options else "@own = 0x40: WRITE();"
    return f"{own} {words}"


def test_a_word_has_its_place() -> None:
    assert RingWord.at(0x8C) == RingWord(2, 1, inward=True)
    assert RingWord.at(0x3FB) == RingWord(15, 7, inward=False)


def test_who_writes_what() -> None:
    found = ring("@a = 0x80: i64 READ(); @b = 0x8C: WRITE(); @c = 0x178: READ();")
    assert (found.own.id, found.own.registers, found.size, found.registers) == (1, 0, 3, 3)
    two, five = found.nodes
    assert (two.id, two.registers, five.id, five.registers) == (2, 0b11, 5, 0b10000000)
    assert [[e.path for e in values] for values in (two.gives, two.obeys, five.gives)] == [
        ["a"],
        ["b"],
        ["c"],
    ]


@pytest.mark.parametrize(
    ("members", "options", "own"),
    [
        ("@a = 0x80: READ();", "", 1),
        ("@a = 0x40: READ();", "", 0),  # the master must have the lowest id
        ("@a = 0x80: READ();", ", NODE=0", 0),
        ("@a = 0xC0: READ(); @b = 0x80: WRITE();", ", NODE=2", 2),
    ],
)
def test_the_node_of_the_pc(members: str, options: str, own: int) -> None:
    assert ring(members, options).own.id == own


def test_own_outputs_are_written_without_a_warning_only_if_the_node_is_stated() -> None:
    text = "public net(u) {{ TOSNET(COMM=u{}); @b = 0x80: WRITE(); }}"
    assert [d.code for d in compile_text(text.format("")).diagnostics] == ["UL054"]
    assert [d.code for d in compile_text(text.format(", NODE=2")).diagnostics] == []


@pytest.mark.parametrize(("nodes", "expected_us"), [(2, 77.6), (5, 172.4), (15, 488.4)])
def test_cycle_time_is_that_of_the_published_ring(nodes: int, expected_us: float) -> None:
    one = cost(values(nodes, "NODE"), ", NODE=1")
    assert [node.registers for node in one.nodes] == [(0,)] * nodes
    assert one.cycle_s * 1e6 == pytest.approx(expected_us)
    assert one.cycle_bytes == 18 + 32 * nodes
    assert one.inward.bound_s == pytest.approx(2 * one.cycle_s)


def test_a_faster_line_and_a_slower_cycle() -> None:
    members = "@a = 0x80: READ();"
    fast = cost(members, ", BAUD=125 MHz")
    assert fast.cycle_s == pytest.approx(cost(members).cycle_s / 10)
    slow = cost(members, ", CYCLE_RATE=1 kHz")
    assert (slow.cycle_s, slow.shortest_s) == (1e-3, cost(members).shortest_s)


def test_a_wider_check_and_a_clock_are_in_the_cycle() -> None:
    plain = cost("@a = 0x80: READ();", ", NODES=ring")
    wide = cost("@a = 0x80: READ();", ", NODES=ring, CHECK_BYTES=2")
    assert wide.cycle_bytes == plain.cycle_bytes + 1
    timed = cost("@a = 0x80: READ();", ", NODES=ring, TIME=0x48")
    assert timed.nodes[0].registers == (1,) and timed.cycle_bytes == plain.cycle_bytes + 32


def test_what_is_beyond_the_published_network_counts_in_the_hash() -> None:
    text = "public net(u) {{ TOSNET(COMM=u, NODES=ring{}); @a = 0x80: READ(); }}"
    options = ("", ", RINGS=2", ", CHECK_BYTES=2", ", TIME=0x40")
    assert len({clean(text.format(one)).hash for one in options}) == 4
    assert [clean(text.format(one)).roots[0].link.ring.exact_hops for one in options] == [
        False,
        True,
        False,
        True,
    ]


def test_options_count_in_the_hash_only_if_given() -> None:
    text = "public net(u) {{ TOSNET(COMM=u{}); @a = 0x80: READ(); }}"
    plain, stated = (clean(text.format(options)) for options in ("", ", NODE=1"))
    assert plain.roots[0].link.ring == RingOptions()
    assert plain.hash != stated.hash


@pytest.mark.parametrize(
    ("members", "options", "code", "message"),
    [
        (
            " ".join(f"@v{n} = 0x{n * 64:X}: READ();" for n in range(1, 16)),
            "",
            "UL108",
            "with the PC's own, the ring has 16 nodes, and 15 is the most",
        ),
        ("@a = 0x80: READ();", ", NODE=2", "UL108", "`a` is a value of node 2, and that is the PC's own"),
        ("@a = 0x84: WRITE();", ", NODE=2", "UL108", "`a` is a value of node 2, and that is the PC's own"),
        ("@a = 0x83: i64 READ();", "", "UL054", "`a` has 2 words, and a register has 4 of each direction"),
        ("@a = 0x0: READ();", "", "UL107", "`a` is a value of node 0"),
        ("@a = 0x80: READ();", ", NODE=3", "UL107", "node 2 has a lower id than the PC's own node 3"),
        ("@a = 0x80: READ();", ", NODE=16", "UL049", ""),
        ("@a = 0x80: READ();", ", BAUD=1 kHz", "UL049", "BAUD is 1000 Hz"),
        ("@a = 0x80: READ();", ", CYCLE_RATE=1.5 Hz", "UL049", "CYCLE_RATE is 1.5 Hz"),
        ("@a = 0x80: READ();", ", CYCLE_RATE=2 ms", "UL088", "CYCLE_RATE is in `Hz`"),
        (
            "@a = 0x80: READ();",
            ", CYCLE_RATE=20 kHz",
            "UL108",
            "the ring makes at most 19,230 cycles a second",
        ),
        ("@a = 0x80: READ();", ", CYCLE_RATE=76 Hz", "UL108", "at 76 Hz, each node would take the ring for"),
        (
            "@a = 0x80: READ(PUBLISH(1000 Hz)); @b = 0x81: READ(PUBLISH(1, 1));",
            ", CYCLE_RATE=999 Hz",
            "UL109",
            "`a` is published at 1000 Hz, and the ring makes 999 cycles a second",
        ),
        ("@a = 0x80: READ();", ", NODES=ring, RINGS=3", "UL049", "RINGS is 3"),
        (
            "@a = 0x80: READ();",
            ", RINGS=2",
            "UL108",
            "RINGS is of nodes behind a line, and here they are inside",
        ),
        ("@a = 0x80: READ();", ", CHECK_BYTES=2", "UL108", "CHECK_BYTES is of nodes behind a line"),
        ("@a = 0x80: READ();", ", NODES=ring, CHECK_BYTES=0", "UL049", "CHECK_BYTES is 0"),
        (
            "@a = 0x40: READ();",
            ", NODES=ring",
            "UL108",
            "the PC's own node is 0, and nodes on a line have the ids 1 to 15",
        ),
        ("@a = 0x80: READ();", ", NODE=0, NODES=ring, RINGS=2", "UL108", "the PC's own node is 0"),
        ("@a = 0x80: READ();", ", TIME=0x40", "UL108", "TIME is of nodes behind a line"),
        ("@a = 0x80: READ();", ", NODES=ring, TIME=0x400", "UL049", "TIME is 1,024"),
        (
            "@a = 0x80: READ();",
            ", NODES=ring, TIME=0x44",
            "UL108",
            "TIME is 0x44, which is no OUT word of the PC's own node 1",
        ),
        ("@a = 0x80: READ();", ", NODES=ring, TIME=0x80", "UL108", "TIME is 0x80, which is no OUT word"),
        (
            "@a = 0x80: READ(); @t = 0x41: WRITE();",
            ", NODE=1, NODES=ring, TIME=0x41",
            "UL108",
            "`t` is at 0x41, where the ring carries its clock (TIME)",
        ),
        ("@a = 0x80: READ(PUBLISH(2, 1));", ", CYCLE_RATE=100 Hz", "UL109", "`a` is published at 1000 Hz"),
    ],
)
def test_what_a_ring_cannot_carry(members: str, options: str, code: str, message: str) -> None:
    result = compile_text(f"public net(u) {{ TOSNET(COMM=u{options}); {members} }}", "net.ul")
    ((found, said),) = [(d.code, d.message) for d in result.diagnostics]
    assert found == code and message in said


def test_the_same_ring_twice_is_described_alike() -> None:
    text = """public net(u) {{ one: one(u); two: two(u); }}
    one(u) {{ TOSNET(COMM=u, NODE=1); @a = 0x80: READ(); }}
    two(u) {{ TOSNET(COMM=u{}); @a = 0xC0: READ(); }}"""
    assert len(ring_at(clean(text.format(", NODE=1")), 0).nodes) == 2
    (wrong,) = compile_text(text.format(""), "net.ul").diagnostics
    assert (wrong.code, wrong.span.line) == ("UL108", 3)
    assert wrong.message == "the ring at BASE 0 is described in two ways"


def test_the_age_of_a_published_value() -> None:
    spec = clean("""link net (BAUD=3 MHz);
    public net(u) { TOSNET(COMM=u, CYCLE_RATE=1 kHz); @a = 0x80: READ(PUBLISH(100 Hz)); }""")
    (device,) = spec.devices
    line = budget(device)
    (one,) = ring_budgets(spec.roots[0], device, line)
    (publish,) = one.publishes
    assert publish.paths == ("a",)
    (group,) = line.groups
    assert group.latency_s is not None
    assert publish.sensor.bound_s == pytest.approx(2e-3 + 10e-3 + group.latency_s)
    assert publish.sensor.typical_s == pytest.approx(1.5e-3 + 5e-3 + group.message_bytes * 10 / 3e6)
    (unknown,) = ring_budgets(spec.roots[0], device, budget(device, timed=False))
    assert unknown.publishes[0].sensor.bound_s is None


def test_a_publish_of_the_cycle_has_its_rate_and_waits_for_nothing() -> None:
    spec = clean("""link net (BAUD=3 MHz);
    public net(u) { TOSNET(COMM=u, CYCLE_RATE=500 Hz); j[2]: joint() @ (0x80+64*i); }
    joint(): @ (a) { @a: READ(PUBLISH(on cycle)); }""")
    (device,) = spec.devices
    (group,) = device.groups
    assert (group.name, group.trigger, group.divisor, group.rate_hz) == ("on cycle", "event", 0, 500.0)
    line = budget(device, read_many=8)
    assert line.bytes_per_s == line.groups[0].message_bytes * 500
    assert line.tick_bytes == 0  # it is not due at a base tick
    (one,) = ring_budgets(spec.roots[0], device, line)
    assert line.groups[0].latency_s is not None
    assert one.publishes[0].sensor.bound_s == pytest.approx(4e-3 + line.groups[0].latency_s)


def test_a_line_that_cannot_carry_every_cycle() -> None:
    text = "link net (BAUD=1 MHz); public net(u) { TOSNET(COMM=u); @a = 0x80: READ(PUBLISH(on cycle)); }"
    (wrong,) = compile_text(text, "net.ul").diagnostics
    assert (wrong.code, "19230.8 Hz" in wrong.hint) == ("UL104", True)


def test_without_a_ring_the_cycle_is_an_event_from_outside() -> None:
    spec = clean("public a() { @x = 0x1: READ(PUBLISH(on cycle)); }")
    assert spec.devices[0].groups[0].rate_hz is None


def test_nodes_are_inside_or_on_a_ring() -> None:
    ring = compile_text("public a(u) { TOSNET(COMM=u, NODES=ring); @x = 0x80: READ(); }", "a.ul")
    assert ring.spec is not None and ring.spec.roots[0].link.ring.nodes == "ring"
    plain = compile_text("public a(u) { TOSNET(COMM=u); @x = 0x80: READ(); }", "a.ul")
    assert plain.spec is not None and plain.spec.roots[0].link.ring.nodes == "inside"
    assert plain.spec.hash != ring.spec.hash
    wrong = compile_text("public a(u) { TOSNET(COMM=u, NODES=line); @x = 0x80: READ(); }", "a.ul")
    (found,) = wrong.diagnostics
    assert (found.code, found.message) == ("UL108", "NODES is line")
    assert "NODES=ring" in found.hint
