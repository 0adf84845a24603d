# SPDX-License-Identifier: BSD-3-Clause
"""The page docs/lerobot.md is followed: its first lines, and its program."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest

from unitylink.cli import main

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "lerobot.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.search(rf"^```{language}\n(.*?)^```", PAGE, re.M | re.S)
    assert found is not None
    return found[1]


@pytest.mark.takes(2)
def test_the_first_lines_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line in block("sh").splitlines():
        program, *arguments = shlex.split(line)
        if program == "cd":
            monkeypatch.chdir(arguments[0])
        else:
            assert program == "unitylink"
            busy = arguments[0] == "record"  # it ends with 1 if a busy machine has lost a sample
            assert main(arguments) in ((0, 1) if busy else (0,)), line
    project = tmp_path / "small_arm"
    info = json.loads((project / "data" / "meta" / "info.json").read_text())
    assert info["total_episodes"] == 1 and info["fps"] == 50 and info["total_frames"] > 20
    package = project / "lerobot" / "lerobot_robot_small_arm"
    assert (package / "setup.py").is_file() and "small_arm_leader" in (package / "README.md").read_text()


def test_the_program_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(block("python"), "lerobot.md", "exec"), {})
    assert capsys.readouterr().out == "Episode(number=0, frames=100, lost=0)\n"
