# SPDX-License-Identifier: BSD-3-Clause
"""Mistakes in the small engine's program, which its tests must notice."""

from __future__ import annotations

from typing import Any

from unitylink.gateware import gateware_folder

SOURCE = gateware_folder() / "small" / "program.asm"


def squeeze(text: str) -> str:
    """Return the instructions of a source without comments and blanks, so that a test can name some."""
    lines = (" ".join(line.partition(";")[0].split()) for line in text.splitlines())
    return "; ".join(line for line in lines if line)


def with_mistake(assembler: Any, before: str, behind: str, name: str = "plain") -> Any:
    """Return the program `name` in which the instructions `before` are `behind` instead."""
    text = squeeze(SOURCE.read_text(encoding="utf-8"))
    assert text.count(before) == 1, "the program has changed: choose the place anew"
    return assembler.assemble(text.replace(before, behind).replace("; ", "\n"), name)
