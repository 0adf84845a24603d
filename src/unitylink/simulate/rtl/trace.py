# SPDX-License-Identifier: BSD-3-Clause
"""Lets a compiled design write the program steps of its engine (docs/rtl-simulation.md)."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from unitylink.errors import ToolError
from unitylink.gateware import LIBRARY, gateware_folder
from unitylink.gateware.framed_program import program_of
from unitylink.interface.board_configuration import BoardConfiguration

_MODULE = rf"^module {LIBRARY}_%s_\w+\n.*?(?=^endmodule)"
_PROCESSOR, _SEQUENCER = (
    re.compile(_MODULE % name, re.MULTILINE | re.DOTALL) for name in ("byte_processor", "frame_sequencer")
)
_POSITION = re.compile(r"^  (?:reg|wire) \[(\d+):0\] position;$", re.MULTILINE)
_PROGRAMS = {9: "plain", 10: "publishing"}  # highest bit of a place -> name of the program
_NOWHERE = 0xFFFFFFFF  # no place: the program itself does not lead from one pass to the next
_ROOM = [2 << bit for bit in _PROGRAMS]
# In the clock in which `execute` is high, the place that was fetched last is executed.
_STEPS = """
  reg [{high}:0] traced_place;
  reg [63:0] traced_clock = 0;
  reg traced_begun = 0;
  always @(posedge clock) begin
    traced_clock <= traced_clock + 1;
    traced_begun <= !reset & (traced_begun | !execute);
    if (execute) begin
      traced_place <= position;
      if (traced_begun) $c("unitylink_step(", traced_clock, ", ", traced_place, ");");
    end
  end
"""
# Of the fast engine. While one instruction is executed, the one that follows is fetched. A pass is one work.
_FAST_STEPS = """
  reg [{high}:0] traced_ahead, traced_place;
  reg [63:0] traced_clock = 0;
  reg traced_idle = 1;  // nothing is executed
  always @(posedge clock) begin
    traced_clock <= traced_clock + 1;
    if (step | reset) traced_idle <= clears;
    if (fetches) traced_ahead <= position;
    if (step) traced_place <= traced_ahead;
    if (step & !traced_idle & !reset) $c("unitylink_step(", traced_clock, ", ", traced_place, ");");
    if (step & resting) $c("unitylink_pass();");
  end
"""


def traceable(file: str, configuration: BoardConfiguration) -> str:
    """Return the full path of `file`, which is empty now.

    Raises ToolError: a design of this configuration speaks no frames, or `file` cannot be written.
    """
    if configuration.protocol == "classic":
        raise ToolError(
            "trace_program is for the engines of the framed protocol, and this design speaks text alone; "
            "add protocol=framed"
        )
    path = Path(file).resolve()
    try:
        path.write_text("", encoding="utf-8")
    except OSError as error:
        raise ToolError(f"trace_program={file}: {error.strerror or error}") from error
    return str(path)


def calls_of(places: Sequence[str], file: str) -> str:
    """Return the C++ that writes the text of each place, of `places`, into `file`."""
    start = next((n for n, text in enumerate(places) if re.match(r"\w+ next:", text)), _NOWHERE)
    head = [
        f"#define TRACE_FILE {json.dumps(file)}",
        f"#define TRACE_NEXT {start}u",
        f"static const char* const trace_lines[{max(_ROOM)}] = {{",
        *(f"{json.dumps(text)}," for text in places),
        "};",
    ]
    return "\n".join([*head, (Path(__file__).parent / "trace.cpp").read_text(encoding="utf-8")])


def traced(netlist: str, file: str, settings: str) -> tuple[str, str]:
    """Return `netlist` with a call for each program step, and the C++ that is called and writes `file`.

    `settings` are those of the core, as VHDL. Raises ToolError if the netlist has no engine as GHDL 2.0
    prints it, or a program of other settings.
    """
    found = _PROCESSOR.search(netlist) or _SEQUENCER.search(netlist)
    high = _POSITION.search(found[0]) if found else None
    if found is None or high is None:
        raise ToolError("trace_program: the netlist has no engine; is this GHDL newer than 2.0?")
    end = found.end()
    if found.re is _PROCESSOR:
        steps, places = _STEPS, program_lines(_PROGRAMS[int(high[1])])
    else:
        steps, places = _FAST_STEPS, _fast_lines(found[0], settings)
    return netlist[:end] + steps.format(high=high[1]) + netlist[end:], calls_of(places, file)


def _fast_lines(module: str, settings: str) -> list[str]:
    """Return the text of each place of the program in the netlist `module` of the sequencer."""
    program = program_of(settings)
    has = {int(bits, 2) for bits in re.findall(r"80'b([01]{80})\b", module)}
    if not has.issuperset(program.words):
        raise ToolError(
            "trace_program: the program of this design is not that of its settings; give RtlBoard the "
            "configuration of the design"
        )
    return program.lines()


def program_texts() -> str:
    """Return the texts of both programs, for the key of what is compiled."""
    return repr([program_lines(name) for name in _PROGRAMS.values()])


def program_lines(name: str) -> list[str]:
    """Return the text of each place of the program "plain" or "publishing", in the order of the places."""
    path = gateware_folder() / "small" / f"{name}_program.txt"
    return [line for line in path.read_text(encoding="ascii").splitlines() if not line.startswith("#")]
