# SPDX-License-Identifier: BSD-3-Clause
"""A part of a hand-written page that a tool makes.

It is between two marks, and the first one names the tool.
"""

from __future__ import annotations

END = "<!-- end -->\n"


def with_part(page: str, tool: str, part: str) -> str:
    """Return `page` with the part of the tool tools/docs/`tool` replaced by `part`."""
    begin = f"<!-- made by tools/docs/{tool} -->\n"
    head, found, rest = page.partition(begin)
    _, end, tail = rest.partition(END)
    if not (found and end):
        raise SystemExit(f"the page has lost its {begin.strip()} or {END.strip()}")
    return f"{head}{begin}{part}{end}{tail}"
