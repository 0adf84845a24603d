# SPDX-License-Identifier: BSD-3-Clause
"""A small design beside its own bitstream, clock by clock.

The block RAMs of the design are models of yosys, those of the bitstream are ours.
"""

from __future__ import annotations

import random
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.simulate.bit.bare import HX8K, place, with_ports
from unitylink.simulate.bit.chip import CELLS
from unitylink.simulate.bit.ice40 import check_driven

CLOCKS = 20_000
WIDTHS = (16, 8, 4, 2)  # of a block RAM, by its mode
BITS = {16: range(16), 8: range(0, 16, 2), 4: range(1, 16, 4), 2: range(3, 16, 8)}  # of such a word
SIGNALS = {"data": 16, "address": 11, "mask": 16, "enable": 4}


def source() -> str:
    """Return a design with carries, both kinds of resets, an enable, and a block RAM in each mode."""
    draw = random.Random(7)
    rams = []
    for mode, width in enumerate(WIDTHS):
        first = ", ".join(f".INIT_{digit:X}(256'h{draw.getrandbits(256):064x})" for digit in range(16))
        rams.append(
            f"  SB_RAM40_4K #(.READ_MODE({mode}), .WRITE_MODE({mode}), {first}) ram{mode}_(\n"
            f"    .RDATA(read{mode}), .RCLK(clock), .RCLKE(enable[0]), .RE(enable[1]), .RADDR(address),\n"
            f"    .WCLK(clock), .WCLKE(enable[2]), .WE(enable[3]), .WADDR(total[10:0]), .MASK(mask),\n"
            f"    .WDATA(data));\n"
            f"  assign word{mode} = {{{', '.join(f'read{mode}[{bit}]' for bit in reversed(BITS[width]))}}};"
        )
    words = "".join(f",\n   output [{width - 1}:0] word{mode}" for mode, width in enumerate(WIDTHS))
    reads = ", ".join(f"read{mode}" for mode in range(4))
    inputs = "".join(f",\n   input  [{bits - 1}:0] {name}" for name, bits in SIGNALS.items())
    return f"""module tiny
  (input  clock,
   input  reset{inputs},
   output [15:0] sum,
   output [15:0] shown{words});
  reg [15:0] total = 0, held = 0;
  wire [15:0] {reads};
  always @(posedge clock or posedge reset)
    if (reset) total <= 16'h8001;
    else total <= total + data;
  always @(posedge clock)
    if (enable[0]) held <= enable[1] ? 16'h00f0 : data ^ total;
  assign sum = total;
  assign shown = held;
{chr(10).join(rams)}
endmodule
"""


def bench(others: list[str]) -> str:
    """Return a bench that says for each of `others` whether it differs from `tiny`."""
    outputs = {"sum": 16, "shown": 16, **{f"word{mode}": width for mode, width in enumerate(WIDTHS)}}
    given = ", ".join(f".{name}({name})" for name in ("clock", "reset", *SIGNALS))
    lines = [f"  reg [{bits - 1}:0] {name} = 0;" for name, bits in SIGNALS.items()]
    for name in ("tiny", *others):
        lines += [f"  wire [{bits - 1}:0] {name}_{output};" for output, bits in outputs.items()]
        links = ", ".join(f".{output}({name}_{output})" for output in outputs)
        lines.append(f"  {name} {name}_({given}, {links});")
    different = {
        name: " | ".join(f"{name}_{output} !== tiny_{output}" for output in outputs) for name in others
    }
    checks = [f"    if ({condition}) {name}_wrong <= 1;" for name, condition in different.items()]
    told = [f'      $display("{name} %s", {name}_wrong ? "differs" : "is equal");' for name in others]
    drawn = [f"    {name} <= $urandom;" for name in SIGNALS]
    return "\n".join(
        [
            "module bench;",
            "  reg clock = 0, reset = 1;",
            "  integer count = 0;",
            *(f"  reg {name}_wrong = 0;" for name in others),
            *lines,
            "  always #1 clock = ~clock;",
            "  always @(negedge clock) begin",
            *drawn,
            "    reset <= count < 3 | count % 512 == 0;",
            "    count <= count + 1;",
            # a word of ours that was never read is 0, and yosys' is unknown
            "    if (count > 64) begin",
            *checks,
            "    end",
            f"    if (count == {CLOCKS}) begin",
            *told,
            "      $finish;",
            "    end",
            "  end",
            "endmodule",
            "",
        ]
    )


