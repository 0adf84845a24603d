# SPDX-License-Identifier: BSD-3-Clause
"""The moments that must come, or else a property says nothing.

They are read off its text and added to it as covers.

A search of some clocks says nothing about later ones. So each part of a property's claim gets a cover. It is
the moment at which this part could be violated:

- `a -> b`, `a -> next (b)`, `a -> next[k] (b)`: a has happened, and the clock has come in which b counts.
- `a or b or c` claims c when neither a nor b holds. `a and b` makes two claims.
- `x <= n`, likewise `<`, `>` and `>=`: x has reached the bound. One step more would violate it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from unitylink.errors import ToolError

_PROPERTY = re.compile(r"^( *)(\w+)( *: *)assert\b(.*?);", re.MULTILINE | re.DOTALL)
_ALWAYS = re.compile(r"\s*(\()?\s*always\b(.*)", re.DOTALL)
_NEXT = re.compile(r"\s*next\s*(?:\[\s*(\d+)\s*\])?\s*(\(.*\))\s*", re.DOTALL)
_BOUND = re.compile(r"(.*?[^<>/=])(<=|>=|<|>)([^<>=].*)", re.DOTALL)


_Steps = list[list[str]]  # conditions, clock by clock


def with_cases(vhdl: str) -> str:
    """Return a property file, or a view. After each property it has a cover for each of its moments."""
    return _PROPERTY.sub(lambda found: found.group() + _covers(found), vhdl)


def cases(claim: str) -> list[str]:
    """Return the PSL sequences that must be reached for the property `always <claim>`, each once."""
    return list(dict.fromkeys(filter(None, map(_sequence, _moments(claim, [[]])))))


def _covers(found: re.Match[str]) -> str:
    label = found.group(2)
    said = _ALWAYS.fullmatch(found.group(4))
    if said is None:
        raise ToolError(f"{label}: a property is `assert always ...`")
    claim, clock = said.group(2), ""
    if said.group(1):  # (always ...) @rising_edge(...)
        claim, _, clock = claim.rpartition(")@" if ")@" in claim else ") @")
        clock = f" @{clock}"
    return "".join(
        f"\n  {label}_case{number if number > 1 else ''} : cover {{{moment}}}{clock};"
        for number, moment in enumerate(cases(claim), 1)
    )


def _moments(claim: str, steps: _Steps) -> Iterator[_Steps]:
    """Yield what must have happened, clock by clock, until each part of `claim` counts after `steps`."""
    claim = _bare(claim)
    left, arrow, right = _halves(claim)
    if arrow:
        yield from _moments(right, _also(steps, left))
    elif found := _NEXT.fullmatch(claim):
        yield from _moments(found.group(2), [*steps, *([] for _ in range(int(found.group(1) or 1)))])
    elif len(parts := _split(claim, "or")) > 1:
        yield from _moments(parts[-1], _also(steps, *(f"not ({part})" for part in parts[:-1])))
    elif len(parts := _split(claim, "and")) > 1:
        for part in parts:
            yield from _moments(part, steps)
    else:
        yield _also(steps, *_at_bound(claim))


def _also(steps: _Steps, *conditions: str) -> _Steps:
    """Return `steps` with more conditions in the last clock."""
    return [*steps[:-1], [*steps[-1], *map(str.strip, conditions)]]


def _sequence(steps: _Steps) -> str:
    """Return the sequence in PSL. It is empty if any single clock will do."""
    if steps == [[]]:
        return ""
    # Compared with true it is one term for GHDL, whose PSL takes only a limited number of terms.
    conditions = (" and ".join(f"({each})" for each in step) for step in steps)
    return "; ".join(f"true = ({each})" if each else "true" for each in conditions)


def _at_bound(claim: str) -> list[str]:
    """Return the condition that a bound is reached, if `claim` is a bound."""
    found = _BOUND.fullmatch(claim)
    if found is None or not all(map(_is_balanced, found.groups())):
        return []
    left, relation, right = (part.strip() for part in found.groups())
    beyond = {"<=": "", ">=": "", "<": " - 1", ">": " + 1"}[relation]
    return [f"{left} = {right}{beyond}"]


def _halves(claim: str) -> tuple[str, str, str]:
    """Return the left and the right side of `->`."""
    depth = 0
    for place, letter in enumerate(claim):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and claim.startswith("->", place):
            return claim[:place], "->", claim[place + 2 :]
    return claim, "", ""


def _split(text: str, word: str) -> list[str]:
    """Return the operands of `word` outside of all brackets.

    With nothing on its left, the word is a reduction.
    """
    parts, depth, begin = [], 0, 0
    for found in re.finditer(rf"[()]|\b{word}\b", text):
        if found.group() in "()":
            depth += 1 if found.group() == "(" else -1
        elif depth == 0 and not re.search(r"(^|=|\b(or|and|not))\s*$", text[begin : found.start()]):
            parts.append(text[begin : found.start()].strip())
            begin = found.end()
    return [*parts, text[begin:].strip()]


def _bare(text: str) -> str:
    """Return an expression without the brackets, or the call of `holds`, around the whole of it."""
    text = text.strip()
    while found := re.fullmatch(r"(?:holds\s*)?\((.*)\)", text, re.DOTALL):
        if not _is_balanced(found.group(1)):
            break
        text = found.group(1).strip()
    return text


def _is_balanced(text: str) -> bool:
    depth = 0
    for letter in text:
        depth += (letter == "(") - (letter == ")")
        if depth < 0:
            return False
    return depth == 0
