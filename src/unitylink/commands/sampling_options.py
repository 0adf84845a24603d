# SPDX-License-Identifier: BSD-3-Clause
"""The options that `watch`, `record` and `plot` share: which items, how often, how long."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from unitylink.errors import BusError

from .failure import Failure
from .link_option import Target
from .names import Item

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

rate_option = click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(0, min_open=True),
    default=10.0,
    show_default=True,
    metavar="HZ",
    help="How often to read items without PUBLISH.",
)
count_option = click.option("--count", type=click.IntRange(1), metavar="N", help="End after N samples.")
duration_option = click.option(
    "--duration",
    "duration_s",
    type=click.FloatRange(0, min_open=True),
    metavar="S",
    help="End after S seconds.",
)


def sampled_items(target: Target, names: Sequence[str], verb: str, *, set_points: bool = False) -> list[Item]:
    """Return the items that `names` mean.

    By default, these are all items that the PC can read without changing them.

    With `set_points` these are also the items that it writes, if the device allows reading them back. The
    others are reported. Raises Failure, with `verb` in it, if nothing is left.
    """
    known = target.names
    if names:
        items = known.find_readable(names)
    else:
        kept = {item.name for item in known.all() if item.element is not None and item.element.pollable}
        if set_points:
            kept |= _read_back(target.link, [item for item in known.all() if _is_set_point(item)])
        items = [item for item in known.all() if item.name in kept]
    if not items:
        raise Failure(
            f"there is nothing to {verb} on {target.link.url}",
            "name items of a spec (--spec FILE.ul), or an address",
        )
    return items


def _is_set_point(item: Item) -> bool:
    element = item.element
    return element is not None and element.access == "WRITE" and element.link.kind != "fifo"


def _read_back(link: Link, items: Sequence[Item]) -> set[str]:
    """Return the names of those items that the device allows to be read."""
    refused = [item.name for item in items if not _reads(link, item)]
    if refused:
        shown = ", ".join(refused[:3]) + (f" and {len(refused) - 3} more" if len(refused) > 3 else "")
        click.echo(f"note: {shown} left out: the device does not allow reading it back", err=True)
    return {item.name for item in items} - set(refused)


def _reads(link: Link, item: Item) -> bool:
    try:
        link.read(item.address)
    except BusError:
        return False
    return True
