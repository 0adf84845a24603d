# SPDX-License-Identifier: BSD-3-Clause
"""A scope that names no part of the robot is said before anything is opened, with the name that is near."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.cli import main

TEXT = "public arm() { joint1: joint() @ (0x10); }\njoint() : @ (a) { @goal = a: WRITE(); }\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.ul").write_text(TEXT)
    (tmp_path / "fleet.toml").write_text(
        '[[robot]]\nname = "a"\nlink = "sim:arm.ul"\nmay = ["read", "write joint2.*"]\n'
    )
    return tmp_path


@pytest.mark.parametrize(
    ("words", "place"),
    [
        ("bridge zenoh sim:{arm} --may 'write joint2.*'", "--may: "),
        ("serve sim:{arm} {arm} --zenoh lab/arm --may zenoh 'write joint2.*'", "--may zenoh: "),
        ("fleet run {fleet} --check-config", "fleet.toml: a: may: "),
    ],
)
def test_a_scope_of_no_part_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], words: str, place: str
) -> None:
    text = words.format(arm=folder / "arm.ul", fleet=folder / "fleet.toml").replace("'write joint2.*'", "@")
    assert main([word.replace("@", "write joint2.*") for word in text.split()]) != 0
    error = capsys.readouterr().err
    assert f"{place}the robot has no part 'joint2'; did you mean joint1?" in error
