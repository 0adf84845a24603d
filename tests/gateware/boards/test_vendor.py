# SPDX-License-Identifier: BSD-3-Clause
"""Projects for Vivado and Quartus: every source there is, the clock, a place for every pin."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.cli import main

pytestmark = pytest.mark.xdist_group("boards")  # one process, whose netlists they share

ROOT = Path(__file__).resolve().parents[3]
SERVO = str(ROOT / "examples" / "servo" / "servo.ul")


def order(folder: Path, vendor: str, *more: str) -> list[str]:
    words = [
        "build",
        SERVO,
        "--board",
        f"vendor:{vendor}",
        "--out",
        str(folder),
        "--part",
        "xc7a35ticsg324-1L",
    ]
    return [*words, "--clock-hz", "100000000", *more]


def test_vivado(tmp_path: Path) -> None:
    assert main(order(tmp_path, "vivado", "--pin", "servos[1]=D4", "--pin", "clock=E3")) == 0
    script = (tmp_path / "servo.tcl").read_text()
    sources = re.findall(r"read_vhdl -vhdl2008 \{(.*)\}", script)
    assert all(Path(path).is_file() for path in sources)
    assert {"core.vhd", "servo_top.vhd", "servo_board.vhd"} <= {Path(path).name for path in sources}
    assert "-generic {baud_hz=1000000 clock_hz=100000000}" in script
    constraints = (tmp_path / "servo.xdc").read_text()
    assert "create_clock -name clock -period 10.000" in constraints
    assert re.search(r"^set_property -dict \{PACKAGE_PIN D4 .*servos\[1\]", constraints, re.MULTILINE)
    assert re.search(r"^# set_property -dict \{PACKAGE_PIN SITE .*lamp", constraints, re.MULTILINE)


def test_quartus(tmp_path: Path) -> None:
    assert main(order(tmp_path, "quartus", "--pin", "lamp=L3")) == 0
    script = (tmp_path / "servo.tcl").read_text()
    assert all(Path(path).is_file() for path in re.findall(r"VHDL_FILE \{(.*)\}", script))
    assert "set_location_assignment PIN_L3 -to {lamp}" in script
    assert "# set_location_assignment PIN_SITE -to {servos[0]}" in script
    assert "-period 10.000" in (tmp_path / "servo.sdc").read_text()


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (["--pin", "lmap=L3"], "write PORT=SITE with one of clock, "),
        (["--baud", "20000000"], "20,000,000 baud needs a clock of 160 MHz"),
    ],
)
def test_what_cannot_be(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], message: str
) -> None:
    assert main(order(tmp_path, "vivado", *more)) == 1
    assert message in capsys.readouterr().err


def test_options_that_are_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(order(tmp_path, "ise")) == 1
    assert "there are: vendor:vivado, vendor:quartus" in capsys.readouterr().err
    assert main(["build", SERVO, "--board", "vendor:vivado"]) == 1
    assert "needs --part PART and --clock-hz N" in capsys.readouterr().err
    assert main(["build", SERVO, "--board", "icebreaker", "--part", "x"]) == 2
    assert main(["build", SERVO]) == 2
    assert main(["build", "--list"]) == 0
    assert "ice40-hx8k" in capsys.readouterr().out


@pytest.mark.parametrize("vendor", ["vivado", "quartus"])
def test_no_link_in_the_folder_leads_what_is_built_elsewhere(
    vendor: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = tmp_path / "mine.tcl"
    mine.write_text("mine")
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "servo.tcl").symlink_to(mine)
    assert main(order(folder, vendor)) == 1
    assert "servo.tcl is a symbolic link to" in capsys.readouterr().err
    assert mine.read_text() == "mine" and [path.name for path in folder.iterdir()] == ["servo.tcl"]
