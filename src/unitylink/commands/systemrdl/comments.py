# SPDX-License-Identifier: BSD-3-Clause
"""Comments in the form of UL-spec."""

from __future__ import annotations

from typing import Any


def documentation(node: Any, indent: str, text: str | None = None) -> str:
    """Return the `///` lines of a node's description, or of `text`."""
    if text is None and hasattr(node, "get_property"):
        text = node.get_property("desc", default="")
    lines = [" ".join(line.split()) for line in (text or "").strip().splitlines()]
    shown = ("".join(c if c.isprintable() else " " for c in line) for line in lines)
    return "".join(f"{indent}/// {line}".rstrip() + "\n" for line in shown)
