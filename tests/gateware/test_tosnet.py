# SPDX-License-Identifier: BSD-3-Clause
"""TosNet's memory map: random traffic from all sides gives equal results on the slave in GHDL and on the
twin.
"""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from gateware.simulators import Ghdl

from unitylink import Link, protocol
from unitylink._native import Bus
from unitylink.gateware import gateware_sources
from unitylink.interface.board_configuration import BoardConfiguration, TosnetConfiguration, TosnetNode
from unitylink.simulate import Board, Registers
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import Spec, compile_text, load

ROOT = Path(__file__).resolve().parents[2]
CLOCK_HZ = 1_000_000
SEEN = [0x84, 0x87, 0x8C, 0x17F, 0x40, 0x44]  # from tosnet_slave_tb: the words that the nodes see …
GIVEN = [0x80, 0x83, 0x88, 0x178, 0x179, 0x17B]  # … and give
NOWHERE = 0x7FF  # an address without a meaning
# Within one clock, things happen in this order: first the PC's access, then the changes around it.
ORDER = "grwtpsbod"


class Twin:
    """A twin that does what each line of the bench's log says, and returns what the gateware should have
    done.
    """

    def __init__(self, cycle_clocks: int, max_skipped_writes: int, words: int, whole_memory: bool) -> None:
        tosnet = TosnetConfiguration(
            master_id=1,
            master_registers=0x0F,
            cycle_s=cycle_clocks / CLOCK_HZ,
            max_skipped_writes=max_skipped_writes,
            nodes=(TosnetNode(2, 0x03), TosnetNode(5, 0x80)),
        )
        self.bus = Bus(BoardConfiguration(address_bits=11, clock_hz=CLOCK_HZ, tosnet=tosnet))
        self.known = None if whole_memory else {*SEEN[:words], *GIVEN[:words]}

    def exists(self, address: int) -> bool:
        return self.known is None or address >= protocol.TOSNET_MEMORY_WORDS or address in self.known

    def expect(self, kind: str, clock: int, state: int, place: int, word: int) -> tuple[int, int]:
        """Return the state and the word that the line should have."""
        bus = self.bus
        match kind:
            case "r":
                read = bus.read(place if self.exists(place) else NOWHERE, clock)
                return (0, word) if read is None else (1, read)
            case "w":
                return int(bus.write(place if self.exists(place) else NOWHERE, word, clock)), word
            case "g":
                seen = bus.get(place, clock)
                return int(seen is not None), seen or 0
            case "s":
                return int(bus.set(place, word, clock)), word
            case "b":
                bus.block(bool(state), clock)
            case "o":
                bus.set_online(bool(state), clock)
            case "d":
                bus.damage_cycle(clock)
            case "t":
                taken = bus.async_take(clock)
                if taken is None:
                    return 0, 0
                node, data, count = taken
                return int((count - 1) << 4 | node == place), data
            case "p":
                return int(bus.async_give(place & 0xF, word, (place >> 4) + 1, clock)), word
        return state, word


Line = tuple[str, int, int, int, int]


def log_of(path: Path) -> list[Line]:
    lines: list[Line] = []
    for line in path.read_text(encoding="ascii").splitlines():
        kind, clock, state, place, word = line.split()
        if int(place) == 0xFFFF:
            break  # the lines after this one are not for the twin
        lines.append((kind, int(clock), int(state), int(place), int(word, 16)))
    return sorted(lines, key=lambda line: (line[1], ORDER.index(line[0])))


CASES: dict[str, dict[str, Any]] = {
    "plain": {},
    "cycle_of_a_clock": {"cycle_clocks": 1, "seed": 2},
    "long_cycle": {"cycle_clocks": 150, "seed": 3},
    "halts": {"cycle_clocks": 50, "max_skipped_writes": 3, "network_faults": True, "seed": 4},
    "listed_words": {"whole_memory": False, "seed": 5},
    "one_word": {"whole_memory": False, "words": 1, "cycle_clocks": 20, "seed": 6},
    "no_words": {"words": 0, "seed": 7},
}


@pytest.mark.parametrize("name", CASES)
def test_equal_to_the_twin(ghdl: Any, tmp_path: Path, name: str) -> None:
    generics = {"cycle_clocks": 37, "max_skipped_writes": 0, "words": 6, "whole_memory": True, **CASES[name]}
    path = tmp_path / "log.txt"
    ghdl.run("tosnet_slave_tb", log_file=str(path), accesses=1500, **generics)
    twin = Twin(*(generics[key] for key in ("cycle_clocks", "max_skipped_writes", "words", "whole_memory")))
    happened: Counter[str] = Counter()
    for kind, clock, state, place, word in log_of(path):
        expected_state, expected_word = twin.expect(kind, clock - 1, state, place, word)
        assert state == expected_state, f"clock {clock}: {kind} {place:#x}"
        assert word == expected_word or not state, f"clock {clock}: {kind} {place:#x}"
        happened[f"{kind}{state}"] += 1
    needed = {"r1": 500, "r0": 50, "w1": 300, "w0": 20, "b1": 100, "t1": 20, "p1": 100}
    if generics["words"]:
        needed |= {"g1": 100, "s1": 500}
    if "network_faults" in generics:
        needed |= {"o0": 20, "o1": 20, "d1": 50}
    assert not {what: happened[what] for what in needed if happened[what] < needed[what]}


