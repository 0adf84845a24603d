# SPDX-License-Identifier: BSD-3-Clause
"""Reading SystemRDL. The result is systemrdl-compiler's tree, or one error with all its messages."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from systemrdl.compiler import RDLCompiler
from systemrdl.messages import MessagePrinter, RDLCompileError
from systemrdl.node import AddrmapNode

from ..failure import Failure

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")


class _Collector(MessagePrinter):  # type: ignore[misc, unused-ignore]
    """Keeps the compiler's messages instead of printing them."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []

    def emit_message(self, lines: list[str]) -> None:
        self.lines += [_COLOUR.sub("", line) for line in lines]


def read_systemrdl(path: str, top: str | None = None, include: Sequence[str] = ()) -> AddrmapNode:
    """Return the elaborated address map `top` of a file, or the last one in it if `top` is None.

    Raises Failure with the compiler's own messages. Files that embed Perl (`<% … %>`) are refused, because
    reading a specification must run no program.
    """
    _refuse_perl(Path(path))
    collector = _Collector()
    compiler = RDLCompiler(message_printer=collector, perl_safe_opcodes=[])
    try:
        compiler.compile_file(path, incl_search_paths=list(include))
        return compiler.elaborate(top_def_name=top).top
    except RDLCompileError as error:
        said = "\n".join(collector.lines).strip() or str(error)
        raise Failure(f"{path} does not compile as SystemRDL:\n{said}") from None
    except Exception as error:  # its parser, half of which is C++, raises these for a damaged text
        raise Failure(f"{path} cannot be read: {error}") from None


def _refuse_perl(path: Path) -> None:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise Failure(f"{path}: {error.strerror}") from None
    if b"<%" in data:
        raise Failure(
            f"{path} embeds Perl (`<%`), which an import does not run",
            "run SystemRDL's preprocessor yourself and import what it gives",
        )
    try:
        data.decode()
    except UnicodeDecodeError as error:
        raise Failure(f"{path}: byte {error.start} is not UTF-8") from None