def with_a_turned_bit(bitstream: bytes, folder: Path, x: int, y: int, cell: int) -> bytes:
    """Turn the bit of a LUT that says what comes of four zeros."""
    (folder / "whole.bin").write_bytes(bitstream)
    subprocess.run(["iceunpack", "whole.bin", "whole.asc"], cwd=folder, check=True)
    text = (folder / "whole.asc").read_text()
    tile = re.search(rf"^\.logic_tile {x} {y}\n((?:[01]+\n)+)", text, re.MULTILINE)
    assert tile is not None
    rows = tile[1].splitlines()
    row = rows[2 * cell]
    rows[2 * cell] = row[:40] + str(1 - int(row[40])) + row[41:]
    (folder / "turned.asc").write_text(text[: tile.start(1)] + "\n".join(rows) + "\n" + text[tile.end(1) :])
    subprocess.run(["icepack", "turned.asc", "turned.bin"], cwd=folder, check=True)
    return (folder / "turned.bin").read_bytes()


def model_of_yosys() -> str:
    """Return its block RAM, without the defaults of ports, which Verilator does not know."""
    yosys = shutil.which("yosys")
    assert yosys, "yosys is missing: sudo apt-get install yosys"
    cells = (Path(yosys).parents[1] / "share" / "yosys" / "ice40" / "cells_sim.v").read_text("utf-8")
    start = cells.index("module SB_RAM40_4K ")
    model = cells[start : cells.index("endmodule", start)] + "endmodule\n"
    return re.sub(r"`ICE40_DEFAULT_ASSIGNMENT_\w+(\([^)]*\))?", "", model)


@pytest.mark.takes(20)
def test_a_design_equals_its_bitstream_and_a_turned_bit_is_seen(tmp_path: Path) -> None:
    verilog = source()
    placed = place(verilog, "tiny", tmp_path, lambda _: None)
    bitstream, sites = bytes.fromhex(placed["bitstream"]), placed["sites"]

    def unpacked(data: bytes, name: str) -> tuple[str, str]:
        chip = HX8K.unpack(data, sites["clock"])
        text = with_ports(chip, verilog, "tiny", sites).removesuffix(CELLS.read_text("utf-8"))
        return re.sub(r"\bchip\b", f"{name}_chip", text).replace(
            "module tiny", f"module {name}"
        ), chip.verilog

    right, chip = unpacked(bitstream, "right")
    cell = re.search(r"/\* FF +(\d+) +(\d+) +(\d+) \*/ always @\(posedge clock\) if", chip)
    assert cell is not None
    wrong, _ = unpacked(with_a_turned_bit(bitstream, tmp_path, *map(int, cell.groups())), "wrong")
    text = bench(["right", "wrong"]) + verilog + right + wrong + CELLS.read_text("utf-8") + model_of_yosys()
    (tmp_path / "all.v").write_text(text)
    command = [
        "verilator",
        "--binary",
        "-Wno-fatal",
        "-Wno-lint",
        "-Wno-style",
        "--timing",
        "-O3",
        "--top-module",
        "bench",
    ]
    subprocess.run([*command, "all.v"], cwd=tmp_path, check=True, capture_output=True, timeout=300)
    done = subprocess.run(
        [tmp_path / "obj_dir" / "Vbench"], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split()[:5] == ["right", "is", "equal", "wrong", "differs"], done.stdout


def test_a_part_that_is_not_modelled_is_refused() -> None:
    with pytest.raises(ToolError, match="a block of the chip that is not modelled: nothing drives n7"):
        check_driven("module chip(input clock);\nwire n6, n7;\nassign n6 = n7;\nendmodule\n")
