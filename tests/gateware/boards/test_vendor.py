# SPDX-License-Identifier: BSD-3-Clause
"""Projects for Vivado and Quartus: they name every source, the clock and a place for every pin."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.boards.two_way import with_pins
from unitylink.cli import main
from unitylink.gateware import Port, run_tool

pytestmark = pytest.mark.xdist_group("boards")  # one process, so that its tests share the netlists

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
    sources = re.findall(r"read_vhdl -vhdl2008 -library (\w+) \{(.*)\}", script)
    libraries = {Path(path).name: library for library, path in sources if Path(path).is_file()}
    assert len(libraries) == len(sources) == script.count("read_vhdl")
    assert libraries["core.vhd"] == "unitylink"
    assert libraries["servo_top.vhd"] == libraries["servo_board.vhd"] == "work"
    assert "-generic {baud_hz=1000000 clock_hz=100000000}" in script
    constraints = (tmp_path / "servo.xdc").read_text()
    assert "create_clock -name clock -period 10.000" in constraints
    assert re.search(r"^set_property -dict \{PACKAGE_PIN D4 .*servos\[1\]", constraints, re.MULTILINE)
    assert re.search(r"^# set_property -dict \{PACKAGE_PIN SITE .*lamp", constraints, re.MULTILINE)


def test_quartus(tmp_path: Path) -> None:
    assert main(order(tmp_path, "quartus", "--pin", "lamp=L3")) == 0
    script = (tmp_path / "servo.tcl").read_text()
    sources = re.findall(r"VHDL_FILE \{(.*)\} -library (\w+)", script)
    libraries = {Path(path).name: library for path, library in sources if Path(path).is_file()}
    assert len(libraries) == len(sources) == script.count("-name VHDL_FILE")
    assert (libraries["core.vhd"], libraries["servo_top.vhd"]) == ("unitylink", "work")
    assert "set_location_assignment PIN_L3 -to {lamp}" in script
    assert "# set_location_assignment PIN_SITE -to {servos[0]}" in script
    assert "-period 10.000" in (tmp_path / "servo.sdc").read_text()


HELLO = str(ROOT / "examples" / "hello_led" / "hello_led.ul")
TIMED = {  # what the constraints of each physical layer say, of pins and of clocks
    "uart": ["set_false_path -from [get_ports {usb_rx}]", "set_false_path -to [get_ports {leds[*]}]"],
    "spi": [
        "create_clock -name spi_sck -period 40.000 [get_ports {spi_sck}]",
        "set_input_delay -clock spi_sck -clock_fall -max 5 [get_ports {spi_mosi}]",
        "set_output_delay -clock spi_sck -max 5 [get_ports {spi_miso}]",
        "set_false_path -from [get_ports {spi_cs_n}]",
    ],
    "ft245_sync": [
        "create_clock -name ft245_clkout -period 16.667 [get_ports {ft245_clkout}]",
        "set_input_delay -clock ft245_clkout -max 9 [get_ports {ft245_rxf_n ft245_txe_n ft245_data[*]}]",
        "-max 7.5 [get_ports {ft245_oe_n ft245_rd_n ft245_wr_n ft245_data[*]}]",
    ],
    "ft245_async": [
        "-to [get_ports {ft245_rd_n ft245_wr_n ft245_data[*]}] 4",
        "-from [get_ports {ft245_rxf_n ft245_txe_n ft245_data[*]}] -to [all_registers] 2",
    ],
}


@pytest.mark.parametrize("vendor", ["vivado", "quartus"])
@pytest.mark.parametrize("physical", TIMED)
def test_every_pin_of_every_physical_layer_has_its_constraint(
    tmp_path: Path, physical: str, vendor: str
) -> None:
    told = ["--set", f"physical={physical}", "--protocol", "classic", "--out", str(tmp_path)]
    words = ["build", HELLO, "--board", f"vendor:{vendor}", "--part", "xc7a35ticsg324-1L"]
    assert main([*words, "--clock-hz", "100000000", *told]) == 0
    timing = (tmp_path / f"hello_led.{'xdc' if vendor == 'vivado' else 'sdc'}").read_text()
    for text in TIMED[physical]:
        assert text in timing
    script = (tmp_path / "hello_led.tcl").read_text()
    two_way = physical.startswith("ft245")
    assert ("hello_led_board_pins.v" in script) == two_way
    assert (
        re.search(r"TOP_LEVEL_ENTITY (\w+)$|-top (\w+) ", script, re.MULTILINE)[0]
        .strip()
        .endswith("_pins" if two_way else "_board")
    )
    # Each pin that has a place has a time, or none is wanted.
    sites = re.findall(r"SITE .*?(?:get_ports \{|-to \{)(\w+)", timing + script)
    bound = [
        text
        for line in timing.splitlines()
        if "SITE" not in line
        for text in re.findall(r"get_ports \{(.*?)\}", line)
    ]
    assert set(sites) <= {name for text in bound for name in re.findall(r"(\w+)(?:\[\*\])?(?: |$)", text)}
    assert f"crossings.{'xdc' if vendor == 'vivado' else 'sdc'}" in script


def test_the_top_of_two_way_pins_fits_its_design(tmp_path: Path) -> None:
    ports = (
        Port("clock", True, 1),
        Port("a_in", True, 2),
        Port("a_out", False, 2),
        Port("a_drive", False, 2),
    )
    top = tmp_path / "board_pins.v"
    top.write_text(with_pins("board", ports, {"clock_hz": 5}) + DESIGN)
    script = f"read_verilog {top}; hierarchy -check -top board_pins; proc; flatten; tribuf; opt_clean; stat"
    ended = run_tool(["yosys", "-p", script])
    assert ended.code == 0, ended.err
    assert int(re.findall(r"\$tribuf +(\d+)", ended.out)[-1]) == 2


DESIGN = """
module board #(parameter clock_hz = 0) (
  input clock, input [1:0] a_in, output reg [1:0] a_out, output reg [1:0] a_drive);
  always @(posedge clock) {a_drive, a_out} <= {~a_in, a_in};
endmodule
"""


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
def test_no_symbolic_link_leads_the_build_out_of_its_folder(
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
