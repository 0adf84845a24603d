# SPDX-License-Identifier: BSD-3-Clause
"""Follow docs/gateware/own-core.md word for word: write its files, run its commands, compare the outputs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "gateware" / "own-core.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", PAGE, re.M | re.S)
FILE_NAME = re.compile(r"(?:--|#|//) (\w+\.\w+)")  # the name in the first line of a file


# The commands after the sixth one compile the VHDL and place it on a chip. That takes two minutes, and other
# tests do it too.
@pytest.mark.parametrize("commands", [6, pytest.param(8, marks=pytest.mark.long)])
def test_own_core(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, commands: int) -> None:
    (tmp_path / "unity-link").symlink_to(ROOT)
    folder = tmp_path / "mover"
    folder.mkdir()
    # Do what `activate` does, for tests that run in an environment elsewhere.
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    typed = 0
    for kind, text in BLOCKS:
        if kind != "console":
            named = FILE_NAME.match(text)
            assert named, f"a block does not say what file it is:\n{text}"
            (folder / named.group(1)).write_text(text, encoding="utf-8")
            continue
        for command, shown in re.findall(r"^\$ (.*)\n((?:(?!\$).*\n)*)", text, re.M):
            if "activate" in command or typed == commands:
                continue
            done = subprocess.run(
                command, shell=True, cwd=folder, capture_output=True, text=True, timeout=300, check=False
            )
            output = done.stdout + done.stderr
            assert done.returncode == 0, f"{command}\n{output[-3000:]}"
            assert all(line in output for line in shown.splitlines()), f"{command}\n{output[-3000:]}"
            typed += 1
    assert typed == commands
    assert commands < 8 or list(folder.glob("build/*/mover-icebreaker.bin"))
