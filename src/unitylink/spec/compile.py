# SPDX-License-Identifier: BSD-3-Clause
"""From a text or a file to a checked `Spec`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from types import MappingProxyType

from ..errors import SpecError
from .check.addresses import check_model
from .check.unused import check_notes, check_unused
from .collector import collector_paused
from .expand.publishing import devices
from .expand.resolve import Resolver
from .fingerprint import fingerprint
from .meaning.declared import Declared
from .meaning.scope import Scopes
from .model import Link, Spec
from .report.diagnostics import Diagnostic, Reporter, render
from .source import MAX_BYTES, Source, decode
from .text.imports import Importer


@dataclass(frozen=True)
class Result:
    """The result of a compilation. `spec` is None if any diagnostic is an error."""

    spec: Spec | None
    diagnostics: tuple[Diagnostic, ...]

    @property
    def errors(self) -> int:
        """The number of errors."""
        return sum(1 for diagnostic in self.diagnostics if diagnostic.severity == "error")

    @property
    def warnings(self) -> int:
        """The number of warnings."""
        return len(self.diagnostics) - self.errors


@collector_paused()
def compile_text(
    text: str | bytes,
    file: str = "<text>",
    include: Sequence[str | os.PathLike[str]] = (),
    opened: Mapping[str, str] = MappingProxyType({}),
) -> Result:
    """Compile a spec. No text makes it raise an exception.

    Imports are searched in the folder of `file`, then in `include`, then in the folders of the environment
    variable UNITYLINK_PATH. `opened` has the texts of files that an editor has changed, by real path.

    >>> compile_text("public led() { @on = 0x10: WRITE(); }").spec.root().elements[0].address
    16
    """
    if len(text) > MAX_BYTES:
        message = f"the text is larger than {MAX_BYTES:,} bytes"
        return _one(Source(file, ""), "UL003", message, "divide the spec into several")
    if isinstance(text, bytes):
        decoded, fault = decode(text)
        if fault is not None:
            value = text[len(decoded.encode())]
            message = f"byte 0x{value:02X} is not UTF-8"
            return _one(
                Source(file, decoded), "UL002", message, "save the file with the encoding UTF-8", fault
            )
        text = decoded
    source = Source(file, text)
    reporter = Reporter(source)
    importer = Importer(reporter, [*include, *search_path()], opened)
    program = importer.program
    importer.add_components()
    declared = Declared(program, reporter)
    name = program.name or source.stem
    scopes = Scopes(program, declared, reporter)
    default = next(iter(declared.links.values()), Link(name))
    links = {**declared.links, "": default}
    resolver = Resolver(program, declared, links, scopes)
    check_model(resolver, links, reporter)
    if reporter.failed:
        return Result(None, reporter.diagnostics())
    roots = tuple(resolver.roots)
    check_unused(scopes, roots, importer.own, reporter)
    check_notes(importer.tokens, reporter)
    spec = Spec(
        name,
        program.package,
        PurePath(file).name,
        fingerprint(roots, tuple(declared.links.values())),
        roots,
        tuple(declared.enums.values()),
        tuple(declared.bits.values()),
        tuple(declared.links.values()) or (default,),
        devices(roots, links),
    )
    return Result(spec, reporter.diagnostics())


def search_path() -> list[str]:
    """Return the folders of UNITYLINK_PATH."""
    return [folder for folder in os.environ.get("UNITYLINK_PATH", "").split(os.pathsep) if folder]


def compile_file(path: str | os.PathLike[str], include: Sequence[str | os.PathLike[str]] = ()) -> Result:
    """Compile a file. A file that cannot be read or is not UTF-8 gives a diagnostic."""
    try:
        with Path(path).open("rb") as file:
            data = file.read(
                MAX_BYTES + 1
            )  # a limit, so that a device or an endless pipe does not fill the memory
    except (OSError, ValueError) as error:  # a null character in the path raises ValueError
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return _one(
            Source(os.fspath(path), ""),
            "UL001",
            f"the file cannot be read: {reason}",
            _remedy(os.fspath(path)),
        )
    return compile_text(data, os.fspath(path), include)


def load(path: str | os.PathLike[str], include: Sequence[str | os.PathLike[str]] = ()) -> Spec:
    """Return the spec of a file. Raises `SpecError` with the rendered report if it has errors."""
    result = compile_file(path, include)
    if result.spec is None:
        raise SpecError(render(result.diagnostics), result.diagnostics)
    return result.spec


def _one(source: Source, code: str, message: str, hint: str, at: int = 0) -> Result:
    reporter = Reporter(source)
    reporter.report(code, at, at, message, hint)
    return Result(None, reporter.diagnostics())


def _remedy(path: str) -> str:
    for scheme in ("sim:", "rtl:"):
        if path.startswith(scheme):
            return f"a spec is a file: write {path.removeprefix(scheme).partition('?')[0]}"
    return "check the path"
