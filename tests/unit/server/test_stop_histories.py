# SPDX-License-Identifier: BSD-3-Clause
"""Between a stop and the next arm no write is executed, whatever happens, and the robot stays stopped."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from unittest import mock

import pytest

from tests.unit.server.served import Served, served
from tests.unit.server.test_serving import until
from unitylink import Link
from unitylink.errors import AccessRefused, LinkTimeout, UnityLinkError
from unitylink.server.gate import Client
from unitylink.server.stop_switch import now
from unitylink.simulate import Board
from unitylink.spec import compile_text

SPEC = compile_text(
    """
public arm() {
   @target = 0x1A: i32 WRITE(SAFE=0);
   @mark = 0x1B: u32 WRITE();
}
""",
    "arm.ul",
).spec
TARGET, MARK = 0x1A, 0x1B
STEPS = 16


@contextmanager
def lost_answer(name: str) -> Iterator[None]:
    """The board does what `name` of Link asks, and its answer does not arrive."""
    original = getattr(Link, name)

    def done_in_vain(self: Link, **options: float | None) -> None:
        original(self, **options)
        raise LinkTimeout("a test: the answer is lost")

    with mock.patch.object(Link, name, done_in_vain):
        yield


class History:
    """A board, its server, a program that writes all the time, and what must be true of them."""

    def __init__(self, board: Board, stack: ExitStack) -> None:
        self.board, self._stack = board, stack
        self._server: ExitStack
        self.one: Served
        self.stopped, self.frozen = False, 0
        self.before_stop_ns = 0
        self.ended = threading.Event()
        self._begin()
        writer = threading.Thread(target=self._write_always, daemon=True)
        stack.callback(self._server_closes)
        stack.callback(writer.join, 20)
        stack.callback(self.ended.set)
        writer.start()

    def _begin(self) -> None:
        self._server = ExitStack()
        self.one = self._server.enter_context(served(url=f"{self.board.url}?timeout=0.5", spec=SPEC))

    def _server_closes(self) -> None:
        self._server.close()

    def _write_always(self) -> None:
        mark = 0
        while not self.ended.is_set():
            with suppress(UnityLinkError), self.one.link() as link:
                while not self.ended.is_set():
                    mark += 1
                    link.write_many([TARGET, MARK], [7, mark])
            self.ended.wait(0.005)

    def client(self) -> Client:
        with self.one.robot.switch.lock:
            return self.one.robot.gate.login("all", "a test", now())

    # ---- what may happen

    def stop(self) -> None:
        self.check()
        self.before_stop_ns = time.monotonic_ns()
        self.one.robot.switch.stop(self.client())
        self._is_stopped()

    def stop_without_answer(self) -> None:
        self.check()
        self.before_stop_ns = time.monotonic_ns()
        with lost_answer("trip"), pytest.raises(LinkTimeout):
            self.one.robot.switch.stop(self.client())
        self._is_stopped()

    def arm(self) -> None:
        self.check()
        self.one.robot.switch.arm(self.client(), time.monotonic_ns())
        self.stopped = False

    def arm_by_program(self) -> None:
        self.check()
        with self.one.link("moves") as program:
            program.arm()
        self.stopped = False

    def arm_from_before(self) -> None:
        if self.before_stop_ns:
            with pytest.raises(AccessRefused, match="was stopped after this was asked for"):
                self.one.robot.switch.arm(self.client(), self.before_stop_ns)

    def arm_without_answer(self) -> None:
        if not self.stopped:
            return
        self.check()
        with lost_answer("arm"), pytest.raises(LinkTimeout):
            self.one.robot.switch.arm(self.client())
        until(lambda: self.one.robot.board_link().dead_man().tripped)

    def restart(self) -> None:
        self.before_stop_ns = 0  # a program that was not there knows nothing of it
        self._server.close()
        self._begin()

    def write(self) -> None:
        if self.stopped:
            with pytest.raises(UnityLinkError), self.one.link() as link:
                link.write(MARK, 0xFFFFFFFF)

    # ---- what must be true

    def _is_stopped(self) -> None:
        self.stopped, self.frozen = True, int(self.board.registers[MARK])

    def check(self) -> None:
        assert bool(self.one.robot.report()["stopped_by"]) == self.stopped
        if self.stopped:
            assert self.board.registers[TARGET] == 0 and self.board.registers[MARK] == self.frozen


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.takes(3)
def test_no_write_is_executed_between_a_stop_and_the_next_arm(seed: int) -> None:
    rng = random.Random(seed)
    with Board(SPEC, endpoint="tcp") as board, ExitStack() as stack:
        history = History(board, stack)
        happen: list[Callable[[], None]] = [
            *(history.stop, history.stop_without_answer),
            *(history.arm, history.arm_by_program, history.arm_from_before, history.arm_without_answer),
            *(history.restart, history.write),
        ]
        for _ in range(STEPS):
            rng.choice(happen)()
            history.check()


def test_stops_and_arms_from_four_threads_end_and_agree_with_the_board() -> None:
    with Board(SPEC, endpoint="tcp") as board, served(url=board.url, spec=SPEC) as one:
        switch, told = one.robot.switch, []

        def client() -> Client:
            with switch.lock:
                return one.robot.gate.login("all", "a test", now())

        def often(do: Callable[[Client], None]) -> None:
            me = client()
            for _ in range(20):
                try:
                    do(me)
                except BaseException as error:
                    told.append(error)

        threads = [threading.Thread(target=often, args=(do,)) for do in (switch.stop, switch.arm) * 2]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(30)
            assert not thread.is_alive()
        assert {type(error) for error in told} <= {AccessRefused}
        assert one.robot.board_link().dead_man().tripped == bool(one.robot.report()["stopped_by"])
