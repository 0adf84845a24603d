# SPDX-License-Identifier: BSD-3-Clause
"""Names and comments in the form of UL-spec."""

from __future__ import annotations

from typing import Any

from unitylink.spec.text.lexer import KEYWORDS, MAX_NAME


class Names:
    """Names of one scope, each given once."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def unique(self, wanted: str) -> str:
        """Return `wanted` as it is written in a spec, shortened and numbered if necessary."""
        base = wanted[: MAX_NAME - 8]
        name, number = base, 1
        while name in self._taken:
            number += 1
            name = f"{base}_{number}"
        self._taken.add(name)
        return f"^{name}" if name in KEYWORDS else name


def documentation(node: Any, indent: str, text: str | None = None) -> str:
    """Return the `///` lines of a node's description, or of `text`."""
    if text is None and hasattr(node, "get_property"):
        text = node.get_property("desc", default="")
    lines = [" ".join(line.split()) for line in (text or "").strip().splitlines()]
    shown = ("".join(c if c.isprintable() else " " for c in line) for line in lines)
    return "".join(f"{indent}/// {line}".rstrip() + "\n" for line in shown)
