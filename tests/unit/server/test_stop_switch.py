# SPDX-License-Identifier: BSD-3-Clause
"""A stop outlives the server that took it, wins against an arm, and reaches a board that was away."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tests.unit.server.held_wire import HeldWire, held
from tests.unit.server.served import Served, arm, served, token_of
from tests.unit.server.test_serving import until
from unitylink import Link
from unitylink.errors import (
    AccessRefused,
    DeadManTripped,
    LinkDown,
    LinkError,
    LinkTimeout,
    UnityLinkError,
)
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.protocol import REQUEST_KIND_DEFINE_GROUP, REQUEST_KIND_OPEN
from unitylink.server.gate import Client
from unitylink.server.stop_file import SOMEBODY, StopFile
from unitylink.server.stop_switch import DEAD_MAN, StopSwitch, now
from unitylink.simulate import Board

TARGET, POWER = 0x1A, 0x1B
PATIENCE_S = 20.0


@contextmanager
def a_board(**configuration: object) -> Iterator[Board]:
    """Give a board that outlives its servers."""
    spec = arm()
    with Board(spec, configuration=BoardConfiguration.for_spec(spec, **configuration), endpoint="tcp") as one:
        yield one


@contextmanager
def server_of(board: Board, more: str = "", memory: Path | None = None) -> Iterator[Served]:
    with served(url=f"{board.url}?timeout=0.5{more}", memory=memory) as one:
        yield one


def enter(one: Served, token: str = "all") -> Client:
    with one.robot.switch.lock:
        return one.robot.gate.login(token, "a test", now())


def limit_s(board_link: Link) -> float:
    """Return the limit with which the board's dead-man runs, by the board itself."""
    state = board_link.dead_man()
    assert state is not None
    return state.silence_s if state.running else 0.0


def test_a_server_that_finds_a_tripped_board_begins_stopped() -> None:
    with a_board() as board:
        with server_of(board) as first, first.link() as ana:
            ana.write(TARGET, 50)
            first.robot.switch.stop(enter(first, "looks"))
            assert board.registers[TARGET] == 0
        with server_of(board) as second, second.link("moves") as program:
            assert second.robot.report()["stopped_by"] == DEAD_MAN
            assert any("it had tripped when the board was opened" in line for line in second.lines)
            with pytest.raises(AccessRefused, match=r"dead-man has stopped the robot; .*link\.arm\(\)"):
                second.robot.gate.check_write(enter(second), "target", now())
            with pytest.raises(DeadManTripped, match=r"arm\(\)"):
                program.write(TARGET, 51)
            assert board.registers[TARGET] == 0
            program.arm()
            assert second.robot.report()["stopped_by"] == ""
            program.write(TARGET, 52)
            assert board.registers[TARGET] == 52
        with server_of(board) as third:
            assert third.robot.report()["stopped_by"] == ""


def test_arm_starts_all_dead_men_with_their_earlier_times() -> None:
    """That of the server itself, and that of a program whose robot somebody else has armed."""
    with a_board() as board, server_of(board, "&deadman=30") as one:
        link = one.robot.board_link()
        assert limit_s(link) == pytest.approx(30, abs=0.01)
        with one.link() as program:
            program.set_dead_man(20)
            program.write(TARGET, 1)
            assert limit_s(link) == pytest.approx(20, abs=0.01)
            for _ in range(2):  # a stop that follows a stop is one, too
                one.robot.switch.stop(enter(one))
                one.robot.switch.stop(enter(one))
                assert limit_s(link) == 0 and link.dead_man().tripped and limit_s(program) == 0
                one.robot.switch.arm(enter(one))
                assert limit_s(link) == pytest.approx(20, abs=0.01) and limit_s(program) == pytest.approx(
                    20, abs=0.01
                )
            assert one.robot.report()["trips"] == 2
        assert limit_s(link) == pytest.approx(30, abs=0.01)  # the program has closed its link
        one.robot.switch.stop(enter(one))
        one.robot.switch.arm(enter(one))
        assert limit_s(link) == pytest.approx(30, abs=0.01)


def test_a_dead_man_that_trips_by_itself_is_armed_with_its_time() -> None:
    with a_board() as board, server_of(board, "&deadman=0.05") as one:
        link = one.robot.board_link()
        link.watch_program(0.01)
        link.alive()
        until(lambda: not link.up)
        link.watch_program(0)
        link.alive()
        until(lambda: link.up and link.dead_man().tripped)
        one.robot.switch.stop(enter(one))  # while it is tripped
        one.robot.switch.arm(enter(one))
        assert limit_s(link) == pytest.approx(0.05, abs=0.01)


