# SPDX-License-Identifier: BSD-3-Clause
"""The memories of a netlist and the block RAMs that they need, before anything is mapped on a chip."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from unitylink.gateware import LIBRARY

# Bits and words of an iCE40's block RAM are from Lattice, "Memory Usage Guide for iCE40 Devices". The number
# in each chip is from "iCE40 LP/HX Family Data Sheet" and "iCE40 UltraPlus Family Data Sheet".
_SHAPES = ((16, 256), (8, 512), (4, 1024), (2, 2048))
BLOCK_RAMS: Mapping[str, int] = MappingProxyType(
    {"lp384": 0, "lp1k": 16, "hx1k": 16, "lp8k": 32, "hx8k": 32, "up5k": 30}
)

_MODULE = re.compile(r"^module (\w+)", re.MULTILINE)
_ARRAY = re.compile(r"^\s*reg \[(\d+):0\] (\w+)\s*\[(\d+):0\]", re.MULTILINE)
_READ_AT_ONCE = re.compile(r"^\s*assign (\w+) = (\w+)\[\w+\];", re.MULTILINE)
_WRITTEN = re.compile(r"^\s*(\w+)\[\w+\] <= ", re.MULTILINE)
_GENERICS = re.compile(r"(_\d+)*(_[0-9a-f]{40})?$")  # GHDL appends this to the name of an entity
_OURS = re.compile(rf"^{LIBRARY}_")  # a netlist has no libraries
_INSTANCE = re.compile(r"^\s+(\w+) \w+ \($", re.MULTILINE)


@dataclass(frozen=True)
class Memory:
    """`count` memories of `words` words of `bits` bits, in instances of one module."""

    module: str
    words: int
    bits: int
    count: int = 1

    @property
    def block_rams(self) -> int:
        """Return how many block RAMs of an iCE40 they take."""
        return self.count * min(-(-self.bits // wide) * -(-self.words // deep) for wide, deep in _SHAPES)

    def __str__(self) -> str:
        times = f"{self.count} times " if self.count > 1 else ""
        entity = _OURS.sub(f"{LIBRARY}.", _GENERICS.sub("", self.module))
        return f"{self.block_rams} in {entity}: {times}{self.words:,} words of {self.bits} bits"


def memories_of(netlist: str, top: str) -> list[Memory]:
    """Return the memories below the module `top` of a netlist that GHDL made, the largest first.

    >>> text = "module a\\n  reg [7:0] words[511:0] ; // memory\\nendmodule\\n"
    >>> text += "module b\\n  a one (\\n  a two (\\n"
    >>> [str(memory) for memory in memories_of(text, "b")]
    ['2 in a: 2 times 512 words of 8 bits']
    """
    memories: dict[str, list[Memory]] = {}
    inside: dict[str, list[str]] = {}
    for text in netlist.split("endmodule"):
        head = _MODULE.search(text)
        if head is None:
            continue
        # A table becomes logic if nothing writes to it and its words go into no register.
        written = set(_WRITTEN.findall(text))
        tables = {
            name
            for data, name in _READ_AT_ONCE.findall(text)
            if name not in written and not re.search(rf"(<=|\?) {data}\b", text)
        }
        memories[head[1]] = [
            Memory(head[1], int(last) + 1, int(high) + 1)
            for high, name, last in _ARRAY.findall(text)
            if name not in tables
        ]
        inside[head[1]] = _INSTANCE.findall(text)
    counts: dict[str, int] = {}

    def count(name: str) -> None:
        counts[name] = counts.get(name, 0) + 1
        for inner in inside.get(name, ()):
            count(inner)

    count(top.lower())
    found = [replace(memory, count=counts[name]) for name in counts for memory in memories.get(name, ())]
    return sorted(found, key=lambda memory: -memory.block_rams)


def shortage(memories: Iterable[Memory], device: str) -> Sequence[str]:
    """If the chip has too few block RAMs, return what uses them, one line each. Otherwise return nothing.

    A chip that is not in BLOCK_RAMS is never refused here.
    """
    told = list(memories)
    there = BLOCK_RAMS.get(device)
    needed = sum(memory.block_rams for memory in told)
    if there is None or needed <= there:
        return ()
    return (f"it takes {needed} block RAMs and the chip has {there}", *map(str, told))
