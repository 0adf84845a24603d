# SPDX-License-Identifier: BSD-3-Clause
"""What a node does when its device, its line or one of its own threads is lost: first it makes the robot
safe.
"""

from __future__ import annotations

import threading
from types import SimpleNamespace

import pytest
from unit.ros.rig import Cable, Still, becomes, running

from unitylink.layer2_message import Link
from unitylink.ros.dead_man import NONE
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec.model import Spec


def test_waits_for_a_device_and_comes_back_safe(spec: Spec) -> None:
    """A loss stops the publishes and refuses commands.

    On return, the safe values come before anything else.
    """
    with Board(spec, plant=Still(), endpoint="tcp") as first:
        url = first.url
    with running(spec, url) as (node, plane):
        plane.wait(lambda: any("waiting for the device" in text for _, text in plane.said))
        assert node.health().level == 2
        plane.takers["mode"](SimpleNamespace(data=1))
        assert node.refused == 1, "what comes while there is no device is not kept for later"
        with Board(spec, plant=Still(), endpoint=f"tcp:{url.rpartition(':')[2]}") as board:
            plane.wait(node.keeper.up.is_set)
            assert board.registers[0x12] == 0, "the first connection changes nothing"
            plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))
            plane.wait(lambda: board.registers[0x12] == 750)
        plane.wait(lambda: not node.keeper.up.is_set())
        sent = len(plane.sent.get("joint_states", []))
        assert node.health().level == 2
        assert any("lost" in text for _, text in plane.said)
        with Board(spec, plant=Still(), endpoint=f"tcp:{url.rpartition(':')[2]}") as board:
            plane.wait(node.keeper.up.is_set)
            assert board.registers[0x12] == 250 and board.registers[0x1A] == 250 and board.registers[0x0] == 0
            plane.wait(lambda: len(plane.sent.get("joint_states", [])) > sent)
            assert node.health().facts["links lost"] == "1"


def test_a_device_that_falls_silent_is_missed(spec: Spec, board: Board) -> None:
    """The port stays, nothing answers, and nobody sends commands.

    Layer 2 asks the device, and the node reports the silence.
    """
    with Cable(board) as cable, running(spec, f"{cable.url}?timeout=0.2", deadman_s=0.0) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        session = node._session
        cable.cut = True
        plane.wait(lambda: not node.keeper.up.is_set())
        assert node.health().level == 2 and "does not answer" in node.health().message
        cable.cut = False
        plane.wait(node.keeper.up.is_set)
        assert node._session is session, "the link is the same: layer 2 has its line back"
        assert node.keeper.losses == 1


def test_the_gateware_is_safe_by_itself_and_the_node_comes_back(spec: Spec, board: Board) -> None:
    """Bytes vanish without an error, and the dead-man trips.

    The node notices it, arms it and forgets the past.
    """
    with Cable(board) as cable, running(spec, f"{cable.url}?timeout=0.1", deadman_s=1.5) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        assert node.health().facts["dead-man"] == "trips after 1.5 s"
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))
        plane.wait(lambda: board.registers[0x12] == 750)
        cable.cut = True
        plane.wait(lambda: board.registers[0x12] == 250)  # only the gateware can have done it
        cable.cut = False
        plane.wait(lambda: node.keeper.losses >= 1 and node.keeper.up.is_set())
        assert any("armed again" in text for _, text in plane.said)
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        plane.wait(lambda: board.registers[0x12] == 500)
        facts = node.health().facts
        assert int(facts["device deadman trips"]) >= 1 and "device clock drift ppm" in facts


def test_a_disarmed_node_leaves_a_tripped_gateware_safe(spec: Spec, board: Board) -> None:
    with Cable(board) as cable, Link(f"{cable.url}?timeout=0.05&attempts=1&deadman=0.05"):
        cable.cut = True  # as when a program is killed: nothing closes the session
        becomes(lambda: board.registers[0x12] == 250)
    with running(spec, board.url, armed=False) as (node, plane):
        plane.wait(lambda: node.health().facts.get("dead-man") == "tripped: the outputs are safe, call arm")
        assert node.health().level == 1 and board.registers[0x12] == 250
        assert plane.services["set_safe"]() == (
            True,
            "the outputs are safe already: the dead-man has tripped",
        )
        assert plane.services["arm"](True)[0]
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        plane.wait(lambda: board.registers[0x12] == 500)
        assert node.keeper.losses == 0


