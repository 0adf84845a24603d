# SPDX-License-Identifier: BSD-3-Clause
"""The budget of a TosNet ring, as `budget` and `info` print it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .output import print_fields, print_table, shown_time

if TYPE_CHECKING:
    from unitylink.spec.isochrony.ring import RingBudget, Span


def ring_fields(ring: RingBudget) -> list[tuple[str, str]]:
    """Return names and values of what a ring costs."""
    own, *others = (node.id for node in ring.nodes)
    names = ", ".join(map(str, others)) or "none"
    registers = sum(len(node.registers) for node in ring.nodes)
    size = len(ring.nodes)
    slower = f", {shown_time(ring.shortest_s)} at best" if ring.cycle_s > ring.shortest_s else ""
    return [
        ("ring", f"the PC's own node {own}, others {names}; {registers} registers of 32 bytes"),
        (
            "cycle",
            f"{shown_time(ring.cycle_s)}, {1 / ring.cycle_s:,.0f} Hz{slower}: {ring.cycle_bytes} bytes at "
            f"{ring.baud_hz:,} baud, {size} hops of {ring.hop_s * 1e6:g} us",
        ),
        ("sensor to the PC's node", _span(ring.inward)),
        ("commit to the outputs", _span(ring.outward)),
        *_beyond(ring),
    ]


def _beyond(ring: RingBudget) -> list[tuple[str, str]]:
    """Return what the ring has that the published one has not."""
    parts = [
        "two rings" if ring.rings > 1 else "",
        f"a check of {8 * ring.check_bytes} bits" if ring.check_bytes > 1 else "",
        "" if ring.time is None else f"a clock of all nodes in word 0x{ring.time:X}",
    ]
    text = ", ".join(filter(None, parts))
    return [("beyond the published ring", text)] if text else []


def print_ring(ring: RingBudget) -> None:
    """Print the budget of a ring, with the age of what it publishes."""
    print_fields(ring_fields(ring), title=f"TosNet at 0x{ring.base:04X}")
    click.echo()
    shares = [
        (
            str(node.id),
            ", ".join(map(str, node.registers)) or "none",
            str(node.cycle_bytes),
            str(len(node.gives)),
            str(len(node.obeys)),
        )
        for node in ring.nodes
    ]
    print_table(("node", "registers", "bytes", "values given", "values obeyed"), shares, right=[0, 2, 3, 4])
    if ring.publishes:
        click.echo()
        rows = [(one.name, str(len(one.paths)), *_cells(one.sensor)) for one in ring.publishes]
        titles = ("when", "values", "sensor to the last byte: usual", "at most")
        print_table(titles, rows, right=[1, 2, 3])


def _span(span: Span) -> str:
    usual, most = _cells(span)
    return f"{usual} as a rule, {most} at most"


def _cells(span: Span) -> tuple[str, str]:
    usual, most = (
        "unknown" if time_s is None else shown_time(time_s) for time_s in (span.typical_s, span.bound_s)
    )
    return usual, most
