# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink import`: specs from other languages."""

from __future__ import annotations

from pathlib import Path

import click

from unitylink.optional import absent

from .failure import Failure


@click.command(name="import")
@click.argument("file", metavar="FILE.rdl")
@click.option(
    "--out", metavar="FILE.ul", help="Write here. Without it the spec is printed. Never overwrites a file."
)
@click.option("--top", metavar="NAME", help="The address map. By default the last one of the file.")
@click.option("--include", metavar="FOLDER", multiple=True, help="Folder for `include files.")
def command(file: str, out: str | None, top: str | None, include: tuple[str, ...]) -> None:
    """Make a spec from SystemRDL: registers, fields, enumerations, arrays, register files, documentation.

    Differences, and what UL-spec cannot express, are reported on stderr. It needs the package
    systemrdl-compiler.

    \b
    Examples:
      unitylink import uart.rdl
      unitylink import soc.rdl --top uart --out uart.ul
    """
    try:
        from .systemrdl import read_systemrdl, write_spec
    except ModuleNotFoundError as error:
        if error.name is None or not error.name.startswith("systemrdl"):
            raise
        raise absent("systemrdl-compiler", "reading SystemRDL") from None
    imported = write_spec(read_systemrdl(file, top, include))
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
