# SPDX-License-Identifier: BSD-3-Clause
"""A ring of five compiled nodes behind a link: the PC's bridge, and a node at each joint."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from unitylink import Link, protocol
from unitylink.errors import BindingError, NetworkOffline
from unitylink.generate import planned_files
from unitylink.generate.spec_plan import SpecPlan
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.layer3_hardware import TosNetProxy
from unitylink.simulate import Board
from unitylink.simulate.registers import Registers
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import compile_text, load
from unitylink.spec.isochrony.ring import ring_budget
from unitylink.spec.model import Spec
from unitylink.spec.ring import ring_at

SPEC = Path(__file__).resolve().parents[2] / "examples" / "scara_ring" / "scara_ring.ul"
# words for logic of one's own in each node
WORDS = """public words(u) { TOSNET(COMM=u, NODE=1, NODES=ring); j[4]: joint() @ (0x80+64*i); }
joint(): @ (first) {
   @position = first: i32 READ(PUBLISH(on cycle)); @speed = first+1: i32 READ(PUBLISH(on cycle));
   @target = first+4: i32 WRITE(); @limit = first+5: i32 WRITE(SAFE=0);
}"""
# a motor and a shaft in node 2, beside a word for other logic; node 3 has only such words
PARTS = """public parts(u) { TOSNET(COMM=u, NODE=1, NODES=ring);
   motor: h_bridge() @control=0x84, @duty=0x85, @status=0x80;
   shaft: quadrature_encoder() @position=0x81;
   @lamp = 0x86: u8 WRITE(SAFE=9); @key = 0x82: u8 READ(); @far = 0xC0: READ();
}"""
HARMLESS = "comparing non-numeric vector"  # a warning of GHDL about tosnet_start
JOINTS = range(2, 6)  # ids of the nodes


class Joints:
    """Each joint gives what it was told. All give one count as their speed."""

    period_s = 50e-6

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.registers, self.count = registers, 0

    def step(self, time_s: float) -> None:
        self.count += 1
        for joint in JOINTS:
            self.registers[joint * 64] = self.registers[joint * 64 + 4]
            self.registers[joint * 64 + 1] = self.count


def compiled(text: str) -> Spec:
    spec = compile_text(text, "ring.ul").spec
    assert spec is not None
    return spec


def online(link: Link) -> None:
    end = time.monotonic() + 60
    while not link.read(protocol.TOSNET_STATUS) >> protocol.TOSNET_STATUS_ONLINE_BIT & 1:
        assert time.monotonic() < end, "the ring does not start"


def committed(link: Link) -> None:
    link.write(protocol.TOSNET_STATUS, 1)
    while link.read(protocol.TOSNET_STATUS) & 1:
        pass


def test_a_ring_of_five_designs_moves_four_joints_in_one_cycle() -> None:
    with RtlBoard(compiled(WORDS), plant=Joints()) as board, Link(f"{board.url}?timeout=10") as link:
        online(link)
        registers = [link.read(protocol.TOSNET_NETWORK_REGISTERS + place) for place in range(16)]
        assert registers == [1, *(0x010100 | place << 4 | place + 1 for place in range(1, 5)), *[0] * 11]
        starts = [joint * 64 for joint in JOINTS]
        with link.subscribe([*starts, *(at + 1 for at in starts)], on_event=True, group=0) as publishes:
            before = 0
            for target in (7, -70, 700):
                for joint in JOINTS:
                    link.write(joint * 64 + 4, target & 0xFFFFFFFF)
                committed(link)
                seen: list[list[int]] = []
                end = time.monotonic() + 60
                while not seen or seen[-1][0] != target & 0xFFFFFFFF:
                    assert time.monotonic() < end and publishes.wait(30.0)
                    seen += publishes.drain()[1].tolist()
                # The strobes of the nodes are some clocks apart, in which the plant may have made a step.
                assert all(max(row[4:]) - min(row[4:]) <= 1 for row in seen), seen
                assert {value for row in seen for value in row[:4]} <= {before, target & 0xFFFFFFFF}
                before = target & 0xFFFFFFFF


def safe_when_broken(board: Board) -> list[int]:
    """Return what a node sees as its speed limit: commanded, while the ring is broken, and after it."""
    seen = []
    with board, Link(f"{board.url}?timeout=10") as link:
        online(link)
        for joint in JOINTS:
            link.write(joint * 64 + 5, 123)
        committed(link)
        for asked in (True, False, True):
            board.set_online(asked)
            wanted, end = (123 if asked else 0), time.monotonic() + 60
            while any(board.registers[joint * 64 + 5] != wanted for joint in JOINTS):
                assert time.monotonic() < end
            seen.append(board.registers[2 * 64 + 5])
    return seen


def test_a_broken_ring_makes_nodes_safe_on_the_twin_and_in_the_gateware() -> None:
    spec = compiled(WORDS)
    assert safe_when_broken(RtlBoard(spec)) == safe_when_broken(Board(spec)) == [123, 0, 123]


# two rings, a wider check, and a clock that the nodes share
TWO_RINGS = WORDS.replace("NODES=ring", "NODES=ring, RINGS=2, CHECK_BYTES=2, TIME=0x43")


def with_one_of_two_rings(board: Board) -> list[tuple[str, int | None]]:
    """Cut each ring, and both, and mend them. While one runs, words travel, and nodes obey."""
    told: list[tuple[str, int | None]] = []
    with board, Link(f"{board.url}?timeout=10") as link:
        online(link)
        proxy = TosNetProxy(link)
        until(lambda: proxy.status().rings_down == ())
        watch = proxy.watch([2, 3, 4, 5])
        told += [(one.kind, one.node) for one in watch.look()]

        def expect(count: int) -> None:
            def enough() -> bool:
                told.extend((one.kind, one.node) for one in watch.look())
                return len(told) >= count

            until(enough)

        def without(ring: int) -> None:
            resets = proxy.counters().resets
            board.set_ring(ring, False)
            expect(2 * ring + 1)
            for joint in JOINTS:
                link.write(joint * 64 + 4, 100 + ring)
                link.write(joint * 64 + 5, 7)
            committed(link)
            until(lambda: all(link.read(joint * 64) == 100 + ring for joint in JOINTS))
            if isinstance(board, RtlBoard):  # the second ring goes round the other way; the twin does not
                ids = [link.read(protocol.TOSNET_NETWORK_REGISTERS + place) & 15 for place in range(1, 5)]
                assert ids == list(JOINTS if ring else reversed(JOINTS))
            assert all(board.registers[joint * 64 + 5] == 7 for joint in JOINTS)
            board.set_ring(ring, True)
            expect(2 * ring + 2)
            assert proxy.counters().resets == resets

        without(0)
        without(1)
        board.set_online(False)
        expect(5)
        until(lambda: all(board.registers[joint * 64 + 5] == 0 for joint in JOINTS))
        board.set_online(True)
        expect(6)
        return told[:6]


def test_one_of_two_rings_is_enough_on_the_twin_and_in_the_gateware() -> None:
    spec = compiled(TWO_RINGS)
    told = with_one_of_two_rings(Board(spec, plant=Joints()))
    assert told == with_one_of_two_rings(RtlBoard(spec, plant=Joints()))
    cuts = [(kind, ring) for ring in (0, 1) for kind in ("ring_lost", "ring_back")]
    assert told == [*cuts, ("offline", None), ("online", None)]


def test_the_options_of_a_ring_are_in_all_its_nodes(designs: Any) -> None:
    spec = compiled(TWO_RINGS)
    texts = planned_files(SpecPlan(spec, BoardConfiguration.for_spec(spec)), ["vhdl"])
    library = designs.library(spec)
    for entity in ("ring_node_2", "ring_design"):
        generics = dict(re.findall(r"(\w+)\s*=> ([\w#]+)[,)]", texts[f"vhdl/{entity}.vhd"]))
        names = ("rings", "check_bytes", "exact_hops", "time_address")
        assert [generics[name] for name in names] == ["2", "2", "true", "16#043#"]
    for entity in ("ring_node_2", "ring_top"):
        assert f"entity {entity}" in library.synthesise(entity, HARMLESS)


class Nothing:
    period_s = 1e-3

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        pass

    def step(self, time_s: float) -> None:
        pass


def until(told: Callable[[], bool]) -> None:
    end = time.monotonic() + 60
    while not told():
        assert time.monotonic() < end


def node_with_parts(board: Board) -> None:
    """Turn a shaft and drive a motor in node 2, and break the ring."""
    with board, Link(f"{board.url}?timeout=10") as link:
        motor, shaft = board.components["motor"], board.components["shaft"]
        online(link)
        shaft.turn(1234, 0.05)
        board.registers[0x82] = 77
        until(lambda: (link.read(0x81), link.read(0x82)) == (1234, 77))
        assert not any(motor.level("pins", bit) for bit in range(4))
        for address, word in ((0x84, 1), (0x85, 4000), (0x86, 5)):
            link.write(address, word)
        committed(link)
        until(lambda: link.read(0x80) == 1)  # it runs
        motor.duty("pins", 0)
        time.sleep(0.05)
        assert motor.duty("pins", 0) > 0.8 and board.registers[0x86] == 5
        board.set_online(False)
        until(lambda: board.registers[0x86] == 9)
        time.sleep(0.02)
        assert not any(motor.level("pins", bit) for bit in range(4))
        shaft.turn(-5, 0.05)
        assert link.read(0x81) == 1234  # of the last cycle
        board.set_online(True)
        until(lambda: link.read(0x81) == 0xFFFFFFFB and link.read(0x80) == 1)
        until(lambda: board.registers[0x86] == 5)


def test_a_node_with_components_obeys_the_ring_on_the_twin_and_in_the_gateware() -> None:
    spec = compiled(PARTS)
    node_with_parts(Board(spec, plant=Nothing()))
    node_with_parts(RtlBoard(spec, plant=Nothing()))


def test_a_component_of_ones_own_may_be_in_a_node(tmp_path: Path) -> None:
    page = (SPEC.parents[2] / "docs" / "gateware" / "own-core.md").read_text(encoding="utf-8")
    (vhdl, _), (described, *_) = (
        re.findall(rf"^```{kind}\n(.*?)^```", page, re.M | re.S) for kind in ("vhdl", "ul")
    )
    (tmp_path / "stepper.vhd").write_text(vhdl, encoding="utf-8")
    text = """public net(u) { TOSNET(COMM=u, NODE=1, NODES=ring);
       motor: stepper() @target=0x84, @pause=0x85, @position=0x80; }\n"""
    file = tmp_path / "net.ul"
    file.write_text(text + described[described.index("/// Goes") :], encoding="utf-8")
    with RtlBoard(load(file), plant=Nothing()) as board, Link(f"{board.url}?timeout=10") as link:
        online(link)
        for target in (0, 25):
            link.write(0x84, target)
            link.write(0x85, 100)
            committed(link)
            time.sleep(0.05)
        until(lambda: link.read(0x80) == 25)
        assert board.components["motor"].rises("step") == 25


def test_a_node_that_has_left_the_ring_is_safe() -> None:
    with Board(compiled(PARTS), plant=Nothing()) as board, Link(f"{board.url}?timeout=10") as link:
        motor = board.components["motor"]
        for address, word in ((0x84, 1), (0x85, 4000), (0x86, 5)):
            link.write(address, word)
        committed(link)
        for present in (True, False, True):
            board.set_node(2, present)
            time.sleep(0.02)
            assert (board.registers[0x86], link.read(0x80)) == ((5, 1) if present else (9, 1))
            motor.duty("pins", 0)
            time.sleep(0.02)
            assert (motor.duty("pins", 0) > 0.8) == present


def test_each_node_has_an_entity_of_its_own(tmp_path: Path) -> None:
    spec = load(SPEC)
    files = planned_files(SpecPlan(spec, BoardConfiguration.for_spec(spec)), ["vhdl"])
    nodes = {name for name in files if "_node_" in name}
    assert nodes == {f"vhdl/scara_ring_node_{joint}.vhd" for joint in JOINTS}
    assert "j1_shaft_a" in files["vhdl/scara_ring_node_2.vhd"]
    assert "j1_shaft_a" not in files["vhdl/scara_ring_top.vhd"]


@pytest.mark.parametrize(
    ("clock_hz", "message"),
    [
        (
            48_000_000,
            r"12,500,000 bit/s, .* clocks of 48,000,000 Hz; write a BAUD such as 12,000,000 Hz or 16,000",
        ),
        (10_000_000, r"write a BAUD such as 10,000,000 Hz in TOSNET, or choose another clock"),
    ],
)
def test_a_line_that_does_not_suit_the_clock_is_refused(clock_hz: int, message: str) -> None:
    spec = load(SPEC)
    slow = BoardConfiguration.for_spec(spec, clock_hz=clock_hz)
    with pytest.raises(BindingError, match=message):
        planned_files(SpecPlan(spec, slow), ["vhdl"])


@pytest.mark.parametrize(("baud", "samples"), [("12.5 MHz", 1), ("25 MHz", 2), ("50 MHz", 4)])
def test_baud_chooses_the_samples_of_the_line(baud: str, samples: int, designs: Any) -> None:
    spec = compiled(PARTS.replace("NODE=1", f"NODE=1, BAUD={baud}"))
    twin, rate = BoardConfiguration.for_spec(spec).tosnet, float(baud.removesuffix(" MHz"))
    usual_s = ring_at(compiled(PARTS), 0).shortest_s
    assert twin is not None and twin.cycle_s * rate == pytest.approx(12.5 * usual_s)
    kind = "std_ulogic" if samples == 1 else f"std_ulogic_vector({samples - 1} downto 0)"
    texts = planned_files(SpecPlan(spec, BoardConfiguration.for_spec(spec)), ["vhdl"])
    library = designs.library(spec)
    for entity in ("ring_node_2", "ring_node_3", "ring_top"):
        assert re.search(rf"ring_in\s*: in\s+{re.escape(kind)};", texts[f"vhdl/{entity}.vhd"])
        assert f"entity {entity}" in library.synthesise(entity, HARMLESS)


def test_a_ring_with_a_bit_a_clock_exchanges_words(designs: Any) -> None:
    text = """public fast_ring(u) { TOSNET(COMM=u, NODE=1, NODES=ring, BAUD=50 MHz);
       @word = 0x86: WRITE(); @back = 0x81: READ();
       motor: h_bridge() @control=0x84, @duty=0x85, @status=0x80; }"""
    spec = compile_text(text, "fast_ring.ul").spec
    assert spec is not None
    begun = 40_000  # clocks: until the nodes have found each other
    writes = ("#W:008600C0FFEE\n", "#W:008400000001\n", "#W:008500000FA0\n", "#W:040000000001\n")
    answers = designs.play(spec, "fast_ring_tb", [begun, *writes, 6_000, "#R:0081\n", "#R:0080\n"])
    assert answers[1:5] == [b"#S_W\n"] * 4
    assert answers[6:] == [b"#S_R:00c0ffee\n", b"#S_R:00000001\n"]


def test_a_node_of_another_spec_is_refused_by_its_id(monkeypatch: pytest.MonkeyPatch) -> None:
    """Node 2 has the gateware of an older spec. No command reaches it, and the error says which node."""

    def older(*arguments: Any) -> dict[str, str]:
        files = planned_files(*arguments)
        name = next(name for name in files if "_node_2" in name)
        return {**files, name: re.sub(r'(spec_word +=> x)"[0-9A-F]{8}"', r'\1"00000BAD"', files[name])}

    monkeypatch.setattr("unitylink.simulate.rtl.design.planned_files", older)
    words = "@to = 0x84: WRITE(); @of = 0x80: READ();"
    spec = compiled(f"public two(u) {{ TOSNET(COMM=u, NODE=1, NODES=ring); {words} }}")
    with RtlBoard(spec) as board, Link(board.url) as link:
        network = TosNetProxy(link)
        end = time.monotonic() + 60
        while not (status := network.status()).other_spec:
            assert not status.online, "online with a node of another spec"
            assert time.monotonic() < end, "the node is not found"
        assert status.other_spec == 2
        with pytest.raises(NetworkOffline, match="node 2 was built from another spec"):
            network.write(0x84, 1)


def test_values_of_a_node_may_have_the_names_of_its_own_ports(designs: Any) -> None:
    taken = ["clock", "line_clocks", "line_baud_hz", "running", "strobe", "time_bits", "ring_in", "inputs"]
    words = " ".join(f"@{name} = 0x{0x84 + 8 * n:X}: WRITE(SAFE=1);" for n, name in enumerate(taken))
    given = ["line", "entity", "node", "entry"]
    words += " ".join(f"@{name} = 0x{0x80 + 8 * n:X}: READ();" for n, name in enumerate(given))
    spec = compiled(TWO_RINGS[: TWO_RINGS.index("j[4]")] + words + "}")
    library = designs.library(spec)
    for entity in ("ring_node_2", "ring_top"):
        assert f"entity {entity}" in library.synthesise(entity, HARMLESS)


class Clocks(Joints):
    """Each joint's position is the time at which it was set, in us."""

    def step(self, time_s: float) -> None:
        for joint in JOINTS:
            self.registers[joint * 64] = round(time_s * 1e6)


def test_a_value_is_at_the_pc_within_the_bound_of_the_budget() -> None:
    spec = compiled(WORDS)
    board = RtlBoard(spec, plant=Clocks(), endpoint="lockstep")
    ring = ring_at(spec, 0)
    # The simulated line has a third of the clock, and all times of a ring are so many of its bits.
    slower = ring.baud_hz / (board.configuration.clock_hz / 3)
    bound_s = slower * (ring_budget(ring).inward.bound_s or 0.0)
    with board, Link(f"{board.url}?timeout=10") as link:
        link.step(0.01)  # the bridge clears its memory
        online(link)
        began_s = link.now_s() - board.time_s
        with link.subscribe([joint * 64 for joint in JOINTS], on_event=True, group=0) as publishes:
            link.step(20 * slower * ring.shortest_s)
            times, rows = publishes.drain()
    cycles_s = times[1:] - times[:-1]
    assert len(cycles_s) > 10
    assert abs(cycles_s / (slower * ring.shortest_s) - 1).max() < 0.05
    # What changes right behind a value that was sampled comes with the next publish.
    latest_s = (times[1:, None] - began_s - rows[:-1] / 1e6).max()
    assert 0.95 * bound_s < latest_s <= bound_s + Clocks.period_s
