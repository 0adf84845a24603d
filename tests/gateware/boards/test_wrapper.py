# SPDX-License-Identifier: BSD-3-Clause
"""The wrapper of a bitstream, simulated by yosys: when the design leaves its reset."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from unitylink.boards import load_board
from unitylink.boards.pins import assign_pins
from unitylink.boards.pll import pll_of
from unitylink.boards.wrapper import RESET_S, wrapper
from unitylink.gateware import Port

BOARD = load_board("icebreaker")
PORTS = (Port("clock", True, 1), Port("reset", True, 1), Port("usb_rx", True, 1), Port("usb_tx", False, 1))
DESIGN = "module top(input clock, input reset, input usb_rx, output usb_tx); assign usb_tx = reset; endmodule"
# Its clock is that of the pin, and its lock is lost once.
PLL = """
module SB_PLL40_PAD #(parameter {parameters})(input PACKAGEPIN, RESETB, BYPASS, output PLLOUTGLOBAL, LOCK);
  reg [10:0] age = 0;
  always @(posedge PACKAGEPIN) age <= age + 1;
  assign PLLOUTGLOBAL = PACKAGEPIN;
  assign LOCK = age >= 100 && age != 1000;
endmodule
"""
CLOCKS = 1900


def resets(folder: Path, design: str) -> list[bool]:
    """Return whether the design is in reset, for each clock from power-up on."""
    (folder / "all.v").write_text(design, encoding="utf-8")
    script = (
        "read_verilog all.v; hierarchy -top unitylink_board; proc; flatten; opt_clean; "
        f"sim -clock {BOARD.clock_pin} -n {CLOCKS} -zinit -vcd all.vcd unitylink_board"
    )
    subprocess.run(["yosys", "-q", "-p", script], cwd=folder, check=True, capture_output=True, timeout=120)
    vcd = (folder / "all.vcd").read_text("utf-8")
    names = {name: key for key, name in re.findall(r"\$var wire 1 (\S+) (\S+)", vcd)}
    clock, line = names[BOARD.clock_pin], names[BOARD.tx]
    told, now = [], True
    for value, key in re.findall(r"^b(\w+) (\S+)$", vcd, re.MULTILINE):
        if key == line:
            now = value != "0"
        elif (value, key) == ("1", clock):
            told.append(now)
    return told


def test_a_design_leaves_its_reset_when_block_rams_can_be_read(tmp_path: Path) -> None:
    text = wrapper(BOARD, "top", PORTS, assign_pins(BOARD, [], []), None)
    told = resets(tmp_path, text + DESIGN)
    least = BOARD.clock_hz * RESET_S
    assert len(told) > 3 * least and told[0] and not told[-1]
    assert least <= told.index(False) <= 2.5 * least and not any(told[told.index(False) :])


@pytest.mark.parametrize("clock_hz", [24_000_000])
def test_a_pll_that_loses_its_lock_resets_anew(tmp_path: Path, clock_hz: int) -> None:
    pll = pll_of(BOARD.family, BOARD.clock_hz, clock_hz)
    text = wrapper(BOARD, "top", PORTS, assign_pins(BOARD, [], []), pll)
    stub = PLL.format(parameters=", ".join(f"{name} = 0" for name, _ in pll.parameters))
    told = resets(tmp_path, text + DESIGN + stub)
    least = clock_hz * RESET_S
    left = told.index(False)
    again = told.index(True, left)
    assert 100 + least <= left < 1000 <= again <= 1010
    assert told.index(False, again) >= again + least and not told[-1]
