# SPDX-License-Identifier: BSD-3-Clause
"""Names of an imported spec."""

from __future__ import annotations

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
