# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink build` with the real tools: bitstreams, and reports of their contents."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from unitylink.cli import main

ROOT = Path(__file__).resolve().parents[2]
COMMAND = "unitylink build examples/servo/servo.ul --board icebreaker"
# A two-way pin, an active-low pin, a PLL, and publishing off: every step of the flow in the smallest design.
SMALL = """
link small (BAUD=1000000);
public small() {
   pad: gpio(pins=2);
   @led = 0x40: u2 WRITE();
   @button = 0x41: bool READ();
}
"""


CLASSIC = ("--protocol", "classic")


@pytest.mark.long  # docs/board.md builds a bitstream with frames for an iCEBreaker in `make test`
def test_servo_on_icebreaker(tmp_path: Path) -> None:
    assert f"\n{COMMAND}\n" in (ROOT / "docs" / "board.md").read_text("utf-8")
    spec = ROOT / "examples" / "servo" / "servo.ul"
    assert main(["build", str(spec), "--board", "icebreaker", "--out", str(tmp_path)]) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    bitstream = (tmp_path / "servo-icebreaker.bin").read_bytes()
    assert 0x7EAA997E.to_bytes(4, "big") in bitstream[:256] and len(bitstream) > 100_000
    cells = {area["what"]: area for area in report["area"]}
    assert 1000 < cells["logic cells"]["used"] <= cells["logic cells"]["available"] == 5280
    page = " ".join((ROOT / "docs" / "build.md").read_text("utf-8").split())
    told = re.search(r"takes (\d+) of 5280 cells and (\d+) of 30 block RAMs of the UP5K", page)
    assert told is not None
    # the counts of different versions of yosys differ a little
    assert abs(int(told[1]) / cells["logic cells"]["used"] - 1) < 0.02
    assert (int(told[2]), 30) == (cells["block RAM"]["used"], cells["block RAM"]["available"])
    assert report["fmax_hz"] >= report["clock_hz"] == 12_000_000
    assert report["url"] == "serial:/dev/ttyUSB1?baud=1000000"
    assert report["pins"]["servos[1]"] == "P1A2 (site 2)"
    assert report["pins"]["lamp"] == "LEDG_N (site 37, active low)"
    assert "the design reaches" in (tmp_path / "report.txt").read_text()


@pytest.mark.long
def test_small_design_on_ulx3s(tmp_path: Path) -> None:
    (tmp_path / "small.ul").write_text(SMALL)
    out = tmp_path / "out"
    assert (
        main(["build", str(tmp_path / "small.ul"), "--board", "ulx3s:25f", *CLASSIC, "--out", str(out)]) == 0
    )
    report = json.loads((out / "report.json").read_text())
    assert (out / "small-ulx3s-25f.bit").stat().st_size > 50_000
    assert report["fmax_hz"] >= report["clock_hz"] == 37_500_000
    assert report["pins"]["pad_pin[0]"].startswith("GP25")
    assert not [text for text in report["notices"] if "before the PLL" in text]


@pytest.mark.long
def test_small_design_behind_a_synchronous_ft245(tmp_path: Path) -> None:
    """An ECP5, a PLL, a two-way pin, words on pins, and two clocks: that of the design, and that of the FTDI
    chip.

    With the classic protocol it is placed faster.
    """
    (tmp_path / "small.ul").write_text(SMALL)
    out = tmp_path / "out"
    small = str(tmp_path / "small.ul")
    assert main(["build", small, "--board", "ecp5-ft2232h", *CLASSIC, "--out", str(out)]) == 0
    report = json.loads((out / "report.json").read_text())
    assert report["fmax_hz"] >= report["clock_hz"] == 36_864_000
    assert report["url"] == "ftdi:?channel=A&mode=sync-fifo"
    assert report["pins"]["ft245_clkout"] == "FIFO_CLK (site U20)" and "pad_pin[0]" in report["pins"]
    assert not [text for text in report["notices"] if "before the PLL" in text]
    assert any("the chip's clock on FIFO_CLK: 60 MHz" in text for text in report["notices"])
    assert "constraining clock net 'FIFO_CLK' to 60.00 MHz" in (out / "nextpnr.log").read_text()
