# SPDX-License-Identifier: BSD-3-Clause
"""The ports of a module of a netlist."""

from __future__ import annotations

import re
from dataclasses import dataclass

from unitylink.errors import ToolError

_HEAD = r"^module {top}\s*\n\s*\((.*?)\);"
_PORT = re.compile(r"(input|output|inout)\s+(?:\[(\d+):0\]\s*)?(\w+)")


@dataclass(frozen=True)
class Port:
    """A port of a module. `bits` is its width."""

    name: str
    is_input: bool
    bits: int

    @property
    def range(self) -> str:
        return f"[{self.bits - 1}:0] " if self.bits > 1 else ""


def ports_of(netlist: str, top: str) -> tuple[Port, ...]:
    """Return the ports of the module `top` of a netlist that GHDL made.

    Raises ToolError: there is no such module, or it has an inout, which nothing here can drive.

    >>> ports_of("module lamp\\n  (input  clock,\\n   output [1:0] pins);", "lamp")[1]
    Port(name='pins', is_input=False, bits=2)
    """
    head = re.search(_HEAD.format(top=re.escape(top.lower())), netlist, re.DOTALL | re.MULTILINE)
    if head is None:
        raise ToolError(f"the netlist has no module {top}")
    found = _PORT.findall(head.group(1))
    if both := [name for way, _, name in found if way == "inout"]:
        raise ToolError(
            f"{top}: {both[0]} is an inout; make it three ports, {both[0]}_in, {both[0]}_out, {both[0]}_drive"
        )
    return tuple(Port(name, way == "input", int(high or 0) + 1) for way, high, name in found)
