# SPDX-License-Identifier: BSD-3-Clause
"""Programs that end, or fork, while their link is open."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from unitylink import connect
from unitylink.simulate import Board


def run(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], check=False, capture_output=True, text=True, timeout=60
    )


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
    spec = Path(__file__).parents[2] / "examples" / "scara" / "scara.ul"
    for _ in range(3):
        done = run(program, str(spec))
        assert done.returncode == 0, done.stderr


def test_a_forked_child_has_no_part_in_the_link() -> None:
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
