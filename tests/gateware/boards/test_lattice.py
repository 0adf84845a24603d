# SPDX-License-Identifier: BSD-3-Clause
"""Projects for Lattice's chips. nextpnr reads the constraints of every physical layer."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from unitylink.boards.families import FAMILIES
from unitylink.cli import main
from unitylink.gateware import Port, find_program, map_cells, ports_of, run_tool

pytestmark = pytest.mark.xdist_group("boards")  # one process, so that its tests share the netlists

ROOT = Path(__file__).resolve().parents[3]
HELLO = str(ROOT / "examples" / "hello_led" / "hello_led.ul")
PARTS = {
    "diamond": "LFE5U-25F-6BG381C",
    "radiant": "iCE40UP5K-SG48I",
    "icestorm": "hx8k-ct256",
    "trellis": "25k-CABGA381",
}
OPEN = {
    "icestorm": ("ice40", ["--hx8k", "--package", "ct256"]),
    "trellis": ("ecp5", ["--25k", "--package", "CABGA381"]),
}
LAYERS = ["uart", "rs485", "spi", "ft245_async", "ft245_sync"]
CLOCKS = {layer: {"clock": 100} for layer in LAYERS}
CLOCKS |= {"ft245_sync": {"clock": 100, "ft245_clkout": 60}, "spi": {"clock": 100, "spi_sck": 25}}


def project(folder: Path, tool: str, physical: str, *pins: str) -> None:
    told = ["--set", f"physical={physical}", "--protocol", "framed" if physical == "rs485" else "classic"]
    words = ["build", HELLO, "--board", f"vendor:{tool}", "--part", PARTS[tool], "--clock-hz", "100000000"]
    places = [word for pin in pins for word in ("--pin", pin)]
    assert main([*words, *told, *places, "--out", str(folder)]) == 0


def leds(physical: str) -> str:
    """Return the name of the LEDs: the example has a top level of its own for a UART."""
    return "leds" if physical == "uart" else "led"


def stub(ports: Sequence[Port]) -> str:
    """Return a small design with these ports. Each clock drives a register, and each pin is used."""
    inputs = [port.name for port in ports if port.is_input]
    clocks = [name for name in inputs if name in ("clock", "ft245_clkout", "spi_sck")]
    heads = ", ".join(
        f"{'input' if each.is_input else 'output reg'} {each.range}{each.name}" for each in ports
    )
    every = f"^{{{', '.join(inputs)}}}"
    body = [f"reg seen_{name}; always @(posedge {name}) seen_{name} <= {every};" for name in clocks]
    seen = " ^ ".join(f"seen_{name}" for name in clocks)
    body += [
        f"always @(posedge clock) {port.name} <= {{{port.bits}{{{seen}}}}} ^ {n};"
        for n, port in enumerate(ports)
        if not port.is_input
    ]
    return f"module hello_led_board({heads});\n" + "\n".join(body) + "\nendmodule\n"


@pytest.mark.parametrize("physical", LAYERS)
@pytest.mark.parametrize("tool", OPEN)
def test_nextpnr_reads_the_constraints(tool: str, physical: str, tmp_path: Path) -> None:
    family, chip = OPEN[tool]
    site, other = ("J3", "B1") if family == "ice40" else ("P3", "B11")
    two_way = physical.startswith("ft245")
    some = "ft245_data[3]" if two_way else f"{leds(physical)}[3]"
    project(tmp_path, tool, physical, f"clock={site}", f"{some}={other}")
    top = f"hello_led_board{'_pins' if two_way else ''}"
    netlist = tmp_path / "hello_led_netlist.v"
    netlist.write_text(stub(ports_of(netlist.read_text(), "hello_led_board")))
    sources = ["hello_led_netlist.v", *([f"{top}.v"] if two_way else [])]
    map_cells(family, top, sources, "hello_led.json", tmp_path)
    made, ending = FAMILIES[family], FAMILIES[family].constraints
    placer = find_program(made.placers, made.place_remedy)
    files = ["--json", "hello_led.json", f"--{ending}", f"hello_led.{ending}"]
    allowed = [f"--{ending}-allow-unconstrained", "--pack-only"]
    ended = run_tool([placer, *chip, *files, *allowed], tmp_path)
    assert ended.code == 0, ended.err[-2000:]
    for clock, mhz in CLOCKS[physical].items():
        assert f"constraining clock net '{clock}' to {mhz}.00 MHz" in ended.err
    free = set(re.findall(r"IO '(\S+)' is unconstrained", ended.err))
    assert free.isdisjoint({"clock", some}) and f"{leds(physical)}[0]" in free


OF_LPF = (r'^# LOCATE COMP "(\S+)" SITE "SITE";', r'^FREQUENCY PORT "(\w+)" \d+ MHZ;')
OF_PDC = (r"^# ldc_set_location -site \{SITE\} .*\{(\S+)\}\]", r"^create_clock -name (\w+) ")
OF_PCF = (r"^# set_io (\S+) SITE", r"^set_frequency (\w+) \d+$")
FORMS = {"diamond": ("lpf", *OF_LPF), "radiant": ("pdc", *OF_PDC)}
FORMS |= {"icestorm": ("pcf", *OF_PCF), "trellis": ("lpf", *OF_LPF)}


@pytest.mark.parametrize("physical", LAYERS)
def test_each_pin_has_its_line(physical: str, tmp_path: Path) -> None:
    """Whatever a tool calls it: each bit has a place to be filled in, and each clock its frequency."""
    bits: dict[str, set[str]] = {}
    for tool, (ending, place, clock) in FORMS.items():
        project(tmp_path / tool, tool, physical)
        text = (tmp_path / tool / f"hello_led.{ending}").read_text()
        bits[tool] = set(re.findall(place, text, re.MULTILINE))
        assert set(re.findall(clock, text, re.MULTILINE)) == set(CLOCKS[physical])
    assert bits["diamond"] == bits["radiant"] == bits["icestorm"] == bits["trellis"]
    assert bits["diamond"] >= {"clock", f"{leds(physical)}[7]"}
    if physical.startswith("ft245"):
        assert {f"ft245_data[{n}]" for n in range(8)} <= bits["icestorm"]


TIMES = {
    "uart": [],
    "spi": [  # MOSI comes 5 ns around the falling edge, which is 20 ns after the rising one
        'INPUT_SETUP PORT "spi_mosi" INPUT_DELAY 25 NS HOLD 15 NS CLKPORT "spi_sck";',
        'CLOCK_TO_OUT PORT "spi_miso" MAX 35.000 NS MIN 0 NS CLKPORT "spi_sck";',
    ],
    "ft245_sync": [
        'INPUT_SETUP PORT "ft245_data[7]" INPUT_DELAY 9 NS HOLD 0 NS CLKPORT "ft245_clkout";',
        'CLOCK_TO_OUT PORT "ft245_oe_n" MAX 9.167 NS MIN 0 NS CLKPORT "ft245_clkout";',
    ],
    "ft245_async": [
        'MAXDELAY FROM PORT "ft245_rxf_n" 2 NS DATAPATH_ONLY;',
        'CLOCK_TO_OUT PORT "ft245_data[0]" MAX 4 NS CLKPORT "clock";',
    ],
}


@pytest.mark.parametrize("physical", TIMES)
def test_the_times_of_pins_for_diamond(physical: str, tmp_path: Path) -> None:
    project(tmp_path, "diamond", physical)
    lines = (tmp_path / "hello_led.lpf").read_text().splitlines()
    assert set(TIMES[physical]) <= set(lines)
    assert ("BLOCK INTERCLOCKDOMAIN PATHS;" in lines) == (len(CLOCKS[physical]) > 1)
    timed = [line for line in lines if line.startswith(("INPUT_SETUP", "CLOCK_TO_OUT", "MAXDELAY"))]
    assert bool(timed) == bool(TIMES[physical]) and len(set(timed)) == len(timed)


@pytest.mark.parametrize(("tool", "source"), [("diamond", "prj_src add"), ("radiant", "prj_add_source")])
def test_the_scripts_name_each_file_with_its_library(tool: str, source: str, tmp_path: Path) -> None:
    project(tmp_path, tool, "ft245_sync")
    script = (tmp_path / "hello_led.tcl").read_text()
    sources = re.findall(rf"{source} -work (\w+) \{{(.*)\}}", script)
    libraries = {Path(path).stem: library for library, path in sources if Path(path).is_file()}
    assert libraries["core"] == libraries["uart"] == "unitylink" and libraries["hello_led_top"] == "work"
    assert re.search(rf"^{source} \{{.*/hello_led_board_pins.v\}}$", script, re.MULTILINE)
    assert "top hello_led_board_pins" in script and "HDL_PARAM" not in script  # they are in the Verilog
    project(tmp_path / "uart", tool, "uart")
    script = (tmp_path / "uart" / "hello_led.tcl").read_text()
    assert "HDL_PARAM {baud_hz=1000000;clock_hz=100000000}" in script


def test_a_part_of_another_form_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["build", HELLO, "--board", "vendor:icestorm", "--part", "HX8K CT256", "--clock-hz", "100000000"]
    assert main([*words, "--out", str(tmp_path)]) == 1
    assert "write it as nextpnr does, DEVICE-PACKAGE, as hx8k-ct256" in capsys.readouterr().err


@pytest.mark.long
def test_the_script_of_the_open_tools_makes_a_bitstream(tmp_path: Path) -> None:
    project(tmp_path, "icestorm", "ft245_sync")
    constraints = tmp_path / "hello_led.pcf"
    constraints.write_text(re.sub(r"^set_frequency clock .*\n", "", constraints.read_text(), flags=re.M))
    script = tmp_path / "hello_led.sh"
    script.write_text(script.read_text().replace("--pcf ", "--pcf-allow-unconstrained --pcf "))
    done = subprocess.run(["sh", str(script)], capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "hello_led.bin").stat().st_size > 100_000
