# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink demo`: run an example of this package."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import click

from .failure import Failure


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("name", default="scara")
@click.option("--list", "listing", is_flag=True, help="List the examples, and where they are.")
@click.option("--picture", metavar="PNG", type=click.Path(dir_okay=False), help="Save the joint paths there.")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def command(name: str, *, listing: bool, picture: str | None, arguments: tuple[str, ...]) -> None:
    """Run an example on a virtual board. It is the paper's SCARA robot unless NAME is another one.

    ARGUMENTS go to the example. `unitylink demo NAME --help-example` shows them.

    \b
    Examples:
      unitylink demo
      unitylink demo --picture scara.png
      unitylink demo scara --link "serial:/dev/ttyUSB0?baud=3000000"
      unitylink demo --list
    """
    from unitylink.resources import resource_folder

    folder = resource_folder("examples")
    examples = {path.parent.name: path for path in sorted(folder.glob("*/run.py"))}
    if listing:
        for example, path in examples.items():
            click.echo(f"{example:<12} {_title(path.with_name('README.md'))}\n{'':<12} {path}")
        return
    if name not in examples:
        raise Failure(f"no example is called {name}", f"there are: {', '.join(examples)}")
    given = ["--help" if argument == "--help-example" else argument for argument in arguments]
    if picture is not None:
        given += ["--picture", str(Path(picture).resolve())]
    done = subprocess.run([sys.executable, examples[name], *given], check=False)
    click.get_current_context().exit(done.returncode)


def _title(readme: Path) -> str:
    return readme.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ") if readme.is_file() else ""
