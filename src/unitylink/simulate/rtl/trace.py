# SPDX-License-Identifier: BSD-3-Clause
"""Lets a compiled design write the program steps of its small engine (docs/gateware/framed_small.md)."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from unitylink.errors import ToolError
from unitylink.gateware import LIBRARY, gateware_folder
from unitylink.interface.board_configuration import BoardConfiguration

_PROCESSOR = re.compile(rf"^module {LIBRARY}_byte_processor_\w+\n.*?(?=^endmodule)", re.MULTILINE | re.DOTALL)
_POSITION = re.compile(r"^  reg \[(\d+):0\] position;$", re.MULTILINE)
_PROGRAMS = {9: "plain", 10: "publishing"}  # highest bit of a place -> name of the program
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


def traceable(file: str, configuration: BoardConfiguration) -> str:
    """Return the full path of `file`, which is empty now.

    Raises ToolError: a design of this configuration has no small engine, or `file` cannot be written.
    """
    if configuration.engine != "small" or configuration.protocol != "framed":
        raise ToolError(
            "trace_program is for the small engine, and this design has the fast one or speaks text; "
            "add engine=small and protocol=framed"
        )
    path = Path(file).resolve()
    try:
        path.write_text("", encoding="utf-8")
    except OSError as error:
        raise ToolError(f"trace_program={file}: {error.strerror or error}") from error
    return str(path)


def calls_of(places: Sequence[str], file: str) -> str:
    """Return the C++ that writes the text of each place, of `places`, into `file`."""
    start = next(n for n, text in enumerate(places) if re.match(r"\w+ next:", text))
    head = [
        f"#define TRACE_FILE {json.dumps(file)}",
        f"#define TRACE_NEXT {start}u",
        f"static const char* const trace_lines[{max(_ROOM)}] = {{",
        *(f"{json.dumps(text)}," for text in places),
        "};",
    ]
    return "\n".join([*head, (Path(__file__).parent / "trace.cpp").read_text(encoding="utf-8")])


def traced(netlist: str, file: str) -> tuple[str, str]:
    """Return `netlist` with a call for each program step, and the C++ that is called and writes `file`.

    Raises ToolError if the netlist has no small engine as GHDL 2.0 prints it.
    """
    found = _PROCESSOR.search(netlist)
    high = _POSITION.search(found[0]) if found else None
    if found is None or high is None or int(high[1]) not in _PROGRAMS:
        raise ToolError("trace_program: the netlist has no small engine; is this GHDL newer than 2.0?")
    end = found.end()
    steps = _STEPS.format(high=high[1])
    return netlist[:end] + steps + netlist[end:], calls_of(program_lines(_PROGRAMS[int(high[1])]), file)


def program_texts() -> str:
    """Return the texts of both programs, for the key of what is compiled."""
    return repr([program_lines(name) for name in _PROGRAMS.values()])


def program_lines(name: str) -> list[str]:
    """Return the text of each place of the program "plain" or "publishing", in the order of the places."""
    path = gateware_folder() / "small" / f"{name}_program.txt"
    return [line for line in path.read_text(encoding="ascii").splitlines() if not line.startswith("#")]
