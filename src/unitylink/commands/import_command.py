# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink import`: specs from other languages."""

from __future__ import annotations

from pathlib import Path

import click

from unitylink.optional import absent

from .failure import Failure
from .imported import Imported


@click.command(name="import")
@click.argument("file", metavar="FILE")
@click.option(
    "--out", metavar="FILE.ul", help="Write here. Without it the spec is printed. Never overwrites a file."
)
@click.option(
    "--top", metavar="NAME", help="SystemRDL: the address map. By default the last one of the file."
)
@click.option("--include", metavar="FOLDER", multiple=True, help="SystemRDL: folder for `include files.")
@click.option("--board", metavar="NAME", help="riocore: the board, if it is not that of the file.")
def command(file: str, out: str | None, top: str | None, include: tuple[str, ...], board: str | None) -> None:
    """Make a spec from FILE.rdl (SystemRDL) or FILE.json (a configuration of riocore).

    SystemRDL gives registers, fields, enumerations, arrays, register files and documentation. It needs the
    package systemrdl-compiler. riocore gives components, words at pins, and the command that builds the
    bitstream. What UL-spec cannot express is reported on stderr, item by item.

    \b
    Examples:
      unitylink import uart.rdl
      unitylink import soc.rdl --top uart --out uart.ul
      unitylink import mill.json --out mill.ul
      unitylink import mill.json --out mill.ul --board ulx3s:85f
    """
    if Path(file).suffix.lower() == ".json":
        if top is not None or include:
            raise click.UsageError("--top and --include are for SystemRDL")
        imported = _riocore(file, board, out)
    elif board is not None:
        raise click.UsageError("--board is for a configuration of riocore, FILE.json")
    else:
        imported = _systemrdl(file, top, include)
    for note in imported.notes:
        click.echo(f"note: {note}", err=True)
    if out is None:
        click.echo(imported.text, nl=False)
        return
    try:
        with Path(out).open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(imported.text)
    except FileExistsError:
        raise Failure(f"{out} exists", "move it away, or give another --out") from None
    click.echo(f"wrote {out}")
    if imported.build:
        click.echo(f"build it with: {imported.build}")


def _riocore(file: str, board: str | None, out: str | None) -> Imported:
    from .riocore import import_riocore

    return import_riocore(file, board, out)


def _systemrdl(file: str, top: str | None, include: tuple[str, ...]) -> Imported:
    try:
        from .systemrdl import read_systemrdl, write_spec
    except ModuleNotFoundError as error:
        if error.name is None or not error.name.startswith("systemrdl"):
            raise
        raise absent("systemrdl-compiler", "reading SystemRDL") from None
    return write_spec(read_systemrdl(file, top, include))