def test_a_stop_while_the_board_is_away_is_done_when_it_is_back() -> None:
    with a_board() as board, server_of(board) as one:
        port = board.url.rpartition(":")[2]
        with one.link() as ana:
            ana.write(TARGET, 50)
        board.close()
        until(lambda: one.robot.away)
        with pytest.raises(UnityLinkError):
            one.robot.switch.stop(enter(one))
        with pytest.raises(UnityLinkError):
            one.robot.switch.arm(enter(one))
        with Board(arm(), endpoint=f"tcp:{port}") as again:
            again.registers[TARGET] = 70  # what it does at power-up
            until(lambda: again.registers[TARGET] == 0)
            link = one.robot.board_link()
            until(lambda: link.dead_man().tripped)
            with one.link() as ana, pytest.raises(DeadManTripped):
                ana.write(TARGET, 71)
            one.robot.switch.arm(enter(one))
            with one.link() as ana:
                ana.write(TARGET, 72)
            assert again.registers[TARGET] == 72


def test_a_board_that_was_reset_while_it_was_stopped_is_stopped_again() -> None:
    with a_board() as board, server_of(board) as one:
        port = board.url.rpartition(":")[2]
        one.robot.switch.stop(enter(one))
        board.close()
        until(lambda: one.robot.away)
        with Board(arm(), endpoint=f"tcp:{port}") as again:
            again.registers[TARGET] = 70  # what it does at power-up
            until(lambda: again.registers[TARGET] == 0)
            until(lambda: one.robot.board_link().dead_man().tripped)


def test_a_stop_without_any_link_is_remembered() -> None:
    with served(url="tcp://127.0.0.1:9?timeout=0.2") as one:
        with pytest.raises(LinkDown, match="its outputs are made safe when it is back"):
            one.robot.switch.stop(enter(one))
        assert one.robot.report()["stopped_by"] == "all"


def test_a_stop_wins_against_an_arm_that_is_under_way(monkeypatch: pytest.MonkeyPatch) -> None:
    held, entered, told = threading.Event(), threading.Event(), []
    original = Link.arm

    def slow(self: Link, **options: float | None) -> None:
        original(self, **options)
        entered.set()
        assert held.wait(10)

    with a_board() as board, server_of(board) as one:
        switch, ana, ben = one.robot.switch, enter(one), enter(one, "looks")
        switch.stop(ana)
        monkeypatch.setattr(Link, "arm", slow)

        def arm_it() -> None:
            try:
                switch.arm(ana)
            except AccessRefused as error:
                told.append(str(error))

        arming = threading.Thread(target=arm_it)
        arming.start()
        assert entered.wait(10)
        stopping = threading.Thread(target=switch.stop, args=(ben,))
        stopping.start()
        until(lambda: one.robot.gate.stopped_by == "looks")
        held.set()
        arming.join(10)
        stopping.join(10)
        assert told == ["looks is stopping the robot; arm it after that"]
        assert one.robot.report()["stopped_by"] == "looks"
        assert one.robot.board_link().dead_man().tripped


@pytest.mark.parametrize("deadman", [True, False])
@pytest.mark.parametrize("stopped", [True, False])
def test_an_arm_that_its_line_holds_up_does_not_end_a_later_stop(deadman: bool, stopped: bool) -> None:
    with ExitStack() as stack:
        one = stack.enter_context(server_of(stack.enter_context(a_board(deadman=deadman))))
        if stopped:
            one.robot.switch.stop(enter(one))
        wire = HeldWire(f"tcp://{one.server.place}")
        stack.callback(wire.close)
        began_s = time.monotonic()
        with token_of("moves"):
            program = stack.enter_context(Link(f"serve://{wire.url[6:]}/arm?timeout=20"))
        trip_s = time.monotonic() - began_s  # longer than the round trip by which the program knows the clock
        with ThreadPoolExecutor() as pool, held(wire):
            armed = pool.submit(program.arm)
            until(lambda: wire.waits)
            time.sleep(1.1 * trip_s)
            one.robot.switch.stop(enter(one, "looks"))
            wire.open_.set()
            with pytest.raises(AccessRefused, match=r"arm: .* after this was asked for.* arm it again"):
                armed.result(PATIENCE_S)
        assert one.robot.report()["stopped_by"] == "looks"
        assert any('"arm"' in line and "after this was asked for" in line for line in one.lines)
        program.arm()
        assert one.robot.report()["stopped_by"] == ""


def test_an_arm_is_dated_well_also_if_the_session_has_begun_slowly() -> None:
    """What OPEN tells about the server's clock is then worse than what this test has time for."""
    with ExitStack() as stack:
        one = stack.enter_context(server_of(stack.enter_context(a_board())))
        wire = HeldWire(f"tcp://{one.server.place}")
        stack.callback(wire.close)
        wire.delay_s = lambda data: 0.4 if REQUEST_KIND_OPEN in data[:3] else 0.0
        with token_of("moves"):
            program = stack.enter_context(Link(f"serve://{wire.url[6:]}/arm?timeout=20"))
        with ThreadPoolExecutor() as pool, held(wire):
            armed = pool.submit(program.arm)
            until(lambda: wire.waits)
            time.sleep(0.2)
            one.robot.switch.stop(enter(one, "looks"))
            wire.open_.set()
            with pytest.raises(AccessRefused, match="after this was asked for"):
                armed.result(PATIENCE_S)
        assert one.robot.report()["stopped_by"] == "looks"


