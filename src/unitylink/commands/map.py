# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink map`: the register map in a browser."""

from __future__ import annotations

import webbrowser

import click


@click.command()
@click.argument("spec_file", metavar="SPEC")
@click.option("--out", metavar="FOLDER", default=".", help="Where to write the page (here).")
@click.option("--no-open", is_flag=True, help="Write the page and do not open it.")
def command(spec_file: str, out: str, no_open: bool) -> None:
    """Write the register map of a spec as one HTML page, and open it in the browser.

    The page has a tree, a search, and boxes that encode and decode the value of every register. It needs no
    network. It is the html artefact of `unitylink generate`.

    \b
    Examples:
      unitylink map arm.ul
      unitylink map arm.ul --out build --no-open
    """
    from pathlib import Path

    from unitylink.generate import generate, write
    from unitylink.spec import load

    spec = load(spec_file)
    (name,) = generate(spec, "html")
    page = Path(out) / name
    click.echo(f"wrote {page}" if write(spec, out, "html") else f"{page} already up to date")
    if not (no_open or webbrowser.open(page.resolve().as_uri())):
        click.echo("no browser was found; open the page by hand", err=True)
