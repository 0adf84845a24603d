# SPDX-License-Identifier: BSD-3-Clause
"""The wire between two programs. A line that is gone leaves no name behind."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import termios
import time
import tty
from collections.abc import Callable
from pathlib import Path

import pytest
from apart import wire

HERE = Path(__file__).parent
PATIENCE_S = 60.0


def until(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.001)


def test_a_terminal_that_disappears_while_it_is_opened_counts_as_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once the wire ended in this case, and its host waited for ever."""
    master, slave = os.openpty()
    (tmp_path / "board.tty").symlink_to(os.ttyname(slave))
    opened: list[int] = []

    def gone(descriptor: int, *_: int) -> None:
        opened.append(descriptor)
        os.close(master)
        raise termios.error(errno.EIO, "Input/output error")

    monkeypatch.setattr(tty, "setraw", gone)
    assert wire._raw_terminal(str(tmp_path / "board.tty")) is None
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(*opened)
    os.close(slave)
    assert wire._raw_terminal(str(tmp_path / "board.tty")) is None


def test_no_name_of_an_ended_terminal_leads_to_another_one(tmp_path: Path) -> None:
    """The system gives the numbers of terminals again at once.

    So a host could talk to somebody else's board.
    """
    listen, target = tmp_path / "host.tty", tmp_path / "board.tty"
    master, slave = os.openpty()
    target.symlink_to(os.ttyname(slave))
    command = [sys.executable, HERE / "wire.py", "pty", listen, target, "1"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        until(listen.is_symlink)
        target.unlink()
        os.close(master)  # the board is gone
        os.close(slave)
        until(lambda: not listen.is_symlink())
        master, slave = os.openpty()
        target.symlink_to(os.ttyname(slave))
        until(listen.is_symlink)  # the board is here again
        process.kill()
    os.close(master)
    os.close(slave)
