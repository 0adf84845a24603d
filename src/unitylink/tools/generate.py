# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink generate`: files made from a spec."""

from __future__ import annotations

import click

from .failure import Failure


@click.command()
@click.argument("spec_file", metavar="SPEC")
@click.option("--out", metavar="FOLDER", required=True, help="Where to write; made if it does not exist.")
@click.option("--only", metavar="ARTEFACT[,...]", help="Make only these; now there is python.")
@click.option(
    "--check", is_flag=True, help="Write nothing; exit with 1 if a file is missing, stale or edited."
)
def command(spec_file: str, out: str, only: str | None, check: bool) -> None:
    """Make typed Python classes from a spec: an attribute for each item, with its address, type and unit.

    The same spec always gives the same files. Files that are up to date are left alone, and a file that is
    not a generated one is never overwritten. A generated module whose spec has changed refuses to be
    imported.

    \b
    Examples:
      unitylink generate scara.ul --out .
      unitylink generate scara.ul --out build --only python
      unitylink generate scara.ul --out . --check
    """
    from unitylink.generate import ARTEFACTS, generate, stale, write
    from unitylink.spec import load

    artefacts = [name.strip() for name in only.split(",")] if only is not None else list(ARTEFACTS)
    for name in artefacts:
        if name not in ARTEFACTS:
            raise click.UsageError(
                f"--only {name}: there is no such artefact; there are: {', '.join(ARTEFACTS)}"
            )
    spec = load(spec_file)
    if check:
        problems = [problem for name in artefacts for problem in stale(spec, out, name)]
        if problems:
            raise Failure(
                "; ".join(problems), f"`unitylink generate {spec_file} --out {out}` brings them up to date"
            )
        click.echo(f"{out}: up to date with {spec_file}")
        return
    written = [path for name in artefacts for path in write(spec, out, name)]
    for path in written:
        click.echo(f"wrote {path}")
    unchanged = sum(len(generate(spec, name)) for name in artefacts) - len(written)
    if unchanged:
        click.echo(f"{unchanged} file{'s' if unchanged > 1 else ''} already up to date")
