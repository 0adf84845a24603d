# SPDX-License-Identifier: BSD-3-Clause
"""A command as a fork: what it says, how it ends, and that it ends with its parent's wish."""

from __future__ import annotations

from pathlib import Path

from unitylink.cli import main
from unitylink.fleet.nursery import Forked


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
