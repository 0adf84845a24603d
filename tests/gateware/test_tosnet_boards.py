# SPDX-License-Identifier: BSD-3-Clause
"""A ring of five compiled nodes behind a link: the PC's bridge, and a node at each joint."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from unitylink import Link, protocol
from unitylink.errors import BindingError
from unitylink.generate import planned_files
from unitylink.generate.spec_plan import SpecPlan
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.simulate import Board
from unitylink.simulate.registers import Registers
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import load
from unitylink.spec.model import Spec

SPEC = Path(__file__).resolve().parents[2] / "examples" / "scara_ring" / "scara_ring.ul"
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


def online(link: Link) -> None:
    end = time.monotonic() + 60
    while not link.read(protocol.TOSNET_STATUS) >> protocol.TOSNET_STATUS_ONLINE_BIT & 1:
        assert time.monotonic() < end, "the ring does not start"


def committed(link: Link) -> None:
    link.write(protocol.TOSNET_STATUS, 1)
    while link.read(protocol.TOSNET_STATUS) & 1:
        pass


def test_a_ring_of_five_designs_moves_four_joints_in_one_cycle() -> None:
    with RtlBoard(load(SPEC), plant=Joints()) as board, Link(f"{board.url}?timeout=10") as link:
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
    spec = load(SPEC)
    assert safe_when_broken(RtlBoard(spec)) == safe_when_broken(Board(spec)) == [123, 0, 123]


def test_each_node_has_an_entity_of_its_own(tmp_path: Path) -> None:
    spec = load(SPEC)
    files = planned_files(SpecPlan(spec, BoardConfiguration.for_spec(spec)), ["vhdl"])
    nodes = {name for name in files if "_node_" in name}
    assert nodes == {f"vhdl/scara_ring_node_{joint}.vhd" for joint in JOINTS}
    assert "j1_position_setpoint" not in files["vhdl/scara_ring_top.vhd"]


def test_a_line_that_is_too_fast_for_the_clock_is_refused() -> None:
    spec = load(SPEC)
    slow = BoardConfiguration.for_spec(spec, clock_hz=25_000_000)
    with pytest.raises(BindingError, match=r"12,500,000 bit/s, and a bit needs 3 clocks.*lower BAUD"):
        planned_files(SpecPlan(spec, slow), ["vhdl"])