def test_a_stop_waits_for_no_group_that_the_board_does_not_confirm() -> None:
    with ExitStack() as stack:
        board = stack.enter_context(a_board())
        wire = HeldWire(board.url)
        stack.callback(wire.close)
        one = stack.enter_context(served(url=f"{wire.url}?timeout=10"))
        program, other = stack.enter_context(one.link()), stack.enter_context(one.link())
        other.write(TARGET, 50)
        wire.loses = REQUEST_KIND_DEFINE_GROUP
        with ThreadPoolExecutor() as pool:
            subscribed = pool.submit(program.subscribe, [0x12], divisor=10)
            until(lambda: wire.lost)
            one.robot.switch.stop(enter(one, "looks"))
            assert board.registers[TARGET] == 0 and one.robot.board_link().dead_man().tripped
            assert one.robot.report()["groups"] == 0 and not subscribed.done()
            wire.loses = -1
            until(subscribed.done)
        with pytest.raises(DeadManTripped):
            other.write(TARGET, 60)
        other.arm()
        other.write(TARGET, 60)


def test_an_arm_after_a_stop_that_failed_makes_the_outputs_safe_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Else the robot would go on with what it did, although somebody has stopped it."""

    def fails(*_: object, **__: object) -> None:
        raise LinkTimeout("a test: no answer")

    with a_board() as board, server_of(board) as one, one.link() as ana:
        monkeypatch.setattr(one.robot.switch, "keep", lambda: None)
        ana.write(TARGET, 50)
        with monkeypatch.context() as patch, pytest.raises(LinkTimeout):
            patch.setattr(Link, "trip", fails)
            patch.setattr(Link, "write_many", fails)
            one.robot.switch.stop(enter(one))
        assert one.robot.report()["trips"] == 0
        one.robot.switch.arm(enter(one))
        assert one.robot.report()["trips"] == 1 and board.registers[TARGET] == 0


def test_a_board_that_is_away_does_not_keep_a_stop_from_the_other_boards() -> None:
    with (
        a_board() as left,
        a_board() as right,
        served() as one,
        Link(f"{left.url}?timeout=0.2") as first,
        Link(right.url) as second,
    ):
        switch = StopSwitch(one.robot.gate)
        switch.attach((first, second), lambda: None)
        left.close()
        with pytest.raises(LinkError):
            switch.stop(enter(one))
        assert second.dead_man().tripped


def test_a_board_without_a_dead_man_has_the_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.stop"
    with a_board(deadman=False) as board:
        with server_of(board, memory=file) as first, first.link() as ana:
            ana.write(TARGET, 50)
            first.robot.switch.stop(enter(first, "looks"))
            assert board.registers[TARGET] == 0 and file.read_text() == "looks\n"
            with pytest.raises(DeadManTripped):
                ana.write(TARGET, 51)
        board.registers[TARGET] = 60
        with server_of(board, memory=file) as second, second.link("moves") as program:
            assert second.robot.report()["stopped_by"] == "looks" and board.registers[TARGET] == 0
            with pytest.raises(DeadManTripped):
                program.write(TARGET, 61)
            program.arm()
            program.write(TARGET, 62)
            assert board.registers[TARGET] == 62 and not file.exists()
        with server_of(board, memory=file) as third:
            assert third.robot.report()["stopped_by"] == ""


def test_a_file_that_is_there_means_stopped(tmp_path: Path) -> None:
    file = tmp_path / "arm.stop"
    memory = StopFile(str(file))
    assert memory.read() == ""
    for content in (b"", b"\n", b"\xff\x00\n", b"\x1b[2J"):
        file.write_bytes(content)
        assert memory.read() in (SOMEBODY, "\ufffd"), content
    memory.write("ana")
    assert memory.read() == "ana" and [one.name for one in tmp_path.iterdir()] == ["arm.stop"]
    memory.remove()
    memory.remove()
    assert memory.read() == ""
    with pytest.raises(UnityLinkError, match=r"--stop-file .*no folder where this program may write"):
        StopFile(str(tmp_path / "none" / "arm.stop"))
    with pytest.raises(UnityLinkError, match="this is a folder"):
        StopFile(str(tmp_path))
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(UnityLinkError, match="this is a device or a pipe"):
        StopFile(str(tmp_path / "pipe"))


def test_a_file_that_cannot_be_written_stops_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with a_board() as board, server_of(board, memory=tmp_path / "arm.stop") as one:
        monkeypatch.setattr(StopFile, "write", full)
        one.robot.switch.stop(enter(one))
        assert one.robot.board_link().dead_man().tripped
        assert "the stop of arm may not outlive this program" in capsys.readouterr().err
        monkeypatch.setattr(StopFile, "remove", full)
        with pytest.raises(UnityLinkError, match="remove it, and arm again"):
            one.robot.switch.arm(enter(one))
        assert one.robot.report()["stopped_by"] == "all"
