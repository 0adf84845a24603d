# SPDX-License-Identifier: BSD-3-Clause
"""Output of results: tables for people, JSON for programs, colours on terminals only."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Callable, Sequence
from typing import Any, TextIO, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])


def json_option(what: str = "the result") -> Callable[[F], F]:
    """Give a command the option `--json`, which prints `what` as JSON."""
    return click.option("--json", "as_json", is_flag=True, help=f"Print {what} as JSON.")


force_option = click.option("--force", is_flag=True, help="Replace the file that is there.")


def colours(stream: TextIO) -> bool:
    """Tell whether `stream` is a terminal on which colours are wanted (see no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def terminal() -> bool:
    """Tell whether stdout is a terminal that can redraw."""
    return sys.stdout.isatty() and os.environ.get("TERM") != "dumb"


def print_json(data: object, *, indent: int | None = 2) -> None:
    """Print `data` as JSON. NaN and infinities are an error of ours, because JSON does not have them."""
    click.echo(json.dumps(data, indent=indent, ensure_ascii=False, allow_nan=False))


def print_table(headers: Sequence[str], rows: Sequence[Sequence[str]], *, right: Sequence[int] = ()) -> None:
    """Print rows under headers.

    A terminal that is wide enough gets rules and colours, anything else plain columns.

    `right` names the columns that are aligned at the right. Plain columns are two or more spaces apart and
    never cut.

    >>> print_table(("name", "value"), [("j1.cpos", "-12"), ("j2.cpos", "4")], right=[1])
    name     value
    j1.cpos    -12
    j2.cpos      4
    """
    plain = plain_table(headers, rows, right=right)
    ruled_width = max(map(len, plain)) + len(headers) + 1  # a ruled table would cut cells that do not fit
    if not terminal() or ruled_width > shutil.get_terminal_size().columns:
        for line in plain:
            click.echo(line)
        return
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, header in enumerate(headers):
        table.add_column(
            header, justify="right" if index in right else "left", style="bold" if index == 0 else ""
        )
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    Console(highlight=False).print(table)


def plain_table(
    headers: Sequence[str], rows: Sequence[Sequence[str]], *, right: Sequence[int] = ()
) -> list[str]:
    """Return aligned lines without rules."""
    lines = [headers, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(headers))]
    return [
        "  ".join(
            cell.rjust(width) if column in right else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]


def print_fields(fields: Sequence[tuple[str, str]], *, title: str = "") -> None:
    """Print `name: value` lines, aligned, under a title."""
    bold, dim, off = ("\x1b[1m", "\x1b[2m", "\x1b[0m") if colours(sys.stdout) else ("", "", "")
    if title:
        click.echo(f"{bold}{title}{off}")
    width = max((len(name) for name, _ in fields), default=0)
    for name, value in fields:
        click.echo(f"  {dim}{name.ljust(width)}{off}  {value}")


def shown_time(time_s: float) -> str:
    """Return a time in words.

    >>> shown_time(0.000309), shown_time(0.0125)
    ('309 us', '12.50 ms')
    """
    return f"{time_s * 1e3:.2f} ms" if time_s >= 1e-3 else f"{time_s * 1e6:.0f} us"
