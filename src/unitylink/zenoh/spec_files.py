# SPDX-License-Identifier: BSD-3-Clause
"""A spec with all files that it imports, as one text that travels, and back."""

from __future__ import annotations

import json
import posixpath
from pathlib import Path
from typing import TYPE_CHECKING

from unitylink.errors import ProtocolError
from unitylink.spec import load
from unitylink.spec.compile import search_path
from unitylink.spec.report.diagnostics import Reporter
from unitylink.spec.source import MAX_BYTES, Source, decode
from unitylink.spec.text.imports import MAX_FILES, is_below
from unitylink.spec.text.parser import parse

if TYPE_CHECKING:
    from unitylink.spec.model import Spec

_BYTES_MAX = 2 * MAX_BYTES


def pack_spec(file: str | Path, root: str) -> str:
    """Return the text of a spec file with its imports, and which public constructor is meant."""
    first = Path(file)
    texts: dict[str, str] = {}
    waiting = [(first, first.name)]
    while waiting:
        path, name = waiting.pop()
        if name in texts or not path.is_file():  # whoever compiles it will say what is missing
            continue
        text, _ = decode(path.read_bytes())
        texts[name] = text
        program, _ = parse(Reporter(Source(str(path), text)))
        for node in program.imports:
            folders = [path.parent, *map(Path, search_path())]
            found = next(
                (folder / node.file.value for folder in folders if (folder / node.file.value).is_file()), None
            )
            if found is not None:
                waiting.append((found, posixpath.join(posixpath.dirname(name), node.file.value)))
    return json.dumps({"file": first.name, "root": root, "files": texts})


def unpack_spec(text: str, folder: str | Path) -> tuple[Spec, Path]:
    """Write the files of such a text into an empty folder. Return the spec, and its main file.

    Raises ProtocolError if it is none, and SpecError if the spec has errors.
    """
    try:
        told = json.loads(text)
        first, root, files = str(told["file"]), str(told["root"]), dict(told["files"])
    except (ValueError, TypeError, KeyError, RecursionError):
        raise ProtocolError("the bridge tells a spec that cannot be understood") from None
    if len(files) > MAX_FILES or len(text) > _BYTES_MAX:
        raise ProtocolError(f"the bridge tells a spec of {len(files)} files and {len(text)} characters")
    if first not in files or not all(isinstance(name, str) and is_below(name) for name in files):
        raise ProtocolError("the bridge tells a spec with names of files that are none")
    try:
        for name, content in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(str(content), encoding="utf-8")
    except (OSError, ValueError) as error:  # too long a name, or also a folder; no letters
        raise ProtocolError(f"a file of the spec that the bridge tells cannot be written: {error}") from None
    main = Path(folder, first)
    spec = load(main)
    try:
        return (spec.only(root) if len(spec.roots) > 1 else spec), main
    except KeyError as error:
        raise ProtocolError(f"the bridge tells a spec without its robot: {error.args[0]}") from None
