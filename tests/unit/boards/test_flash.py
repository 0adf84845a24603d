# SPDX-License-Identifier: BSD-3-Clause
"""Writing a bitstream: the right program is called with the right arguments.

If that is impossible, the message says why.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from unitylink.boards.flash import flash_command
from unitylink.cli import main
from unitylink.errors import BoardError, ToolError


@pytest.fixture
def built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder as `unitylink build` leaves it, and a PATH with no program."""
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    folder = tmp_path / "servo-icebreaker"
    folder.mkdir()
    report = {"board": "icebreaker", "bitstream": "elsewhere/servo-icebreaker.bin"}
    (folder / "report.json").write_text(json.dumps(report))
    (folder / "servo-icebreaker.bin").write_bytes(b"bits")
    return folder


def install(folder: Path, name: str, code: int = 0) -> None:
    path = folder.parent / "bin" / name
    path.write_text(f'#!/bin/sh\necho "$0 $@" > {folder.parent}/called\nexit {code}\n')
    path.chmod(0o755)


def test_the_first_program_that_is_there(built: Path) -> None:
    bitstream = str(built / "servo-icebreaker.bin")
    with pytest.raises(ToolError, match=r"iceprog or openFPGALoader is missing; .* fpga-icestorm or "):
        flash_command(built)
    install(built, "openFPGALoader")
    line = [str(built.parent / "bin" / "openFPGALoader"), "--board", "ice40_generic"]
    assert flash_command(built) == [*line, "--write-flash", bitstream]
    assert flash_command(built, volatile=True) == [*line, bitstream]
    install(built, "iceprog")
    assert flash_command(built) == [str(built.parent / "bin" / "iceprog"), bitstream]
    assert flash_command(built, volatile=True)[1:] == ["-S", bitstream]
    assert flash_command(built, program="openFPGALoader")[:3] == line
    with pytest.raises(BoardError, match="icebreaker: dfu-util is not one of its programs: iceprog, "):
        flash_command(built, program="dfu-util")


def test_command(built: Path, capfd: pytest.CaptureFixture[str]) -> None:
    install(built, "iceprog")
    called = built.parent / "called"
    assert main(["flash", str(built), "--dry-run"]) == 0
    assert capfd.readouterr().out.endswith("servo-icebreaker.bin\n") and not called.exists()
    assert main(["flash", str(built)]) == 0
    assert called.read_text().endswith("iceprog " + str(built / "servo-icebreaker.bin") + "\n")
    install(built, "iceprog", code=3)
    assert main(["flash", str(built)]) == 1
    assert "iceprog ended with 3: is the board plugged in" in capfd.readouterr().err


def test_folders_without_a_build(built: Path) -> None:
    (built / "servo-icebreaker.bin").unlink()
    with pytest.raises(BoardError, match=r"servo-icebreaker\.bin does not exist any more; `unitylink build`"):
        flash_command(built)
    for text in ("", "[]", "{}", '{"board": 3, "bitstream": ""}'):
        (built / "report.json").write_text(text)
        with pytest.raises(BoardError, match="has no finished build of"):
            flash_command(built)
