# SPDX-License-Identifier: BSD-3-Clause
"""Find and read the files that a spec imports, and the constructors of the component library that it uses.

A file is named relative to the file that imports it, with `/` between folders. It is searched in that file's
folder, then in the folders of the search path. A name is never absolute and never leads up (`..`). No
symbolic link may lead out. So a spec reads only files below those folders.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType

from unitylink.resources import resource_folder

from ..report.diagnostics import Reporter
from ..source import MAX_BYTES, Source, decode
from .parser import parse
from .syntax import ExpansionNode, ImportNode, Program

MAX_FILES = 200

_PART = re.compile(r"[^\\/:*?\"<>|\x00-\x1f\x7f]+")


@cache  # here and below: no file of the library comes or goes while a program runs, and a search takes 1 ms
def component_names() -> tuple[str, ...]:
    """Return the names of the components."""
    folder = resource_folder("components")
    return tuple(sorted(one.name for one in folder.iterdir() if _described(one).is_file()))


@cache
def device_files() -> Mapping[str, Path]:
    """Return the file of each device of the library by its name.

    A device is a file `devices/NAME.ul` in the folder of the component whose entity it uses.
    """
    files = sorted(resource_folder("components").glob("*/devices/*.ul"))
    return MappingProxyType({one.stem: one for one in files})


def component_vhdl(entity: str) -> Path:
    """Return where the VHDL of a component of the library is, if it is one."""
    return resource_folder("components") / entity / f"{entity}.vhd"


def _described(folder: Path) -> Path:
    """Return the file in UL-spec of a component's folder."""
    return folder / f"{folder.name}.ul"


def is_below(name: str) -> bool:
    """Is this the name of a file below a folder: relative, with `/` between folders, without `..`?"""
    return all(_PART.fullmatch(part) and part not in (".", "..") for part in name.split("/"))


class Importer:
    """Reads a spec's main file and all files that it imports. `program` has everything that they declare."""

    def __init__(
        self,
        reporter: Reporter,
        include: Sequence[str | os.PathLike[str]],
        opened: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.reporter = reporter
        self.opened = opened
        self.include = [Path(folder) for folder in include]
        self.program, self.tokens = parse(reporter)
        self.own = len(self.program.constructors)  # so many of them belong to the main file
        self._read_files: dict[str, Source] = {}  # by their real path
        self._bytes = len(reporter.sources.first.text)
        self._imported = 0  # declarations of other files, which come first
        self._trail: list[str] = []
        first = reporter.sources.first
        self._follow(first, self.program.imports)

    def _follow(self, source: Source, imports: Iterable[ImportNode]) -> None:
        """Read the imports of `source`, each file before the text after its import."""
        here = os.path.realpath(source.file)
        self._read_files.setdefault(here, source)
        self._trail.append(here)
        for node in imports:
            path = self._find(source, node)
            if path is None:
                self.program.damaged = True  # names may be missing
                continue
            real = os.path.realpath(path)
            if real in self._trail:
                self._report_cycle(node, real)
            elif real not in self._read_files:
                self._add(path, node)
        self._trail.pop()

    def _report_cycle(self, node: ImportNode, real: str) -> None:
        ring = [os.path.basename(one) for one in [*self._trail[self._trail.index(real) :], real]]
        shown = " → ".join(ring if len(ring) <= 8 else [*ring[:4], "…", *ring[-3:]])
        message = f"`{node.file.value}` imports itself: {shown}"
        hint = "put what both need into a file of its own"
        self.reporter.report("UL043", node.file.start, node.file.end, message, hint)

    def _find(self, source: Source, node: ImportNode) -> Path | None:
        name = node.file.value
        place = node.file.start, node.file.end
        if not is_below(name):
            message = "this is not the name of a file below the search path"
            hint = 'write it relative to this file, such as "parts/joint.ul", without `..`'
            self.reporter.report("UL044", *place, message, hint)
            return None
        folders = [Path(source.file).parent, *self.include]
        for folder in folders:
            path = folder / name
            try:
                if path.is_file():
                    return self._inside(path, folders, node)
            except (OSError, ValueError):  # the name is too long for the operating system
                continue
        looked = ", ".join(f"`{folder}`" for folder in folders[:5])
        hint = f"it was looked for in {looked}; give further folders by --include or UNITYLINK_PATH"
        self.reporter.report("UL042", *place, f"there is no file `{name}`", hint)
        return None

    def _inside(self, path: Path, folders: Sequence[Path], node: ImportNode) -> Path | None:
        """Return `path` unless a symbolic link has led out of the folders in which it is looked for."""
        real = Path(os.path.realpath(path))
        if any(real.is_relative_to(os.path.realpath(folder)) for folder in folders):
            return path
        message = f"`{node.file.value}` is a symbolic link that leads to `{real}`"
        hint = f"give that folder by --include or UNITYLINK_PATH: `{real.parent}`"
        self.reporter.report("UL044", node.file.start, node.file.end, message, hint)
        return None

    def _add(self, path: Path, node: ImportNode) -> None:
        place = node.file.start, node.file.end
        if len(self.reporter.sources) >= MAX_FILES:
            self.reporter.report("UL003", *place, f"more than {MAX_FILES} files", "put some of them together")
            return
        text = self._text(path, place)
        if text is None:
            self.program.damaged = True
            return
        source = self.reporter.sources.add(str(path), text)
        program, _ = parse(self.reporter, source)
        self._follow(source, program.imports)
        self._merge(program)

    def _text(self, path: Path, place: tuple[int, int]) -> str | None:
        opened = self.opened.get(os.path.realpath(path))
        try:
            with path.open("rb") as file:
                data = file.read(MAX_BYTES + 1) if opened is None else opened.encode()
        except OSError as error:
            message = f"`{path}` cannot be read: {error.strerror or error}"
            self.reporter.report("UL042", *place, message, "check the file's rights")
            return None
        self._bytes += len(data)
        if self._bytes > MAX_BYTES:
            message = f"with this file the spec is larger than {MAX_BYTES:,} bytes"
            self.reporter.report("UL003", *place, message, "divide the spec into several")
            return None
        text, fault = decode(data)
        if fault is None:
            return text
        source = self.reporter.sources.add(str(path), text)
        at = source.base + fault
        message = f"byte 0x{data[len(text.encode())]:02X} is not UTF-8"
        self.reporter.report("UL002", at, at, message, "save the file with the encoding UTF-8")
        return None

    def _merge(self, program: Program) -> None:
        """Add the declarations of an imported file, without its header and its public constructors."""
        for constructor in program.constructors:
            constructor.public = False
        self.program.constructors += program.constructors
        at = self._imported  # imported declarations come before those that use them
        self.program.declarations[at:at] = program.declarations
        self._imported += len(program.declarations)
        self.program.lost |= program.lost
        self.program.damaged |= program.damaged

    def add_components(self) -> None:
        """Read the library's files for constructors that are expanded, but that no file declares."""
        have = {one.name.text for one in self.program.constructors}
        wanted = {
            member.callee.text
            for one in self.program.constructors
            for member in one.members
            if isinstance(member, ExpansionNode)
        }
        folder, library, devices = resource_folder("components"), component_names(), device_files()
        paths = {_described(folder / name): None for name in sorted(wanted - have) if name in library}
        for name in sorted((wanted - have) & {*devices}):
            component = _described(devices[name].parent.parent)  # it has types that its devices use
            if component.stem not in have:
                paths[component] = None
            paths[devices[name]] = None
        for path in paths:
            source = self.reporter.sources.add(str(path), path.read_text("utf-8"), library=True)
            self._merge(parse(self.reporter, source)[0])
