# SPDX-License-Identifier: BSD-3-Clause
"""Names of a spec as names of VHDL, whatever they are."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

# Reserved by VHDL-2008 (PSL's among them) and VHDL-2019, and by Verilog, in which netlists are written; and
# the type of a strobe, for a field must not hide it.
KEYWORDS = frozenset(
    [*(Path(__file__).parent / "keywords.txt").read_text(encoding="ascii").split(), "std_ulogic"]
)


class Names:
    """The names of one scope: each text gets one that is legal, and that no other has in any case.

    Small letters. Other characters than letters and digits become `_`, but never two in a row or one at an
    end. `n` goes before a digit. A name that is taken, by a keyword or an earlier text, gets the next free
    number.

    >>> names = Names()
    >>> [names.claim(text) for text in ("Led", "led", "signal", "_2nd__try_", "j1.cpos")]
    ['led', 'led_2', 'signal_2', 'n2nd_try', 'j1_cpos']
    """

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self._taken = set(reserved) | KEYWORDS

    def claim(self, text: str) -> str:
        """Return a free name for `text` and take it."""
        plain = re.sub(r"[^a-z0-9]+", "_", text.lower(), flags=re.ASCII).strip("_")
        plain = plain if plain[:1].isalpha() else f"n{plain}"
        name, number = plain, 1
        while name in self._taken:
            number += 1
            name = f"{plain}_{number}"
        self._taken.add(name)
        return name


def identifier(text: str) -> str:
    """Return `text` as a name of VHDL, if no other thing has that name."""
    return Names().claim(text)