def test_what_has_no_dead_man_says_so(spec: Spec) -> None:
    still = Still()
    classic = BoardConfiguration.for_spec(spec, protocol="classic")
    with (
        Board(spec, plant=still, configuration=classic, endpoint="tcp") as board,
        running(spec, f"{board.url}?protocol=classic") as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        assert (0, NONE) in plane.said
        assert node.health().facts["dead-man"] == "this gateware has no dead-man"
        assert "device frames" not in node.health().facts
    with (
        Board(spec, plant=still, endpoint="tcp") as board,
        running(spec, board.url, deadman_s=0.0) as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        assert node.health().facts["dead-man"] == "the dead-man is off"


def test_a_device_that_was_reset_is_made_safe_first(spec: Spec, board: Board) -> None:
    """The port stays and the link comes back by itself. Still, everything that was written is gone."""
    with (
        Board(spec, plant=Still(), endpoint="tcp") as other,
        Cable(board) as cable,
        running(spec, f"{cable.url}?timeout=0.1") as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        cable.replace(other)
        plane.wait(lambda: node.keeper.losses >= 1 and node.keeper.up.is_set())
        assert other.registers[0x12] == 250
        assert any("the device is back; safe values written" in text for _, text in plane.said)


@pytest.mark.parametrize("protocol", ["classic", "framed"])
def test_a_dead_thread_makes_the_robot_safe_and_is_reported(spec: Spec, protocol: str) -> None:
    """The process lives, and so does its link. The node itself notices, and stops the keep-alive."""
    configuration = BoardConfiguration.for_spec(spec, protocol="both" if protocol == "framed" else protocol)
    with (
        Board(spec, plant=Still(), configuration=configuration, endpoint="tcp") as board,
        running(spec, f"{board.url}?protocol={protocol}") as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))
        plane.wait(lambda: board.registers[0x12] == 750)
        plane.life.patience_s = 0.2
        dead = threading.Thread(target=lambda: plane.life.beat("a thread"))
        dead.start()
        dead.join()
        plane.wait(lambda: "a thread has not moved on" in node.health().message)
        assert node.health().level == 2
        plane.wait(lambda: board.registers[0x12] == 250)
        refused = node.refused
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        assert node.refused == refused + 1
        done, why = plane.services["arm"](True)
        assert not done and "has not moved on" in why
        # the program gives no sign of life, so the link gives up the line
        plane.wait(lambda: not node.keeper.up.is_set())
        assert any("no sign of life" in text for _, text in plane.said)


def test_a_command_that_breaks_something_is_refused_and_the_next_is_taken(spec: Spec, board: Board) -> None:
    with running(spec, board.url) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        plane.takers["joint_commands"](SimpleNamespace(name=["j_1"], position="x", velocity=None))
        assert node.refused == 1 and "not understood" in plane.said[-1][1]
        session, broken = node.session, threading.Event()
        assert session is not None
        group = session.inbox._group

        def fail(numbers: object) -> None:
            broken.set()
            raise ZeroDivisionError

        session.inbox._group = SimpleNamespace(write=fail, writes=group.writes)  # type: ignore[assignment]
        plane.takers["mode"](SimpleNamespace(data=1))
        assert broken.wait(30)
        session.inbox._group = group
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        plane.wait(lambda: board.registers[0x12] == 500)


def test_no_command_from_before_a_loss_is_written_after_it(spec: Spec, board: Board) -> None:
    """Commands that wait in the inbox while the device is replaced are not sent to the new device."""
    with (
        Board(spec, plant=Still(), endpoint="tcp") as other,
        Cable(board) as cable,
        running(spec, f"{cable.url}?timeout=0.1") as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        session = node.session
        assert session is not None
        tell, group = threading.Event(), session.inbox._group

        def late(numbers: dict[str, object]) -> None:
            assert tell.wait(30)
            group.write(numbers)

        session.inbox._group = SimpleNamespace(write=late, writes=group.writes)  # type: ignore[assignment]
        plane.takers["mode"](SimpleNamespace(data=1))
        plane.wait(lambda: session.inbox._busy)
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))  # this waits for the write before it
        cable.cut = True
        plane.wait(lambda: not session.link.up)
        cable.replace(other)
        cable.cut = False
        session.inbox._group = group
        tell.set()
        plane.wait(lambda: node.keeper.losses >= 1 and node.keeper.up.is_set())
        assert (other.registers[0x12], other.registers[0x1A]) == (250, 250)
        plane.takers["j_1/command"](SimpleNamespace(pos_sp=0.5))
        plane.wait(lambda: other.registers[0x1A] == 500)
        assert other.registers[0x12] == 250, "the command of before has not come late"
