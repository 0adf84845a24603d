# SPDX-License-Identifier: BSD-3-Clause
"""What charts show, as CSV."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .mcap_export import Series

HEAD = "item,unit,time_s,least,greatest\r\n"


def csv_lines(series: Iterable[Series]) -> Iterator[str]:
    """Yield the samples of items as lines, as finely as they are kept.

    `least` and `greatest` are the same for a sample of its own. Older samples are kept 8, 64 or 512 together.
    """
    yield HEAD
    for value, samples in series:
        name = f"{_quoted(value.path)},{_quoted(value.unit)}"
        for time_s, least, greatest in samples.T.tolist():
            yield f"{name},{time_s!r},{least!r},{greatest!r}\r\n"


def _quoted(text: str) -> str:
    """Return a text as a field of CSV. One that a spreadsheet takes for a formula gets a blank before it."""
    if text[:1] in ("=", "+", "-", "@"):
        text = f" {text}"
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in '",\r\n') else text
