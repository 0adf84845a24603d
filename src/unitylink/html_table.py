# SPDX-License-Identifier: BSD-3-Clause
"""A table in HTML, as notebooks show it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

_LEFT = ' style="text-align:left"'


def html_table(title: str, headers: Sequence[str], rows: Iterable[Sequence[str]], note: str = "") -> str:
    """Return a table with a title above it. Every text is escaped. `note` stands below the title.

    >>> "&lt;b&gt;</td>" in html_table("arm", ["name"], [["<b>"]])
    True
    """
    caption = f"<b>{escape(title)}</b>" + (f"<br>{escape(note)}" if note else "")
    head = "".join(f"<th{_LEFT}>{escape(header)}</th>" for header in headers)
    body = "".join(f"<tr>{''.join(f'<td{_LEFT}>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    return (
        f"<table><caption{_LEFT}>{caption}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )
