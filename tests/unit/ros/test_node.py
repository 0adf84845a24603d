# SPDX-License-Identifier: BSD-3-Clause
"""The node against the twin, on a plane that keeps everything: publishes, commands, loss, safety."""

from __future__ import annotations

import importlib.util
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from select import select
from types import ModuleType, SimpleNamespace
from urllib.parse import urlsplit

import pytest

from unitylink import connect
from unitylink.errors import UrlError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.ros import plan_interface
from unitylink.ros.dead_man import NONE
from unitylink.ros.node import Options, RobotNode
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

TEXT = """
enum Mode : u2 { idle = 0; run = 1; }
bits Flags : u8 { on: bool @ 0; heat: u6 @ 6..1 (UNIT="K", SCALE=0.5); }
public rig() {
   j[2]: axis() @ (0x10+i*8, 0x11+i*8, 0x12+i*8);
   @mode = 0x0: Mode READWRITE(INITIAL=1, SAFE=0, PUBLISH(1,10));
   @flags = 0x1: Flags READ(PUBLISH(1,10));
   @go = 0x2: u8 PULSE();
   @ros(type="UInt16") @slow = 0x3: u16 READ(PUBLISH(1,50));
}
axis(): @ (p,v,s) {
   @pos = p: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(1,10));
   @vel = v: i16 READ(UNIT="rad/s", SCALE=0.01, PUBLISH(1,10));
   @pos_sp = s: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-1, MAX=1, SAFE=0.25);
}
"""


