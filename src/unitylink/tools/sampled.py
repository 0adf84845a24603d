# SPDX-License-Identifier: BSD-3-Clause
"""What `watch`, `record` and `plot` have in common: which items, how often, how long."""

from __future__ import annotations

from collections.abc import Sequence

import click

from .failure import Failure
from .link_option import Target
from .names import Item

rate_option = click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(0, min_open=True),
    default=10.0,
    show_default=True,
    metavar="HZ",
    help="How often to read what the spec does not publish.",
)
count_option = click.option("--count", type=click.IntRange(1), metavar="N", help="End after N samples.")
duration_option = click.option(
    "--duration",
    "duration_s",
    type=click.FloatRange(0, min_open=True),
    metavar="S",
    help="End after S seconds.",
)


def sampled_items(target: Target, names: Sequence[str], verb: str) -> list[Item]:
    """Return what `names` stand for; without any, what the spec lets the PC read and reading does not change.

    Raises Failure, with `verb` in it, where that is nothing.
    """
    known = target.names
    items = (
        known.find_readable(names)
        if names
        else [item for item in known.all() if item.element is not None and item.element.pollable]
    )
    if not items:
        raise Failure(
            f"there is nothing to {verb} on {target.link.url}",
            "name items of a spec (--spec FILE.ul), or an address",
        )
    return items
