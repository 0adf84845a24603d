# SPDX-License-Identifier: BSD-3-Clause
"""The cheaper netlist does the same. Yosys proves this for each register's next state and each output."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from unitylink.gateware import netlist
from unitylink.simulate.rtl.lean import lean

# A small example of what GHDL makes of the designs below: a wide register that holds, under a reset and a
# choice.
HOLDS = """module holds
  (input  clock,
   input  reset,
   input  takes,
   input  [79:0] word,
   output [79:0] q);
  wire [79:0] kept;
  reg [79:0] n3_q;
  wire [79:0] n1_o;
  wire [79:0] n2_o;
  assign q = n3_q;
  assign kept = n3_q; // (signal)
  assign n1_o = takes ? word : kept;
  assign n2_o = reset ? 80'b0 : n1_o;
  always @(posedge clock)
    n3_q <= n2_o;
endmodule
"""
PROOF = """
read_verilog {0}.v
prep -flatten -top {top}
memory_map
design -stash {0}
"""
EQUAL = """
design -copy-from before -as before {top}
design -copy-from after -as after {top}
equiv_make before after equal
prep -top equal
equiv_struct
equiv_simple -seq 1
equiv_status -assert
"""


def proven_equal(before: str, after: str, top: str, folder: Path) -> bool:
    for name, text in (("before", before), ("after", after)):
        (folder / f"{name}.v").write_text(text)
    script = "".join(PROOF.format(name, top=top) for name in ("before", "after")) + EQUAL.format(top=top)
    command = ["yosys", "-q", "-p", script]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    failed = "unproven $equiv cells" in done.stderr
    assert failed == (done.returncode != 0), done.stderr
    return not failed


def of_entity(top: str, **generics: int) -> str:
    """Return the netlist of an entity without its assertions, which yosys does not know in this form."""
    printed = netlist(top, generics=generics)
    return re.sub(r"always @\*\s*if \(!\w+\)\s*\$fatal\([^;]*;", "", printed)


def test_groups_set_and_cleared_by_number(tmp_path: Path) -> None:
    before = of_entity("subscription_manager", groups=9, group_size=2)
    after = lean(before)
    assert after.count("(9'b1 << ") > before.count("9'b1 << ") + 3
    assert proven_equal(before, after, "subscription_manager", tmp_path)
    moved = after.replace("(9'b1 << ", "(9'b10 << ", 1)
    assert not proven_equal(before, moved, "subscription_manager", tmp_path)


def test_fields_of_records(tmp_path: Path) -> None:
    before = of_entity("application_switch")
    after = lean(before)
    assert "__" in after, "no choice between records was made field by field"
    assert proven_equal(before, after, "application_switch", tmp_path)


def test_wide_registers_that_hold(tmp_path: Path) -> None:
    after = lean(HOLDS)
    assert "if (reset) begin n3_q <= 80'b0; end else begin if (takes) begin n3_q <= word; end end" in after
    assert proven_equal(HOLDS, after, "holds", tmp_path)
    assert not proven_equal(HOLDS, after.replace("(takes)", "(!takes)"), "holds", tmp_path)


@pytest.mark.parametrize("kind", ["~", "&"])
def test_wires_in_a_loop_are_left_alone(kind: str) -> None:
    """A loop is a mistake in the design, and other tools report it. Here the function only has to end."""
    ring = "  wire a;\n  wire b;\n  assign a = {0};\n  assign b = {1};\n"
    looped = ring.format("~b", "~a") if kind == "~" else ring.format("b & b", "a & a")
    text = "module ring\n  (output [3:0] q);\n" + looped + "  assign q = {a, b, a, b};\nendmodule\n"
    assert "assign q = {a, b, a, b};" in lean(text)


def test_a_wire_that_is_said_to_be_itself_is_left_out() -> None:
    """GHDL says so of a signal of a generate statement that an instance drives."""
    text = HOLDS.replace(
        "  assign kept = n3_q;", "  assign reset = reset; // (signal)\n  assign kept = n3_q;"
    )
    assert lean(text) == lean(HOLDS)
