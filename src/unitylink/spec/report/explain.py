# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of each diagnostic: a text, a wrong spec and its mended form, from `explanations/CODE.md`.

>>> explain("UL013").title
'closing brace without an opening one'
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from .codes import CODES

_BLOCK = re.compile(r"^```ul\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_MARK = re.compile(r"^( *)(\^+)\n", re.MULTILINE)


@dataclass(frozen=True)
class Explanation:
    """The explanation of one code.

    `wrong` and `mended` are whole specs, or "" if an example would be too long. The diagnostic is in `wrong`
    at `line` and `column` (from 1). It is `width` characters wide.
    """

    code: str
    severity: str
    title: str
    text: str
    wrong: str = ""
    mended: str = ""
    line: int = 0
    column: int = 0
    width: int = 0

    @property
    def marked(self) -> str:
        """The wrong spec, with carets under the place of the diagnostic."""
        lines = self.wrong.splitlines(keepends=True)
        lines.insert(self.line, " " * (self.column - 1) + "^" * self.width + "\n")
        return "".join(lines)


@cache
def explain(code: str) -> Explanation:
    """Return the explanation of a code such as "UL013".

    Raises KeyError, with the code, if it does not exist.
    """
    kind = CODES[code]
    page = files(__package__).joinpath("explanations").joinpath(f"{code}.md").read_text("utf-8")
    text = page.split("\n```ul", maxsplit=1)[0].strip()
    blocks = _BLOCK.findall(page)
    if not blocks:
        return Explanation(code, kind.severity, kind.title, text)
    marked, mended = blocks
    mark = _MARK.search(marked)
    assert mark is not None, f"{code}.md: a line of carets marks the place"
    return Explanation(
        code,
        kind.severity,
        kind.title,
        text,
        wrong=marked[: mark.start()] + marked[mark.end() :],
        mended=mended,
        line=marked.count("\n", 0, mark.start()),
        column=len(mark[1]) + 1,
        width=len(mark[2]),
    )
