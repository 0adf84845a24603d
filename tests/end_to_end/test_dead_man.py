# SPDX-License-Identifier: BSD-3-Clause
"""After silence the outputs are safe: a cable is cut between a host and a device, which is the twin or the
VHDL.
"""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from unitylink import Link
from unitylink.errors import DeadManTripped, DeviceMismatch
from unitylink.layer4_data import load_spec_objects
from unitylink.server.audit import Audit
from unitylink.server.gate import Gate
from unitylink.server.scopes import Rights
from unitylink.server.stop_switch import DEAD_MAN, StopSwitch, now
from unitylink.server.tokens import Tokens, User, digest
from unitylink.simulate import Board, BoardConfiguration
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import load

SERVO = Path(__file__).resolve().parents[2] / "examples" / "servo" / "servo.ul"
LAMP = 0x22
PATIENCE_S = 60
OWNER = Tokens([(digest("owner"), User("owner", Rights.of(["admin"])))])

pytestmark = pytest.mark.xdist_group("rtl")


class Cable:
    """A wire between a board and its hosts, of which one follows the other.

    While `cut` is set, everything is lost.
    """

    def __init__(self, board: Board) -> None:
        where = urlsplit(board.url)
        self.cut = threading.Event()
        self._board = socket.create_connection((where.hostname, where.port))
        self._host: socket.socket | None = None
        threading.Thread(target=self._to_host, daemon=True).start()

    def plug(self) -> str:
        """Return the URL of the host's end. The end before it must be closed."""
        ours, host = socket.socketpair()
        self.cut.clear()
        self._host = host
        threading.Thread(target=self._to_board, args=(host,), daemon=True).start()
        return f"fd:{ours.detach()}?timeout=0.5"

    def _to_board(self, host: socket.socket) -> None:
        # A host that closes its end before it has read everything resets it.
        with host, contextlib.suppress(ConnectionResetError):
            while data := host.recv(65536):
                if not self.cut.is_set():
                    self._board.sendall(data)

    def _to_host(self) -> None:
        with self._board:
            while data := self._board.recv(65536):
                if not self.cut.is_set() and self._host is not None:
                    with contextlib.suppress(OSError):  # this happens between two hosts
                        self._host.sendall(data)

    def close(self) -> None:
        self._board.shutdown(socket.SHUT_RDWR)


@pytest.fixture(params=[Board, RtlBoard])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    with request.param(load(SERVO), endpoint="tcp") as served:
        yield served


@pytest.fixture
def cable(board: Board) -> Iterator[Cable]:
    wire = Cable(board)
    yield wire
    wire.close()


def becomes(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, "it does not"
        time.sleep(0.005)


def test_silence_makes_outputs_safe_and_only_arming_ends_it(board: Board, cable: Cable) -> None:
    with Link(cable.plug()) as link:
        robot = load_spec_objects(load(SERVO), link)
        robot.dead_man.start(0.25)
        robot["lamp"].write(True)
        assert robot.dead_man.running and not robot.dead_man.tripped
        time.sleep(1.0)  # the program calls nothing, and the link sends signs of life
        assert board.registers[LAMP] == 1

        cable.cut.set()
        becomes(lambda: board.registers[LAMP] == 0)
        cable.cut.clear()
        with pytest.raises(DeadManTripped, match=r"lamp.*arm\(\)"):
            robot["lamp"].write(True)
        assert robot.dead_man.tripped and board.registers[LAMP] == 0
        before = robot["uptime_ms"].read()
        # the program goes on reading, and the board runs
        becomes(lambda: robot["uptime_ms"].read() != before)
        link.post(LAMP, 1)
        with pytest.raises(DeadManTripped, match="1 post"):
            link.sync()

        sessions = link.statistics().sessions
        robot.dead_man.arm()
        assert link.statistics().sessions == sessions + 1
        assert robot.dead_man.running and not robot.dead_man.tripped
        robot["lamp"].write(True)
        assert board.registers[LAMP] == 1
        cable.cut.set()  # the dead-man watches again
        becomes(lambda: board.registers[LAMP] == 0)
        cable.cut.clear()


def test_a_new_link_alone_does_not_end_it(board: Board, cable: Cable) -> None:
    with Link(f"{cable.plug()}&deadman=0.25") as link:
        link.write(LAMP, 1)
        cable.cut.set()
        becomes(lambda: board.registers[LAMP] == 0)
    with Link(f"{cable.plug()}&deadman=0.25") as link:
        state = link.dead_man()
        assert state is not None and state.tripped and not state.running
        with pytest.raises(DeadManTripped):
            link.write_many([LAMP, LAMP], [1, 1])
        link.arm()
        state = link.dead_man()
        assert state is not None and state.running and state.silence_s == pytest.approx(0.25, abs=0.01)
        link.write(LAMP, 1)


def test_a_stop_is_found_by_the_next_program(board: Board) -> None:
    """And `arm` starts the dead-man with the time that it had."""
    url = f"{board.url}?timeout=2&deadman=30"
    with Link(url) as link:
        link.write(LAMP, 1)
        link.trip()
        assert board.registers[LAMP] == 0
    with Link(url) as link:
        switch = StopSwitch(Gate("servo", load(SERVO).roots[0], OWNER, Audit(lambda line: None)))
        owner = switch.gate.login("owner", "here", now())
        switch.attach([link], lambda: None)
        assert switch.gate.stopped_by == DEAD_MAN
        with pytest.raises(DeadManTripped):
            link.write(LAMP, 1)
        for _ in range(2):
            switch.arm(owner)
            state = link.dead_man()
            assert state is not None and state.running and state.silence_s == pytest.approx(30, abs=0.01)
            link.write(LAMP, 1)
            switch.stop(owner)
            assert board.registers[LAMP] == 0


def test_where_there_is_none_it_is_said() -> None:
    with (
        Board(configuration=BoardConfiguration(protocol="classic")) as board,
        Link(f"{board.url}?timeout=2") as link,
    ):
        assert link.dead_man() is None
        for call in (link.arm, lambda: link.set_dead_man(1)):
            with pytest.raises(DeviceMismatch, match="framed"):
                call()
