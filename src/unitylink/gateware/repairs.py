# SPDX-License-Identifier: BSD-3-Clause
"""Repairs what GHDL 2.0 prints wrongly in Verilog, without a warning.

The same netlist printed as VHDL is right and has the same net names. So the missing parts are taken from
there. Correct output of a GHDL is left alone.
"""

from __future__ import annotations

import re

from unitylink.errors import ToolError

_VERILOG_WORDS = """
always assign automatic buf bufif0 bufif1 casex casez cell cmos config deassign defparam design disable
edge endcase endconfig endfunction endgenerate endmodule endprimitive endspecify endtable endtask event
force forever fork genvar highz0 highz1 ifnone incdir initial input instance integer join large liblist
localparam macromodule medium module negedge nmos noshowcancelled notif0 notif1 output pmos posedge
primitive pull0 pull1 pulldown pullup pulsestyle_onevent rcmos real realtime reg repeat rnmos rpmos rtran
scalared showcancelled signed small specify specparam strong0 strong1 supply0 supply1 table task time tran
tri tri0 tri1 triand trior trireg unsigned uwire vectored wand weak0 weak1 wire wor
"""  # of Verilog-2005, but those that VHDL keeps for itself too

_MODULE = re.compile(r"module\s+(\S+)")
_CASE = re.compile(r"\s*case \(")
_ARM = re.compile(r"\s*(?:\d+'[bh][0-9a-fxz]+|(default)): (\S+) <= ", re.IGNORECASE)
_ARCHITECTURE = re.compile(r"^architecture\s+\S+\s+of\s+(\S+)\s+is", re.IGNORECASE | re.MULTILINE)
_SELECT = re.compile(
    r"^\s*with\s+\S+\s+select\s+(\S+)\s*<=\s*(.*?);", re.IGNORECASE | re.DOTALL | re.MULTILINE
)
_OTHERS = re.compile(r"(?:^|,)\s*([^,]*?)\s+when\s+others\s*$", re.IGNORECASE | re.DOTALL)
_DECLARED = re.compile(
    r"^\s*(?:signal\s+(\w+)\s*:|(\w+)\s*:\s*(?:in|out|inout|entity)\s)", re.IGNORECASE | re.MULTILINE
)


def repaired(verilog: str, vhdl: str) -> str:
    """Return the netlist `verilog`, with the parts that GHDL omitted taken from the same netlist in `vhdl`.
    Raise ToolError."""
    refuse_verilog_words(vhdl)
    return with_signed_shifts(with_sized_constants(with_default_arms(verilog, vhdl)))


def with_default_arms(verilog: str, vhdl: str) -> str:
    """Give every `case` its default arm, which GHDL 2.0 leaves out (ghdl#2041, right from 3.0 on).

    Without it a tool makes a latch of the case, or assumes that the missing case never happens.
    """
    defaults = _default_arms(vhdl)
    out: list[str] = []
    module = target = ""
    complete = False
    for line in verilog.split("\n"):
        if found := _MODULE.match(line):
            module = found.group(1).lower()
        elif _CASE.match(line):
            target, complete = "", False
        elif found := _ARM.match(line):
            target = found.group(2)
            complete = complete or found.group(1) is not None
        elif line.strip() == "endcase" and not complete:
            value = defaults.get((module, target.lower()))
            if value is None:
                raise ToolError(
                    f"GHDL left the default arm of a case out: net {target!r} of {module}, and what it was "
                    "is not known; GHDL 3 or newer prints it"
                )
            out.append(f"      default: {target} <= {value};")
        out.append(line)
    return "\n".join(out)


def with_sized_constants(verilog: str) -> str:
    """Print constants wider than 32 bits as numbers: GHDL 2.0 prints strings, which Verilog reads as ASCII.

    A constant of no bits, which Verilog does not have, becomes one bit that nothing reads.
    """
    sized = re.sub(
        r'"([01xz]{2,})"', lambda m: f"{len(m.group(1))}'b{m.group(1).lower()}", verilog, flags=re.I
    )
    return re.sub(r"= 0'b\w*;", "= 1'b0;", sized)


def with_signed_shifts(verilog: str) -> str:
    """Shift signed numbers as such: GHDL 2.0 prints `>>`, which in Verilog loses their sign."""
    return re.sub(r"(\$signed\([^()]*\)) >> ", r"\1 >>> ", verilog)


def refuse_verilog_words(vhdl: str) -> None:
    """Raise ToolError for names, also of labels, that are words of Verilog: GHDL 2.0 prints them as they
    are."""
    names = {next(filter(None, found)) for found in _DECLARED.findall(vhdl)}
    if clash := sorted(name for name in names if name.lower() in _VERILOG_WORDS.split()):
        raise ToolError(
            f"{', '.join(clash)}: a word of Verilog, through which the design goes; "
            "choose another name for it"
        )


def _default_arms(vhdl: str) -> dict[tuple[str, str], str]:
    """Return (module, net) -> the Verilog of its `when others`."""
    arms = {}
    starts = list(_ARCHITECTURE.finditer(vhdl))
    for start, end in zip(starts, [*(m.start() for m in starts[1:]), len(vhdl)], strict=True):
        body, module = vhdl[start.end() : end], start.group(1).lower()
        for net, choices in _SELECT.findall(body):
            if others := _OTHERS.search(choices):
                arms[module, net.lower()] = _verilog(others.group(1).strip(), body)
    return arms


def _verilog(value: str, architecture: str) -> str:
    """Translate the value of an arm: a bit, a string of bits, an aggregate of one bit, or a net."""
    if found := re.fullmatch(r"'(.)'", value):
        return f"1'b{_bits(found.group(1))}"
    if found := re.fullmatch(r'"([\w-]+)"', value):
        return f"{len(found.group(1))}'b{_bits(found.group(1))}"
    if found := re.fullmatch(r"\((\d+) downto 0 => '(.)'\)", value, re.IGNORECASE):
        return f"{{{int(found.group(1)) + 1}{{1'b{_bits(found.group(2))}}}}}"
    if re.fullmatch(r"\w+", value):
        # In the VHDL only, the top level's own ports are wrapped: declared so, without a space.
        return value.removeprefix("wrap_") if f"signal {value}: " in architecture else value
    raise ToolError(f"GHDL left a default arm out whose value {value!r} is not understood; GHDL 3 prints it")


def _bits(text: str) -> str:
    return re.sub(r"[^01z]", "x", text.lower())
