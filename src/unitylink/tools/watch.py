# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink watch`: values as they come."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click

from .ended_by_signals import ended_by_signals
from .link_option import link_argument, open_target, spec_option
from .names import Item
from .output import terminal
from .sampled import count_option, duration_option, rate_option, sampled_items
from .typed import plain, shown

if TYPE_CHECKING:
    from .sampler import Sample


@click.command()
@link_argument
@click.argument("names", metavar="[NAME...]", nargs=-1)
@spec_option
@rate_option
@count_option
@duration_option
@click.option(
    "--changes", is_flag=True, help="Print only samples in which a value differs from the one before."
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object a line for each sample.")
def command(
    link: str,
    *,
    names: tuple[str, ...],
    spec_file: str | None,
    rate_hz: float,
    count: int | None,
    duration_s: float | None,
    changes: bool,
    as_json: bool,
) -> None:
    """Watch items: a live table on a terminal, else one line for each sample. Ctrl-C ends it.

    Items with PUBLISH in the spec are sent by the gateware at their own rate; the others are read at --rate.
    NAME is as for `read`; without any, all READ items of the spec are watched. Times are seconds since the
    start.

    \b
    Examples:
      unitylink watch sim:arm.ul
      unitylink watch serial:/dev/ttyUSB0 --spec arm.ul '*.position' --duration 10 > log.txt
      unitylink watch tcp://127.0.0.1:5555 0x88 --rate 50 --count 100 --json
    """
    live = terminal() and not as_json  # a table, which shows what goes wrong itself
    with ended_by_signals(), open_target(link, spec_file, quiet=live) as target:
        items = sampled_items(target, names, "watch")
        from .sampler import Sampler

        with Sampler(target.link, items, rate_hz) as sampler, suppress(KeyboardInterrupt):  # the usual end
            samples = sampler.samples(count, duration_s)
            if live:
                from .live_table import show

                show(samples, items, sampler.publisher, link)
            else:
                _print_lines(samples, items, as_json, changes)
        if sampler.lost:
            click.echo(
                f"{sampler.lost:,} samples were lost: overwritten before they were taken, or read too late",
                err=True,
            )


def _print_lines(
    samples: Iterator[Sample | None], items: Sequence[Item], as_json: bool, changes: bool
) -> None:
    start = time.monotonic()
    quantities = {item.name: item.quantity for item in items}
    before: dict[str, Any] = {}
    for sample in samples:
        if sample is None:
            continue
        time_s, values, numbers = sample
        named = {value.path: number for value, number in zip(values, numbers, strict=True)}
        differs = any(before.get(path) != number for path, number in named.items())
        before |= named
        if changes and not differs:
            continue
        since_s = round(time_s - start, 6)
        if as_json:
            values_of = {path: plain(number, quantities[path]) for path, number in named.items()}
            click.echo(json.dumps({"time_s": since_s, "values": values_of}, ensure_ascii=False))
        else:
            parts = (f"{path}={shown(number, quantities[path])}" for path, number in named.items())
            click.echo(f"{since_s:12.6f}  " + "  ".join(parts))
