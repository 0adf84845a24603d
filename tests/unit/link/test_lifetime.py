# SPDX-License-Identifier: BSD-3-Clause
"""How a link ends: by close() in any thread, by Ctrl-C, at exit, in a forked child, or forgotten."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
import warnings
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from unitylink import Link, LinkClosed, connect

HOURS_S = 3600.0


def run(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], check=False, capture_output=True, text=True, timeout=60
    )


def test_close_does_not_wait_for_those_who_wait(link: Link, device: Any) -> None:
    asked = threading.Event()
    ends: list[BaseException] = []

    def silence(command: str, data: bytes) -> bytes:
        asked.set()
        return b""

    def read() -> None:
        try:
            link.read(1, timeout_s=HOURS_S)
        except LinkClosed as error:
            ends.append(error)

    link.subscribe([1], divisor=10)  # so that closing sends something to the device
    device.intercept = silence
    thread = threading.Thread(target=read)
    thread.start()
    assert asked.wait(10)
    link.close()
    thread.join(10)
    assert len(ends) == 1


def test_ctrl_c_ends_a_long_wait_and_nothing_else(link: Link, device: Any) -> None:
    def interrupt(command: str, data: bytes) -> bytes:
        os.kill(os.getpid(), signal.SIGINT)
        return b""

    for request in (
        lambda: link.read(1, timeout_s=HOURS_S),
        lambda: link.write(1, 2, timeout_s=HOURS_S),
        lambda: link.read_each(range(8), timeout_s=HOURS_S),
    ):
        device.intercept = interrupt
        with pytest.raises(KeyboardInterrupt):
            request()
        device.intercept = lambda command, data: None
        assert link.read(5) == device.memory[5]
    assert not link.closed


def test_ctrl_c_ends_the_opening_of_a_silent_device(fake: ModuleType) -> None:
    def interrupt(command: str, data: bytes) -> bytes:
        os.kill(os.getpid(), signal.SIGINT)
        return b""

    device = fake.FakeDevice()
    device.intercept = interrupt
    with pytest.raises(KeyboardInterrupt):
        connect(device.url(f"timeout={HOURS_S}"))
    device.close()


def test_ctrl_c_ends_the_wait_for_a_publish(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    interrupter = threading.Thread(target=os.kill, args=(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):  # before or during the wait
        interrupter.start()
        subscription.wait(HOURS_S)
    interrupter.join()


def test_ctrl_c_leaves_the_requests_of_other_threads_alone(link: Link, device: Any) -> None:
    first = threading.Event()
    got: list[int] = []

    def intercept(command: str, data: bytes) -> bytes | None:
        if command == "R" and data[0] == 1:
            first.set()
            return b""
        return None

    def interrupt_when_both_wait() -> None:
        got.append(link.read(2, timeout_s=HOURS_S))  # this waits behind the request that is never answered

    device.intercept = intercept
    other = threading.Thread(target=interrupt_when_both_wait)

    def begin() -> None:
        assert first.wait(10)
        other.start()
        os.kill(os.getpid(), signal.SIGINT)

    starter = threading.Thread(target=begin)
    starter.start()
    with pytest.raises(KeyboardInterrupt):
        link.read(1, timeout_s=HOURS_S)
    starter.join(10)
    other.join(10)
    assert got == [device.memory[2]]


def test_a_signal_handler_that_returns_changes_nothing(link: Link, device: Any) -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGUSR1, lambda number, frame: heard.append(link.read(7)))

    def answer_late(command: str, data: bytes) -> bytes | None:
        if command == "R" and data[0] == 1 and not heard:
            device.intercept = lambda command, data: None
            os.kill(os.getpid(), signal.SIGUSR1)
            return b""  # the first attempt gets no answer; meanwhile the handler reads
        return None

    device.intercept = answer_late
    try:
        assert link.read(1, timeout_s=0.5) == device.memory[1]
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert heard == [device.memory[7]]


PUBLISHING = """
import sys, threading
from unitylink import connect
link = connect(sys.argv[1])
called = threading.Event()
link.subscribe([1], divisor=1).on_publish(lambda time_s, words: called.set())
assert called.wait(20)
"""


@pytest.mark.parametrize("end", ["", "raise RuntimeError('mine')", "sys.exit(3)"])
def test_a_program_that_forgets_to_close_leaves_the_device_quiet(end: str) -> None:
    from unitylink.simulate import Board

    with Board(endpoint="tcp") as board:
        done = run(PUBLISHING + end, board.url)
        assert done.returncode == {"": 0, "sys.exit(3)": 3}.get(end, 1), done.stderr
        assert "terminate" not in done.stderr
        with connect(board.url) as link:
            link.read(1)
            assert link.statistics().unclaimed_publishes == 0


def test_a_daemon_thread_in_the_middle_of_a_request_does_not_abort_the_exit() -> None:
    program = """
import sys, threading
from unitylink import connect
link = connect("sim:" + sys.argv[1] + "?fifo=1024")
begun = threading.Event()
def read():
    while True:
        link.read(0)
        begun.set()
for _ in range(4):
    threading.Thread(target=read, daemon=True).start()
assert begun.wait(20)
threading.excepthook = lambda _: None
"""
    spec = Path(__file__).parents[3] / "examples" / "scara" / "scara.ul"
    for _ in range(3):
        done = run(program, str(spec))
        assert done.returncode == 0, done.stderr


def test_a_forgotten_link_closes_itself_and_says_so(fake: ModuleType) -> None:
    device = fake.FakeDevice()
    link = connect(device.url())
    subscription = link.subscribe([1], divisor=1)
    link.self = link  # type: ignore[attr-defined]
    del link
    gc.collect()
    device.publish(0)
    assert subscription.wait(10)  # a subscription keeps its link alive
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        del subscription
        gc.collect()
    assert [str(warning.message)[:16] for warning in caught] == ["unclosed <Link f"]
    assert device.log[-1] == "DPS"
    device.close()


def test_a_forked_child_has_no_part_in_the_link() -> None:
    from unitylink.simulate import Board

    program = """
import os, sys, threading
from unitylink import LinkClosed, connect
link = connect(sys.argv[1])
subscription = link.subscribe([1], divisor=1)
called = threading.Event()
subscription.on_publish(lambda time_s, words: called.set())
child = os.fork()
if child == 0:
    try:
        link.read(1)
    except LinkClosed as error:
        assert "forked" in str(error)
        subscription.close()
        link.close()
        sys.exit(7)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
for _ in range(3):
    called.clear()
    assert called.wait(20)
assert link.read(1) == 0
assert link.statistics().timeouts == 0
link.close()
"""
    for endpoint in ("tcp", "udp", "pty"):
        with Board(endpoint=endpoint) as board:
            url = board.url + ("&" if "?" in board.url else "?") + "timeout=5&protocol=classic"
            done = run(program, url)
            assert done.returncode == 0, done.stderr