def _plane_module() -> ModuleType:
    path = Path(__file__).with_name("plane.py")
    spec = importlib.util.spec_from_file_location("memory_plane", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["memory_plane"] = module
    spec.loader.exec_module(module)
    return module


MemoryPlane = _plane_module().MemoryPlane


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "rig.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


@contextmanager
def running(spec: Spec, url: str, **options: object) -> Iterator[tuple[RobotNode, MemoryPlane]]:  # type: ignore[valid-type]
    plane = MemoryPlane()
    given = Options(retry_s=0.02, **options)  # type: ignore[arg-type]

    def build(link: Link) -> object:
        return load_spec_objects(spec, link)

    node = RobotNode(plan_interface(spec), plane, lambda: connect(url, reconnect="auto"), build, given)  # type: ignore[arg-type]
    try:
        yield node, plane
    finally:
        node.close()


class Still:
    """A plant that leaves the registers alone."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None: ...
    def step(self, time_s: float) -> None: ...


@pytest.fixture
def board(spec: Spec) -> Iterator[Board]:
    with Board(spec, plant=Still(), endpoint="tcp") as made:
        yield made


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
            (joints(name=["j_0"], position=[0.1, 0.2]), "2 values of position for 1 names"),
            (joints(name=["j_0"], velocity=[0.1]), "the velocity of j_0 cannot be set"),
            (joints(), "the message sets no joint"),
        ):
            before = node.refused
            node._complained_s = 0.0  # each of them, not one a second
            plane.takers["joint_commands"](message)
            assert node.refused == before + 1 and says in plane.said[-1][1]
        assert board.registers[0x12] == 0, "nothing of a refused message is written"
        for names, values, says in (
            (["mode"], [0.5], "0.5 is not a whole number"),
            (["nope"], [1.0], "no 'nope'"),
            (["flags"], [1.0], "cannot be written"),
            (["j[0]"], [1.0], "is no value"),
            (["mode"], [], "1 names and 0 values"),
            (["mode"], [3.0], "is no Mode"),
        ):
            done, message = plane.services["write"](names, values)
            assert not done and says in message
        health = node.health()
        assert health.level == 1 and health.facts["commands refused"] == str(node.refused)


def test_waits_for_a_device_and_comes_back_safe(spec: Spec) -> None:
    """Loss stops the publishes and refuses commands; on return the safe values come before anything else."""
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


def becomes(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.01)


class Cable:
    """A wire to a board, whose end at the host stays a port in order while bytes are lost (`cut`), are late
    (`held`), or while the board is replaced by another: an FPGA that was configured again."""

    def __init__(self, board: Board) -> None:
        self.cut = self.held = False
        self._board = self._to(board)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listening.getsockname()[1]}"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    @staticmethod
    def _to(board: Board) -> socket.socket:
        where = urlsplit(board.url)
        return socket.create_connection((where.hostname, where.port))

    def replace(self, board: Board) -> None:
        old, self._board = self._board, self._to(board)
        old.close()

    def _serve(self) -> None:
        host: socket.socket | None = None
        while not self._stop.is_set():
            board = self._board
            ends = [self._listening] + ([host] if host else []) + ([] if self.held else [board])
            ready, _, _ = select(ends, [], [], 0.01)
            for end in ready:
                if end is self._listening:
                    if host is not None:  # whose end has not been read yet
                        host.close()
                    host, _ = self._listening.accept()
                    continue
                with suppress(OSError):  # of a board that is being replaced
                    data = end.recv(65536)
                    if end is host and not data:
                        host.close()
                        host = None
                    elif not self.cut and host is not None:
                        (board if end is host else host).sendall(data)
        for end in (self._listening, self._board, host):
            if end is not None:
                end.close()

    def __enter__(self) -> Cable:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()


def test_a_device_that_falls_silent_is_missed(spec: Spec, board: Board) -> None:
    """The port stays, nothing answers, and nobody commands: layer 2 asks, and the node tells."""
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
    """Bytes vanish, nobody is told: the dead-man trips; the node notices, arms it and forgets the past."""
    with Cable(board) as cable, running(spec, f"{cable.url}?timeout=0.1", deadman_s=0.3) as (node, plane):
        plane.wait(node.keeper.up.is_set)
        assert node.health().facts["dead-man"] == "trips after 0.3 s"
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))
        plane.wait(lambda: board.registers[0x12] == 750)
        cable.cut = True
        plane.wait(lambda: board.registers[0x12] == 250)  # nothing but the gateware can have done it
        cable.cut = False
        plane.wait(lambda: node.keeper.losses >= 1 and node.keeper.up.is_set())
        assert any("armed again" in text for _, text in plane.said)
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        plane.wait(lambda: board.registers[0x12] == 500)
        facts = node.health().facts
        assert int(facts["device deadman trips"]) >= 1 and "device clock drift ppm" in facts


def test_a_disarmed_node_leaves_a_tripped_gateware_safe(spec: Spec, board: Board) -> None:
    with Cable(board) as cable, Link(f"{cable.url}?timeout=0.05&attempts=1&deadman=0.05"):
        cable.cut = True  # a program that was killed: nothing says goodbye
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
        running(spec, board.url) as (node, plane),
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
    """The port stays and the link comes back by itself: what was written is gone all the same."""
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
def test_a_thread_that_died_makes_safe_and_is_told(spec: Spec, protocol: str) -> None:
    """The process lives, its link too: it is the node itself that finds out, and stops the keep-alive."""
    configuration = BoardConfiguration.for_spec(spec, protocol="both" if protocol == "framed" else protocol)
    with (
        Board(spec, plant=Still(), configuration=configuration, endpoint="tcp") as board,
        running(spec, board.url) as (node, plane),
    ):
        plane.wait(node.keeper.up.is_set)
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))
        plane.wait(lambda: board.registers[0x12] == 750)
        plane.life.patience_s = 0.2
        dead = threading.Thread(target=lambda: plane.life.beat("a thread"))
        dead.start()
        dead.join()
        plane.wait(lambda: "a thread stands still" in node.health().message)
        assert node.health().level == 2
        plane.wait(lambda: board.registers[0x12] == 250)
        refused = node.refused
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.5))
        assert node.refused == refused + 1
        done, why = plane.services["arm"](True)
        assert not done and "stands still" in why
        plane.wait(lambda: not node.keeper.up.is_set())  # the program is not alive: the line is given up
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


def test_no_command_of_before_a_loss_is_written_after_it(spec: Spec, board: Board) -> None:
    """What waits in the inbox while the device is replaced is not for the one that comes."""
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
        plane.takers["j_0/command"](SimpleNamespace(pos_sp=0.75))  # waits for the write before
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


def test_stamps_are_of_the_device_and_not_of_the_arrival(spec: Spec, board: Board) -> None:
    """Publishes that were held up come together; their stamps stay a period apart."""
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
