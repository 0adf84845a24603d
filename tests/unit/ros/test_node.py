# SPDX-License-Identifier: BSD-3-Clause
"""The node on the twin, with a plane that keeps everything: publishes, commands, services."""

from __future__ import annotations

import time
from itertools import pairwise
from types import SimpleNamespace

from unit.ros.rig import Cable, becomes, running

from unitylink.errors import UrlError
from unitylink.simulate import Board
from unitylink.spec.model import Spec


def test_publishes_are_typed_and_consistent(spec: Spec, board: Board) -> None:
    board.registers[0x10], board.registers[0x11] = 500, 0xFFFF_FF9C
    board.registers[0x18] = 0xFFFF_FC18
    board.registers[0x1] = 0b0000_1011
    with running(spec, board.url) as (_, plane):
        plane.wait(lambda: {"joint_states", "slow", "j_0/feedback", "feedback_100hz"} <= set(plane.sent))
        states = plane.sent["joint_states"][-1]
        assert states.name == ["j_0", "j_1"]
        assert states.position == [0.5, -1.0] and states.velocity == [-1.0, 0.0] and states.effort == []
        feedback = plane.sent["j_0/feedback"]
        assert (feedback[-1].pos, feedback[-1].vel) == (0.5, -1.0)
        plane.wait(lambda: len(feedback) > 5)
        assert [message.sequence for message in feedback[:5]] == [1, 2, 3, 4, 5]
        whole = plane.sent["feedback_100hz"][-1]
        assert (whole.mode, whole.flags.on, whole.flags.heat) == (1, True, 2.5)
        assert plane.sent["slow"][-1].data == 0


def test_commands_of_every_form_are_written(spec: Spec, board: Board) -> None:
    with running(spec, board.url) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        plane.takers["joint_commands"](
            SimpleNamespace(name=["j_1", "j_0"], position=[0.5, float("nan")], velocity=[], effort=[])
        )
        plane.wait(lambda: board.registers[0x1A] == 500)
        assert board.registers[0x12] == 0
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=-0.5))
        plane.wait(lambda: board.registers[0x12] == 0xFE0C)
        plane.takers["mode"](SimpleNamespace(data=0))
        plane.wait(lambda: board.registers[0x0] == 0)
        assert node.accepted == 3 and node.refused == 0
        assert plane.services["read"](["j[1].pos", "mode"]) == (True, "", [0.0, 0.0], ["0 rad", "idle"])
        assert plane.services["write"](["j[0].pos_sp", "go"], [0.125, 3.0])[0]
        assert board.registers[0x12] == 125 and board.registers[0x2] == 3


def test_wrong_commands_are_refused_whole_and_said(spec: Spec, board: Board) -> None:
    with running(spec, board.url) as (node, plane):
        plane.wait(node.keeper.up.is_set)

        def joints(**fields: object) -> SimpleNamespace:
            return SimpleNamespace(**{"name": [], "position": [], "velocity": [], "effort": []} | fields)

        for message, says in (
            (joints(name=["j_0", "j_1"], position=[0.1, 2.0]), "2.0 rad is not in -1 to 1"),
            (joints(name=["j_7"], position=[0.1]), "no joint is called 'j_7'; there are j_0, j_1"),
            (joints(name=["j_0", "j_0"], position=[0.1, 0.2]), "the joint 'j_0' is named twice"),
            (joints(name=["j_0"], position=[0.1, 0.2]), "2 values of position for 1 names"),
            (joints(name=["j_0"], velocity=[0.1]), "the velocity of j_0 cannot be set"),
            (joints(), "the message sets no joint"),
        ):
            before = node.refused
            node._complained_s = 0.0  # so that each of them is logged, and not only one a second
            plane.takers["joint_commands"](message)
            assert node.refused == before + 1 and says in plane.said[-1][1]
        assert board.registers[0x12] == 0, "nothing of a refused message is written"
        for names, values, says in (
            (["mode"], [0.5], "0.5 is not a whole number"),
            (["nope"], [1.0], "no 'nope'"),
            (["flags"], [1.0], "cannot be written"),
            (["j[0]"], [1.0], "is not a value"),
            (["mode"], [], "1 names and 0 values"),
            (["mode"], [3.0], "is no Mode"),
        ):
            done, message = plane.services["write"](names, values)
            assert not done and says in message
        health = node.health()
        assert health.level == 1 and health.facts["commands refused"] == str(node.refused)


def test_stamps_have_the_device_s_time_and_not_that_of_arrival(spec: Spec, board: Board) -> None:
    """Publishes that were held up come together. Their stamps stay a period apart."""
    with Cable(board) as cable, running(spec, f"{cable.url}?timeout=2", deadman_s=0.0) as (_, plane):
        plane.wait(lambda: len(plane.sent.get("joint_states", [])) > 2)
        before = len(plane.sent["joint_states"])
        began_s = time.monotonic()
        cable.held = True
        becomes(lambda: time.monotonic() - began_s > 0.15)
        cable.held = False
        plane.wait(lambda: len(plane.sent["joint_states"]) > before + 12)
        stamps = [message.header[0] for message in plane.sent["joint_states"]]
    apart = [after - stamp for stamp, after in pairwise(stamps)]
    assert sum(0.009 < period_s < 0.011 for period_s in apart) >= 10, apart


def test_arm_and_set_safe(spec: Spec, board: Board) -> None:
    with running(spec, board.url, armed=False) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        plane.takers["mode"](SimpleNamespace(data=1))
        assert node.refused == 1 and plane.services["write"](["mode"], [1.0])[0] is False
        assert plane.services["arm"](True)[0]
        plane.takers["j_1/command"](SimpleNamespace(pos_sp=1.0))
        plane.wait(lambda: board.registers[0x1A] == 1000)
        done, message = plane.services["set_safe"]()
        assert done and "j[1].pos_sp" in message and board.registers[0x1A] == 250
        plane.takers["j_1/command"](SimpleNamespace(pos_sp=1.0))
        plane.wait(lambda: board.registers[0x1A] == 1000)
        assert plane.services["arm"](False)[0] and board.registers[0x1A] == 250


def test_silence_of_commands_makes_safe(spec: Spec, board: Board) -> None:
    with running(spec, board.url, command_timeout_s=0.05) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        plane.takers["j_1/command"](SimpleNamespace(pos_sp=1.0))
        plane.wait(lambda: any("command_timeout" in text for _, text in plane.said))
        plane.wait(lambda: board.registers[0x1A] == 250)


def test_the_end_is_safe(spec: Spec, board: Board) -> None:
    with running(spec, board.url) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        plane.takers["j_1/command"](SimpleNamespace(pos_sp=1.0))
        plane.wait(lambda: board.registers[0x1A] == 1000)
    assert board.registers[0x1A] == 250


def test_what_waiting_cannot_mend_ends_the_node(spec: Spec) -> None:
    with running(spec, "nonsense:") as (node, plane):
        assert node.keeper.ended.wait(30)
        assert isinstance(node.keeper.failure, UrlError) and plane.said[-1][0] == 2
