# SPDX-License-Identifier: BSD-3-Clause
"""The commands that the tutorials print work: `sh` blocks in one bash, titled blocks as files."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from unitylink.boards.memories import memories_of

from .conftest import MUJOCO, PATIENCE_S, ROOT

BLOCK = re.compile(r"^```(\w+)(?: title=\"([\w.]+)\")?\n(.*?)^```", re.M | re.S)


def script_of(page: str) -> str:
    """Return everything that a page lets its reader type, as one bash script."""
    parts = ["set -e"]
    for language, file, text in BLOCK.findall((ROOT / "docs" / page).read_text("utf-8")):
        assert language in ("sh", "python", "text", "toml"), f"{page}: a block of {language}"
        assert file or language != "python", f"{page}: a Python block without a title is run by nobody"
        if file:
            parts.append(f"cat > {file} <<'END OF FILE'\n{text}END OF FILE")
        elif language == "sh":
            parts.append(text)
    return "\n".join(parts)


@pytest.mark.parametrize(
    ("page", "says"),
    [
        ("plants.md", ("after half a second: 7.3 rad",)),
        pytest.param(
            "mujoco-parts.md",
            ("the encoder says -0.50 rad, and the joint is at -0.50 rad",),
            marks=MUJOCO,
        ),
        ("own-plant.md", ("x.target = 0.524 rad", "x.position=", "there: 60 deg", "2 passed")),
        pytest.param(
            "learn.md",
            (
                "motors: shoulder",
                "shoulder.position=",
                "generation 9: -0.",
                "cut: over at step 50: ",
                "whole: ",
            ),
            marks=MUJOCO,
        ),
        (
            "own-board.md",
            ("without a fault", "told by the device", "x.position is now 300", "read x.position"),
        ),
        (
            "board.md",
            (
                "hello_led on iCEBreaker",
                "leds[1]     LEDR_N (site 11, active low)",
                "the board answers, in time and without a fault",
                "LEDs 0001, up for",
                "servo at 1700 us, wheel at 400 counts",
                "the limit switch has closed, 1 in all",
            ),
        ),
    ],
)
def test_a_tutorial_works_as_it_stands(page: str, says: tuple[str, ...], tmp_path: Path) -> None:
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    output = tmp_path / "output"
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    with (
        output.open("w") as file,
        subprocess.Popen(
            ["bash", "-c", script_of(page)],
            cwd=tmp_path,
            env={**os.environ, "PATH": path},
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as bash,
    ):
        try:
            code = bash.wait(timeout=5 * PATIENCE_S)
        finally:
            with suppress(ProcessLookupError):  # there may be no process left
                os.killpg(bash.pid, signal.SIGTERM)  # end a virtual board that the page has started
    said = output.read_text("utf-8")
    assert code == 0, said
    for text in says:
        assert text in said, said
    if page == "board.md":
        _is_a_bitstream(tmp_path / "build" / "hello_led-icebreaker")


def _is_a_bitstream(folder: Path) -> None:
    report = json.loads((folder / "report.json").read_text())
    bitstream = (folder / "hello_led-icebreaker.bin").read_bytes()
    assert 0x7EAA997E.to_bytes(4, "big") in bitstream[:256] and len(bitstream) > 100_000
    cells = {area["what"]: area for area in report["area"]}
    memories = memories_of((folder / "design.v").read_text("utf-8"), report["top"])
    assert cells["block RAM"]["used"] == sum(memory.block_rams for memory in memories)
    assert 1000 < cells["logic cells"]["used"] <= cells["logic cells"]["available"] == 5280
    assert report["fmax_hz"] >= report["clock_hz"] == 12_000_000
    assert report["url"] == "serial:/dev/ttyUSB1?baud=1000000"
    assert report["pins"]["leds[1]"] == "LEDR_N (site 11, active low)"
    assert "the design reaches" in (folder / "report.txt").read_text()
