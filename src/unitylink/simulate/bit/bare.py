# SPDX-License-Identifier: BSD-3-Clause
"""A design on a bare chip: placed with each port at a pin, packed, and unpacked again."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from unitylink.boards.families import FAMILIES, overflow
from unitylink.boards.memories import memories_of, shortage
from unitylink.errors import BoardError, ToolError
from unitylink.gateware import find_program, map_cells, ports_of, run_tool

from ..rtl.build import Progress, build_of_netlist, netlist_of, on_terminal
from ..rtl.cache import cached
from ..rtl.design import RtlDesign, RtlModel
from . import ecp5
from .chip import CELLS, Chip
from .unpack import UNPACKERS

_CLOCK_HZ = 12_000_000  # nothing here depends on it, because there is no PLL
_PLACE = re.compile(r"/\* [^*\n]+:\d+:\d+  \*/")  # GHDL's comment: where in the VHDL a line comes from


@dataclass(frozen=True)
class BareChip:
    """A chip without a board. `pin` is nextpnr's place of a pin, and `port` its name of a pin's buffer."""

    family: str
    device: str
    package: str
    files: tuple[str, str]  # nextpnr's option for the routed design, and the bitstream's name
    pin: re.Pattern[str]
    port: re.Pattern[str]

    def site(self, place: re.Match[str]) -> str:
        """Return the pin that `place` is, as `unpack` calls it."""
        if self.family == "ice40":
            return "_".join(place.groups())
        column, row, letter = place.groups()
        return ecp5.site_at(self.device, self.package, int(row), int(column), letter)

    def unpack(self, bitstream: bytes, clock_site: str) -> Chip:
        """Return the logic of a bitstream for this chip."""
        package = None if self.family == "ice40" else self.package  # see `site`
        return UNPACKERS[self.family](
            bitstream, device=self.device, package=package, clock_site=clock_site, clock_hz=_CLOCK_HZ
        )


HX8K = BareChip(
    "ice40",
    "hx8k",
    "ct256",  # the largest iCE40, with 206 pins
    ("--asc", "design.bin"),
    re.compile(r"X(\d+)/Y(\d+)/io(\d)"),
    re.compile(r"(\w+)(?:\[(\d+)\])?\$sb_io"),
)
ECP5 = BareChip(
    "ecp5",
    "45k",
    "CABGA554",  # 245 pins
    ("--textcfg", "design.bit"),
    re.compile(r"X(\d+)/Y(\d+)/PIO([A-D])"),
    re.compile(r"(\w+)(?:\[(\d+)\])?\$tr_io"),
)
BARE_CHIPS = {"hx8k": HX8K, "ecp5": ECP5}


def build_on_chip(design: RtlDesign, progress: Progress | None = None, bare: BareChip = HX8K) -> RtlModel:
    """Return `design` as `build_model` does, but as a chip has it: unpacked from a bitstream.

    The design and its ports are the same in every clock. It takes about a minute the first time. Raises
    ToolError, and BoardError if it does not fit.
    """
    say = progress if progress is not None else on_terminal()
    try:
        with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
            say(f"placing {design.top}: ghdl")
            verilog = netlist_of(design, Path(work), assertions=False)
        placed = on_chip(verilog, design.top, say, bare)
        library = build_of_netlist(placed, design.top, say, design.pins)
    finally:
        say("")
    return RtlModel(library, design.read_addresses, design.write_addresses, design.pin_places)


def on_chip(verilog: str, top: str, say: Progress, bare: BareChip = HX8K) -> str:
    """Return Verilog with a module `top` that does what `top` of the netlist `verilog` does: it is on a chip.

    The bitstream comes from the cache if it is there.
    """
    verilog = _PLACE.sub("", verilog)  # with names of a folder that is another one each time
    placer = find_program(FAMILIES[bare.family].placers, FAMILIES[bare.family].place_remedy)
    versions = [
        run_tool([name, option], joined=True).out for name, option in (("yosys", "-V"), (placer, "--version"))
    ]
    key = hashlib.sha256(
        "\0".join((verilog, top, bare.device, bare.package, *versions)).encode()
    ).hexdigest()[:32]

    def build(file: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
            file.write_text(json.dumps(place(verilog, top, Path(work), say, bare)), encoding="utf-8")

    kept = json.loads(cached(key, build, say, kind="bit", suffix=".json").read_text(encoding="utf-8"))
    sites: dict[str, str] = kept["sites"]
    say(f"placing {top}: unpacking")
    chip = bare.unpack(bytes.fromhex(kept["bitstream"]), sites["clock"])
    return with_ports(chip, verilog, top, sites)


def place(verilog: str, top: str, folder: Path, say: Progress, bare: BareChip = HX8K) -> dict[str, object]:
    """Return the bitstream, and the site of each bit of a port."""
    family, (option, made) = FAMILIES[bare.family], bare.files
    placer = find_program(family.placers, family.place_remedy)
    if memories := shortage(memories_of(verilog, top), bare.device):
        raise BoardError(f"{top} does not fit on an {bare.device}: " + "\n  ".join(memories))
    (folder / "design.v").write_text(verilog, encoding="utf-8")
    say(f"placing {top}, this once: yosys")
    map_cells(family.synthesis, top.lower(), ["design.v"], "design.json", folder)
    say(f"placing {top}, this once: nextpnr")
    files = ["--json", "design.json", option, "design.routed", "--write", "placed.json"]
    free = f"--{family.constraints}-allow-unconstrained"
    options = [f"--{bare.device}", "--package", bare.package, free, "--seed", "1", "--timing-allow-fail"]
    ended = run_tool([placer, *options, *files], folder, joined=True)
    if ended.code != 0:
        if too_many := overflow(ended.out):
            text = ", ".join(f"{used} {cell} and it has {there}" for cell, used, there in too_many)
            raise BoardError(f"{top} does not fit on an {bare.device}: it takes {text}")
        lines = [line for line in ended.out.splitlines() if "ERROR" in line]
        raise ToolError("nextpnr failed:\n" + "\n".join(lines))
    ended = run_tool(family.pack_command("design.routed", made), folder, joined=True)
    if ended.code != 0:
        raise ToolError(f"{family.packers[0]} ended with {ended.code}: {ended.out.strip()}")
    placed = json.loads((folder / "placed.json").read_text(encoding="utf-8"))
    sites = {}
    for module in placed["modules"].values():
        for name, cell in module["cells"].items():
            port, bel = (
                bare.port.fullmatch(name),
                bare.pin.fullmatch(cell["attributes"].get("NEXTPNR_BEL", "")),
            )
            if port and bel:
                sites[port[1] if port[2] is None else f"{port[1]}[{port[2]}]"] = bare.site(bel)
    return {"bitstream": (folder / made).read_bytes().hex(), "sites": sites}


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
