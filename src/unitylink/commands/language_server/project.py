# SPDX-License-Identifier: BSD-3-Clause
"""The specs of a workspace. They give the meaning of a name in other files than the edited one."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from unitylink.spec.compile import search_path
from unitylink.spec.meaning.symbols import Symbols, find_symbols
from unitylink.spec.source import MAX_BYTES
from unitylink.spec.text.syntax import Name

FILES_MOST = 1000  # the most specs of a workspace that are read

Place = tuple[str, int, int]  # (real path of a file, start of a name in it, end of the name)


class Project:
    """The specs below some folders.

    `opened` has the editor's texts, by real path. They take precedence over the files.
    """

    def __init__(self, folders: Iterable[Path], opened: Mapping[str, str]) -> None:
        self.opened = opened
        self.texts: dict[str, str] = dict(opened)
        for path in self._files(folders):
            if len(self.texts) >= FILES_MOST:
                break
            file = os.path.realpath(path)
            if file not in self.texts and (text := _text(path)) is not None:
                self.texts[file] = text

    @staticmethod
    def _files(folders: Iterable[Path]) -> Iterator[Path]:
        for folder in folders:
            for where, below, names in os.walk(folder):
                below[:] = sorted(name for name in below if name[0] != ".")
                yield from (Path(where) / name for name in sorted(names) if name.endswith(".ul"))

    def symbols(self, file: str) -> Symbols:
        """Return the symbols of a file of the project."""
        return find_symbols(self.texts[file], file, search_path(), self.opened)

    def places(self, name: str, definition: Place) -> set[Place]:
        """Return every place in the project where `name` means the thing defined at `definition`."""
        found: set[Place] = set()
        for file, text in self.texts.items():
            if name in text:
                symbols = self.symbols(file)
                for symbol in symbols.all:
                    places = [place_of(symbols, one) for one in symbol.places] if symbol.name == name else []
                    if definition in places:
                        found.update(places)
        return found


def place_of(symbols: Symbols, name: Name) -> Place:
    """Return where a name stands, in a form that is the same in every spec that imports its file."""
    source = symbols.sources.at(name.start)
    return os.path.realpath(source.file), name.start - source.base, name.end - source.base


def _text(path: Path) -> str | None:
    try:
        return path.read_text("utf-8") if path.stat().st_size <= MAX_BYTES else None
    except (OSError, UnicodeDecodeError):
        return None
