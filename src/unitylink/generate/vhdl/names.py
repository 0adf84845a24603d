# SPDX-License-Identifier: BSD-3-Clause
"""Names of a spec as names of VHDL."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

# Reserved by VHDL-2008 (with PSL) and VHDL-2019, and by Verilog, in which netlists are written. Also the
# types of fields that are neither `signed` nor `unsigned`, and the two libraries, because a field or a port
# must not hide them.
KEYWORDS = frozenset(
    [
        *(Path(__file__).parent / "keywords.txt").read_text(encoding="ascii").split(),
        "std_ulogic",
        "std_ulogic_vector",
        "unitylink",
        "work",
    ]
)


class Names:
    """The names of one scope. Each text gets a legal name that no other one has, in upper or lower case.

    Small letters. Characters other than letters and digits become `_`, but never two in a row, or one at an
    end. A name that begins with a digit gets an `n` before it. If a keyword or an earlier text already has
    the name, it gets the next free number.

    >>> names = Names()
    >>> [names.claim(text) for text in ("Led", "led", "signal", "_2nd__try_", "j1.cpos")]
    ['led', 'led_2', 'signal_2', 'n2nd_try', 'j1_cpos']
    """

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self._taken = set(reserved) | KEYWORDS

    def claim(self, text: str) -> str:
        """Return a free name for `text`, and reserve it."""
        plain = re.sub(r"[^a-z0-9]+", "_", text.lower(), flags=re.ASCII).strip("_")
        plain = plain if plain[:1].isalpha() else f"n{plain}"
        name, number = plain, 1
        while name in self._taken:
            number += 1
            name = f"{plain}_{number}"
        self._taken.add(name)
        return name


def identifier(text: str) -> str:
    """Return `text` as a name of VHDL, in a scope where nothing else has this name."""
    return Names().claim(text)
