# SPDX-License-Identifier: BSD-3-Clause
"""What a user types on the first day, and the messages for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.cli import main


@pytest.fixture(autouse=True)
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x1: READ(PUBLISH(100 Hz)); @heat = 0x2: READ(); }")
    (tmp_path / "lamp.ul").write_text("public lamp() { @led = 0x1: WRITE(); }")
    monkeypatch.chdir(tmp_path)


SAID = [
    (["simulate", "sim:arm.ul?plant=ramp"], 1, "a spec is a file: write arm.ul"),
    (["replay", "gone.csv"], 1, "gone.csv: there is no such file"),
    (["record", "sim:arm.ul", "--out", "arm.txt"], 1, "a recording ends in .mcap or .csv"),
    (
        ["watch", "sim:arm.ul", "heat", "--rate", "100000"],
        1,
        "--rate 100000: sim:arm.ul takes 1000 Hz at most",
    ),
    (["bridge", "ros2", "sim:arm.ul", "--spec", "lamp.ul"], 2, "leave --spec lamp.ul out"),
    (["bridge", "ros2", "tcp://127.0.0.1:1", "arm.ul", "--spec", "lamp.ul"], 2, "the spec is given twice"),
    (["bridge", "ros2", "tcp://127.0.0.1:1"], 2, "add --spec FILE.ul"),
    (["doctor", "tcp://127.0.0.1:1?nonsense=3"], 2, "no option 'nonsense'"),
    (["read", "sim:arm.ul", "heat.x"], 1, "there is no item 'heat.x'"),
]


@pytest.mark.parametrize(
    ("words", "code", "said"), SAID, ids=lambda one: " ".join(one) if isinstance(one, list) else ""
)
def test_a_mistake_is_told_with_what_to_do(
    words: list[str], code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == code
    assert said in capsys.readouterr().err


def test_generate_writes_here_if_nothing_else_is_said(tmp_path: Path) -> None:
    assert main(["generate", "arm.ul"]) == 0
    assert (tmp_path / "arm.py").is_file()
    assert main(["generate", "arm.ul", "--check"]) == 0


def test_a_part_of_a_name_is_enough_to_be_told_the_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "two.ul").write_text(
        "public two() { left: arm() @ (0x1); } arm(): @ (position) { @position: READ(); }"
    )
    assert main(["read", "sim:two.ul", "position"]) == 1
    assert "did you mean 'left.position'?" in capsys.readouterr().err
