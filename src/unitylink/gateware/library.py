# SPDX-License-Identifier: BSD-3-Clause
"""The VHDL library of the gateware, so that its names never meet those of a user."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from unitylink.errors import ToolError

from .dependencies import entities_of, units_of
from .ghdl import Ghdl
from .sources import gateware_sources, simulation_sources

LIBRARY = "unitylink"
_ABSENT = re.compile(r'unit "(\w+)" not found in library "work"')


class DesignGhdl(Ghdl):
    """The gateware in the library `unitylink`, and VHDL of a user in the library `work`.

        ghdl = DesignGhdl(folder, gateware_sources(), [Path("board.vhd")])
        ghdl.make("board")

    So a user's own `fifo` stands beside `unitylink.fifo`. The gateware itself says `work`, which is the
    library that it is analysed into. Raises ToolError, as Ghdl does.
    """

    def __init__(self, work: Path, gateware: Sequence[Path], own: Sequence[Path]) -> None:
        super().__init__(work, own)
        self._call("-i", "--std=08", f"--work={LIBRARY}", *map(str, gateware))

    def make(self, top: str) -> None:
        """Analyse the entity `top` of the user, and whatever it needs."""
        try:
            super().make(top)
        except ToolError as error:
            ours = units_of([*gateware_sources(), *simulation_sources()])
            if missed := [name for name in _ABSENT.findall(str(error)) if name in ours]:
                raise ToolError(
                    f"{error}\n{missed[0]} is in the library {LIBRARY}: "
                    f"write `library {LIBRARY};` and {LIBRARY}.{missed[0]}"
                ) from None
            raise


class ModuleNames:
    """Gives the entities of the gateware names with the prefix `unitylink_`, for a netlist in Verilog.

    Verilog has no libraries, and GHDL calls a module by its entity alone. So two entities `fifo` of two
    libraries would become two modules `fifo`. `folder` gets the copies in which the names are others.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._original: dict[str, Path] = {}
        names = "|".join(sorted(entities_of(gateware_sources())))
        self._own_place = re.compile(rf"\b{LIBRARY}(\s*\.\s*)({names})\b", re.IGNORECASE)
        heads = r"\bentity\s+(?:work\s*\.\s*)?|\barchitecture\s+\w+\s+of\s+"
        self._new_name = re.compile(rf"\b{LIBRARY}_({names})\b", re.IGNORECASE)
        self._our_place = re.compile(rf"({heads})({names})\b", re.IGNORECASE)

    def of_gateware(self) -> list[Path]:
        """Return copies of the gateware, in which each entity has its new name."""
        return [self._copy(path, self._our_place, rf"\1{LIBRARY}_\2") for path in gateware_sources()]

    def of_user(self, sources: Sequence[Path]) -> list[Path]:
        """Return `sources`. A copy stands for each that names an entity of the gateware."""
        return [self._copy(path, self._own_place, rf"{LIBRARY}\1{LIBRARY}_\2") for path in sources]

    def original(self, message: str) -> str:
        """Return a message of GHDL with the names of the user's files."""
        for copy, path in self._original.items():
            message = message.replace(copy, str(path))
        return self._new_name.sub(r"\1", message)

    def _copy(self, path: Path, place: re.Pattern[str], name: str) -> Path:
        if not path.is_file():
            return path  # GHDL's caller says that it is absent
        text = path.read_text(encoding="utf-8", errors="surrogateescape")
        renamed = place.sub(name, text)
        if renamed == text:
            return path
        copy = self._folder / f"{len(self._original)}_{path.name}"
        copy.write_text(renamed, encoding="utf-8", errors="surrogateescape")
        self._original[str(copy)] = path
        return copy
