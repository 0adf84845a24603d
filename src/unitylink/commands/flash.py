# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink flash`: hand a bitstream to the program that writes it."""

from __future__ import annotations

import shlex
from pathlib import Path

import click


@click.command()
@click.argument("folder", metavar="FOLDER", type=click.Path(path_type=Path))
@click.option(
    "--volatile",
    is_flag=True,
    help="Load the chip only. It is quick, wears nothing out, and is lost without power.",
)
@click.option("--program", metavar="NAME", help="iceprog or openFPGALoader, if the board takes both.")
@click.option("--dry-run", is_flag=True, help="Print the command instead of running it.")
def command(folder: Path, *, volatile: bool, program: str | None, dry_run: bool) -> None:
    """Write the bitstream in FOLDER, which `unitylink build` made, to its board.

    \b
    Examples:
      unitylink flash build/servo-icebreaker
      unitylink flash build/servo-icebreaker --dry-run
    """
    from unitylink.boards.flash import flash_command, run_flash

    line = flash_command(folder, volatile=volatile, program=program)
    click.echo(shlex.join(line))
    if not dry_run:
        run_flash(line)
