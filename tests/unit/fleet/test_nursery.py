# SPDX-License-Identifier: BSD-3-Clause
"""A command as a fork: what it says, how it ends, and that it ends with its parent's wish."""

from __future__ import annotations

import os
import signal
import sys
import time
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

from unitylink.cli import main
from unitylink.fleet.nursery import Forked


def hang(_: list[str]) -> int:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    print("hangs", file=sys.stderr)
    time.sleep(60)
    return 0


def test_a_fork_that_hangs_is_no_orphan(tmp_path: Path) -> None:
    one = Forked(hang, [], tmp_path, (), end_s=0.1)
    assert next(iter(one.lines)) == "hangs\n"
    one._alive.close()  # as if this process were gone
    assert one.wait(20) and one.poll() == 1
    one.close()


def until_told(_: list[str]) -> int:
    print("lives", file=sys.stderr)
    time.sleep(20)
    return 0


def test_a_fork_whose_nursery_was_killed_ends_too(tmp_path: Path) -> None:
    """Else it stays on the network under its name, and no bridge that is started in its place gets in."""
    one = Forked(until_told, [], tmp_path, ())
    assert next(iter(one.lines)) == "lives\n"
    server: Any = forkserver._forkserver
    os.kill(server._forkserver_pid, signal.SIGKILL)
    os.waitid(os.P_PID, server._forkserver_pid, os.WEXITED | os.WNOWAIT)  # else the next finds it alive
    assert one.wait(10) and one.poll() == 255  # as far as anybody here knows
    began_s = time.monotonic()
    assert "".join(one.lines) == "", "the end of its stderr is its own end"
    assert time.monotonic() - began_s < 15
    one.close()


def test_a_fork_says_what_is_wrong_and_ends_when_it_is_told(tmp_path: Path) -> None:
    """Here stderr is a file, which a process that is forked must not take for its own."""
    wrong = Forked(main, ["read", "sim:no.ul", "x"], tmp_path, ())
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    right = Forked(main, ["simulate", "arm.ul", "--tcp", "0"], tmp_path, ())
    assert wrong.wait(60) and wrong.poll() == 1
    assert "no.ul" in "".join(wrong.lines)
    assert right.poll() is None
    right.kill()
    assert right.wait(60) and right.poll() == -9
    for one in (wrong, right):
        one.close()
