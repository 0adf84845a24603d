# SPDX-License-Identifier: BSD-3-Clause
"""Values as a table for notebooks. A line that is silent holds up nobody for long."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.errors import BusError, LinkError
from unitylink.html_table import html_table
from unitylink.values import format_value

if TYPE_CHECKING:
    from unitylink.layer3_hardware import HardwareProxy
    from unitylink.spec.model import Publish
    from unitylink.values import Quantity

    from .publishing import Publisher

MOST = 500  # rows
ATTEMPT_S = 0.1  # for each attempt of a read
READS_S = 0.5  # after so long no further read is begun
HEADERS = ("name", "value", "unit", "access", "address", "range")


class HasRow(Protocol):
    """What a row needs of a value."""

    path: str
    hardware: HardwareProxy
    address: int
    quantity: Quantity
    publish: Publish | None
    publisher: Publisher
    latest: Any
    access: str
    pollable: bool
    writable: bool

    @property
    def unit(self) -> str: ...
    @property
    def minimum(self) -> Any: ...
    @property
    def maximum(self) -> Any: ...


def values_html(title: str, values: Iterable[HasRow]) -> str:
    """Return a table of values. Those that publishes bring are shown as they last came.

    The others are read now, if a read has no effect. If the board does not answer, the table says so, and
    shows what is known.
    """
    found = list(values)
    shown = found[:MOST]
    refused, trouble = _refresh(shown)
    rows = [(*_row(value, refused.get(value.path, "unreachable" if trouble else "")),) for value in shown]
    notes = [f"unreachable: {trouble}"] if trouble else []
    if len(found) > MOST:
        notes.append(f"the first {MOST} of {len(found)} values")
    return html_table(title, HEADERS, rows, ". ".join(notes))


def _refresh(values: Sequence[HasRow]) -> tuple[dict[str, str], str]:
    """Read what can be read without effect. Return the errors by path, and why the board is unreachable."""
    refused: dict[str, str] = {}
    end_s = time.monotonic() + READS_S
    for value in values:
        link = value.hardware.link
        if not link.up:
            return refused, link.trouble or "the link is closed"
        read = getattr(value, "read", None)
        published = value.publish is not None and value.publisher.active and value.latest is not None
        if read is None or not (value.pollable and value.hardware.repeatable_reads) or published:
            continue
        if time.monotonic() > end_s:
            return refused, f"the board answers too slowly; after {READS_S:g} s the rest was not read"
        try:
            read(timeout_s=ATTEMPT_S)
        except BusError:
            refused[value.path] = "bus error"
        except LinkError as error:
            return refused, str(error)
    return refused, ""


def _row(value: HasRow, trouble: str) -> Sequence[str]:
    quantity = value.quantity
    text = "-" if value.latest is None else format_value(value.latest)
    if trouble == "bus error" or (trouble and value.latest is None and value.pollable):
        text = trouble
    least, greatest = quantity.minimum, quantity.maximum
    if value.writable and quantity.type.kind not in ("enum", "bits", "bool"):
        least, greatest = value.minimum, value.maximum
    known = "" if least is None and greatest is None else f"{_end(least)} to {_end(greatest)}"
    return value.path, text, value.unit, value.access, f"{value.address:#06x}", known


def _end(limit: Any) -> str:
    return "…" if limit is None else format_value(limit)
