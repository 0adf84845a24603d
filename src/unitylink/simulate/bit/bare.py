# SPDX-License-Identifier: BSD-3-Clause
"""A design on a bare chip: placed on an iCE40 HX8K with each port at a pin, packed, and unpacked again."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
from pathlib import Path

from unitylink.boards.families import FAMILIES, overflow
from unitylink.boards.memories import memories_of, shortage
from unitylink.errors import BoardError, ToolError
from unitylink.gateware import find_program, map_cells, ports_of, run_tool

from ..rtl.build import Progress, build_of_netlist, netlist_of, on_terminal
from ..rtl.cache import cached
from ..rtl.design import RtlDesign, RtlModel
from .unpack import CELLS, Chip, unpack

DEVICE, PACKAGE = "hx8k", "ct256"  # the largest iCE40, with 206 pins
_CLOCK_HZ = 12_000_000  # nothing here depends on it, because there is no PLL
_BEL = re.compile(r"X(\d+)/Y(\d+)/io(\d)")
_PORT_AT = re.compile(r"(\w+)(?:\[(\d+)\])?\$sb_io")


def build_on_chip(design: RtlDesign, progress: Progress | None = None) -> RtlModel:
    """Return `design` as `build_model` does, but as an HX8K has it: unpacked from a bitstream.

    The design and its ports are the same in every clock. It takes about a minute the first time. Raises
    ToolError, and BoardError if it does not fit.
    """
    say = progress if progress is not None else on_terminal()
    try:
        with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
            say(f"placing {design.top}: ghdl")
            verilog = netlist_of(design, Path(work), assertions=False)
        placed = on_chip(verilog, design.top, say)
        library = build_of_netlist(placed, design.top, say, design.pins)
    finally:
        say("")
    return RtlModel(library, design.read_addresses, design.write_addresses, design.pin_places)


def on_chip(verilog: str, top: str, say: Progress) -> str:
    """Return Verilog with a module `top` that does what `top` of the netlist `verilog` does: it is on a chip.

    The bitstream comes from the cache if it is there.
    """
    placer = FAMILIES["ice40"].placers[0]
    versions = [
        run_tool([name, option], joined=True).out for name, option in (("yosys", "-V"), (placer, "--version"))
    ]
    key = hashlib.sha256("\0".join((verilog, top, *versions)).encode()).hexdigest()[:32]

    def build(file: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
            file.write_text(json.dumps(place(verilog, top, Path(work), say)), encoding="utf-8")

    kept = json.loads(cached(key, build, say, kind="bit", suffix=".json").read_text(encoding="utf-8"))
    sites: dict[str, str] = kept["sites"]
    say(f"placing {top}: unpacking")
    chip = unpack(
        bytes.fromhex(kept["bitstream"]),
        device=DEVICE,
        package=None,
        clock_site=sites["clock"],
        clock_hz=_CLOCK_HZ,
    )
    return with_ports(chip, verilog, top, sites)


def place(verilog: str, top: str, folder: Path, say: Progress) -> dict[str, object]:
    """Return the bitstream, and the site of each bit of a port."""
    family = FAMILIES["ice40"]
    placer, packer = (
        find_program(names, remedy)
        for names, remedy in ((family.placers, family.place_remedy), (family.packers, family.pack_remedy))
    )
    if memories := shortage(memories_of(verilog, top), DEVICE):
        raise BoardError(f"{top} does not fit on an {DEVICE}: " + "\n  ".join(memories))
    (folder / "design.v").write_text(verilog, encoding="utf-8")
    say(f"placing {top}, this once: yosys")
    map_cells(family.synthesis, top.lower(), ["design.v"], "design.json", folder)
    say(f"placing {top}, this once: nextpnr")
    files = ["--json", "design.json", "--asc", "design.asc", "--write", "placed.json"]
    options = [f"--{DEVICE}", "--package", PACKAGE, "--seed", "1", "--timing-allow-fail"]
    ended = run_tool([placer, *options, *files], folder, joined=True)
    if ended.code != 0:
        if too_many := overflow(ended.out):
            text = ", ".join(f"{used} {cell} and it has {there}" for cell, used, there in too_many)
            raise BoardError(f"{top} does not fit on an {DEVICE}: it takes {text}")
        lines = [line for line in ended.out.splitlines() if "ERROR" in line]
        raise ToolError("nextpnr failed:\n" + "\n".join(lines))
    ended = run_tool([packer, "design.asc", "design.bin"], folder, joined=True)
    if ended.code != 0:
        raise ToolError(f"icepack ended with {ended.code}: {ended.out.strip()}")
    placed = json.loads((folder / "placed.json").read_text(encoding="utf-8"))
    sites = {}
    for module in placed["modules"].values():
        for name, cell in module["cells"].items():
            port, bel = _PORT_AT.fullmatch(name), _BEL.fullmatch(cell["attributes"].get("NEXTPNR_BEL", ""))
            if port and bel:
                sites[port[1] if port[2] is None else f"{port[1]}[{port[2]}]"] = "_".join(bel.groups())
    return {"bitstream": (folder / "design.bin").read_bytes().hex(), "sites": sites}


def with_ports(chip: Chip, verilog: str, top: str, sites: dict[str, str]) -> str:
    """Return `chip` with the ports that the design had."""
    heads, links = [], []
    for port in ports_of(verilog, top):
        heads.append(f"{'input ' if port.is_input else 'output'} {port.range}{port.name}")
        for bit in range(port.bits):
            name = port.name if port.bits == 1 else f"{port.name}[{bit}]"
            site = sites.get(name, "")
            if port.is_input and site in chip.inputs:
                links.append(f".pin_{site}_in({name})")
            elif not port.is_input and site in chip.outputs:
                links.append(f".pin_{site}_out({name})")
            elif not port.is_input:
                raise ToolError(f"{top}: the bitstream does not drive {name}")
    head = ",\n   ".join(heads)
    body = "chip chip_(.clock(clock), " + ", ".join(links) + ");"
    around = f"module {top.lower()}\n  ({head});\n{body}\nendmodule\n"
    return around + chip.verilog + CELLS.read_text(encoding="utf-8")
