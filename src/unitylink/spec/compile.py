# SPDX-License-Identifier: BSD-3-Clause
"""From a text or a file to a checked `Spec`."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path, PurePath

from ..errors import SpecError
from .checks import check_model, check_unused
from .diagnostics import Diagnostic, Reporter, render
from .fingerprint import fingerprint
from .model import Link, Spec
from .parser import parse
from .publishing import devices
from .resolve import Resolver
from .source import MAX_BYTES, Source, decode


@dataclass(frozen=True)
class Result:
    """What a compilation gave: `spec` is None if any diagnostic is an error."""

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


def compile_text(text: str | bytes, file: str = "<text>") -> Result:
    """Compile a spec; never raises for anything the text may hold.

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
    program, _ = parse(reporter)
    resolver = Resolver(program, reporter)
    check_model(resolver.placed, reporter)
    if reporter.failed:
        return Result(None, reporter.diagnostics())
    roots = tuple(resolver.roots)
    check_unused(resolver.scopes, roots, reporter)
    name = program.name or source.stem
    links = {"": Link(name)}
    spec = Spec(
        name,
        program.package,
        PurePath(file).name,
        fingerprint(roots),
        roots,
        links=tuple(links.values()),
        devices=devices(roots, links),
    )
    return Result(spec, reporter.diagnostics())


def compile_file(path: str | os.PathLike[str]) -> Result:
    """Compile a file; one that cannot be read or is not UTF-8 gives a diagnostic."""
    try:
        with Path(path).open("rb") as file:
            data = file.read(
                MAX_BYTES + 1
            )  # no more, so that a device or an endless pipe does not fill the memory
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        return _one(
            Source(os.fspath(path), ""), "UL001", f"the file cannot be read: {reason}", "check the path"
        )
    return compile_text(data, os.fspath(path))


def load(path: str | os.PathLike[str]) -> Spec:
    """Return the spec of a file; raise `SpecError` with the rendered report if it has errors."""
    result = compile_file(path)
    if result.spec is None:
        raise SpecError(render(result.diagnostics), result.diagnostics)
    return result.spec


def _one(source: Source, code: str, message: str, hint: str, at: int = 0) -> Result:
    reporter = Reporter(source)
    reporter.report(code, at, at, message, hint)
    return Result(None, reporter.diagnostics())
