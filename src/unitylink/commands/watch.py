# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink watch`: values as they come."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click

from unitylink.program import ended_by_signals
from unitylink.values import plain

from .link_option import link_argument, open_target, spec_option
from .names import Item
from .output import terminal
from .sampling_options import count_option, duration_option, rate_option, sampled_items
from .value_text import shown

if TYPE_CHECKING:
    from .sampler import Sample, Sampler

_HOLD_S = 0.2  # s; lines are held back for so long, so that they come in the order of their times


@click.command()
@link_argument
@click.argument("names", metavar="[NAME...]", nargs=-1)
@spec_option
@rate_option
@count_option
@duration_option
@click.option("--changes", is_flag=True, help="Print only samples in which a value has changed.")
@click.option("--json", "as_json", is_flag=True, help="Print each sample as one line of JSON.")
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
    """Watch items.

    A terminal shows a live table, anything else gets one line for each sample. Ctrl-C ends it.

    The gateware sends items with PUBLISH in the spec at their own rate. The others are read at --rate. NAME
    is as for `read`. Without a NAME all READ items of the spec are watched. Times are seconds since the
    start.

    \b
    Examples:
      unitylink watch sim:arm.ul
      unitylink watch serial:/dev/ttyUSB0 --spec arm.ul '*.position' --duration 10 > log.txt
      unitylink watch tcp://127.0.0.1:5555 0x88 --rate 50 --count 100 --json
    """
    live = terminal() and not as_json  # a table shows by itself what goes wrong
    with ended_by_signals(), open_target(link, spec_file, quiet=live) as target:
        items = sampled_items(target, names, "watch")
        from .sampler import Sampler

        sampler = Sampler(target.link, items, rate_hz, hold_s=0.0 if live else _HOLD_S)
        lines = _Lines(sampler, items, as_json, changes)
        with sampler, suppress(KeyboardInterrupt):  # the usual way to end it
            samples = sampler.samples(count, duration_s)
            if live:
                from .live_table import show

                show(samples, items, sampler.publisher, link, target.link.now_s)
            else:
                lines.print(samples)
        lines.print(() if live else sampler.rest())
        if sampler.lost:
            click.echo(
                f"{sampler.lost:,} samples were lost: overwritten before they were taken, or read too late",
                err=True,
            )


class _Lines:
    """Prints samples, one in each line."""

    def __init__(self, sampler: Sampler, items: Sequence[Item], as_json: bool, changes: bool) -> None:
        self.sampler = sampler
        self.quantities = {item.name: item.quantity for item in items}
        self.as_json = as_json
        self.changes = changes
        self.before: dict[str, Any] = {}

    def print(self, samples: Iterable[Sample | None]) -> None:
        for sample in samples:
            if sample is None:
                continue
            time_s, values, numbers = sample
            since_s = self.sampler.since_start_s(time_s)
            named = {value.path: number for value, number in zip(values, numbers, strict=True)}
            differs = any(path not in self.before or self.before[path] != named[path] for path in named)
            self.before |= named
            if self.changes and not differs:
                continue
            if self.as_json:
                plain_values = {path: plain(number, self.quantities[path]) for path, number in named.items()}
                line = {"time_s": round(since_s, 6), "values": plain_values}
                click.echo(json.dumps(line, ensure_ascii=False))
            else:
                parts = (f"{path}={shown(number, self.quantities[path])}" for path, number in named.items())
                click.echo(f"{since_s:12.6f}  " + "  ".join(parts))
