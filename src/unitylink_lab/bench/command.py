# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink bench`: measure the figures on this machine."""

from __future__ import annotations

import click

from unitylink.commands.output import json_option, print_json


@click.command()
@click.option(
    "--only", metavar="FIGURE", multiple=True, help="Measure this figure. May be given several times."
)
@click.option("--quick", is_flag=True, help="Take seconds instead of minutes, for rough numbers.")
@click.option("--strict", is_flag=True, help="Exit with 1 if a figure is missed.")
@click.option("--list", "listing", is_flag=True, help="List the figures and end.")
@json_option("the report")
def command(only: tuple[str, ...], quick: bool, strict: bool, listing: bool, as_json: bool) -> int:
    """Measure this machine against the required figures. Progress is printed on stderr.

    The two sides of each ratio take turns within one run. Some figures need the native programs that
    `make bench` builds. A missed figure is an error only with --strict. A figure that cannot be measured is
    always an error.

    \b
    Examples:
      unitylink bench
      unitylink bench --quick --only sync-read --only version
      unitylink bench --json > bench.json
    """
    from . import FIGURES, run

    if listing:
        click.echo("\n".join(FIGURES))
        return 0
    unknown = [name for name in only if name not in FIGURES]
    if unknown:
        raise click.UsageError(f"there is no figure '{unknown[0]}'; there are: {', '.join(FIGURES)}")
    report = run(only=only, quick=quick)
    if as_json:
        print_json(report.to_json())
    else:
        click.echo(report.text())
    return int(bool(report.failures) or (strict and not report.met))