@pytest.mark.parametrize(("depth", "seed"), [(2, 1), (8, 2), (128, 3)])
def test_channel(ghdl: Any, depth: int, seed: int) -> None:
    ghdl.run("tosnet_channel_tb", depth=depth, seed=seed)


@pytest.mark.parametrize(("cycle_clocks", "max_skipped_writes"), [(1, 2), (5, 3), (64, 0)])
def test_cycle(ghdl: Any, cycle_clocks: int, max_skipped_writes: int) -> None:
    ghdl.run("tosnet_cycle_tb", cycle_clocks=cycle_clocks, max_skipped_writes=max_skipped_writes)


def test_wrong_addresses_stop_elaboration(ghdl: Any) -> None:
    ghdl.refuse("tosnet_slave_tb", "write_addresses(5) is there twice", wrong_addresses=1)
    ghdl.refuse("tosnet_slave_tb", "read_addresses(5) is there twice, or the PC's", wrong_addresses=2)


def test_no_asynchronous_channel(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run("tosnet_slave_tb", log_file=str(tmp_path / "log.txt"), accesses=300, async_depth=0)


WRAPPER = """
library ieee; use ieee.std_logic_1164.all;
use work.register_pkg.all; use work.tosnet_pkg.all; use work.wishbone_pkg.all;
entity tosnet_wrapper is
  port (clock, reset : in std_ulogic; m2s : in wishbone_m2s_t; s2m : out wishbone_s2m_t;
        write_words : out word_vector_t(0 to 1); read_words : in word_vector_t(0 to 0));
end entity;
architecture rtl of tosnet_wrapper is begin
  slave : entity work.tosnet_slave
    generic map (nodes => (0 => (id => 2, registers => x"01")), write_addresses => (16#84#, 16#85#),
                 read_addresses => (0 => 16#80#), whole_memory => WHOLE, async_depth => DEPTH)
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m,
              write_words => write_words, read_words => read_words);
end architecture;
"""


@pytest.mark.parametrize(("whole", "depth"), [("true", 128), ("false", 0)])
def test_synthesis(tmp_path: Path, whole: str, depth: int) -> None:
    wrapper = tmp_path / "tosnet_wrapper.vhd"
    wrapper.write_text(WRAPPER.replace("WHOLE", whole).replace("DEPTH", str(depth)), encoding="ascii")
    netlist = Ghdl(tmp_path, [*gateware_sources(), wrapper]).synthesise("tosnet_wrapper")
    assert ("array (0 to 2047)" in netlist) == (whole == "true"), "the memory is one that block RAM can hold"


def commits(board: Board) -> list[object]:
    """Write and commit at random, as a program without TosNetProxy does. Return what both sides see then."""
    draw, seen = random.Random(11), []
    inputs = [0x8C, 0x8D, 0x8E, 0x8F, 0x94, 0x95, 0x96, 0x97]
    with Link(f"{board.url}?timeout=10") as link:
        for _ in range(60):
            for address in draw.sample(inputs, draw.randint(0, len(inputs))):
                link.write(address, draw.getrandbits(32))
            link.write(protocol.TOSNET_STATUS, 0)
            while (status := link.read(protocol.TOSNET_STATUS)) & 1:
                pass
            seen += [list(link.read_many(inputs)), [board.registers[address] for address in inputs]]
            seen.append(status >> protocol.TOSNET_STATUS_WRITE_POINTER_BIT & 1)
        seen += [link.read(protocol.TOSNET_NETWORK_REGISTERS + index) for index in range(3)]
    return seen


def test_a_compiled_design_commits_as_the_twin_does() -> None:
    """The netlist of the SCARA's design, whose two banks change places without a copy."""
    spec = load(ROOT / "examples" / "scara" / "scara.ul")
    with RtlBoard(spec) as rtl, Board(spec) as twin:
        assert commits(rtl) == commits(twin)


ON_CYCLE = """public net(u) {
   TOSNET(COMM=u, NODE=1, CYCLE_RATE=500 Hz);
   @count = 0x401: READ(PUBLISH(on cycle));
   @first = 0x80: READ(PUBLISH(on cycle));
   @last = 0xBB: READ(PUBLISH(on cycle));
}"""


class Pair:
    """A plant that gives two words of one value. A set of values is torn if they differ."""

    period_s = 0.7e-3  # several steps a cycle

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.registers, self.count = registers, 0

    def step(self, time_s: float) -> None:
        self.count += 1
        self.registers[0x80] = self.registers[0xBB] = self.count


def cycles(board: Board) -> list[list[int]]:
    """Return what the board publishes in some of its cycles."""
    found: list[list[int]] = []
    with (
        Link(f"{board.url}?timeout=10") as link,
        link.subscribe([0x401, 0x80, 0xBB], on_event=True, group=0) as publishes,
    ):
        while len(found) < 40:
            assert publishes.wait(30.0)
            found += publishes.drain()[1].tolist()
    return found


def test_a_compiled_design_publishes_each_cycle_as_the_twin_does() -> None:
    spec = compile_text(ON_CYCLE, "net.ul").spec
    assert spec is not None
    with RtlBoard(spec, plant=Pair()) as rtl, Board(spec, plant=Pair()) as twin:
        for found in (cycles(rtl), cycles(twin)):
            counts = [count for count, _, _ in found]
            assert counts == list(range(counts[0], counts[0] + len(counts)))
            assert all(first == last for _, first, last in found)
            assert len({first for _, first, _ in found}) == len(found), "each cycle has values of its own"
