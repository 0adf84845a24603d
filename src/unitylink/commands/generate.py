# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink generate`: files made from a spec."""

from __future__ import annotations

import click

from unitylink.settings import SETTINGS

from .failure import Failure
from .root_option import part_of, root_option


@click.command()
@click.argument("spec_file", metavar="SPEC")
@click.option(
    "--out",
    metavar="FOLDER",
    default=".",
    help="Where to write (here); made if it does not exist.",
)
@click.option(
    "--only",
    metavar="ARTEFACT[,...]",
    help="Make these: python (the default), cpp, c, rust, matlab, fmu, vhdl, bench (of your logic), json, "
    "html, ros1, ros2, lerobot.",
)
@click.option(
    "--physical",
    metavar="LAYER",
    help="Physical layer of the VHDL: uart (the default), ft245_async, ft245_sync, spi, rs485.",
)
@click.option(
    "--send-immediate",
    metavar="MODE",
    help="After which messages an FT245 sends at once: never, publishes, replies, both (the default).",
)
@click.option(
    "--protocol", metavar="NAME", help="What the VHDL's core speaks: both (the default), framed, classic."
)
@click.option(
    "--engine",
    type=click.Choice(SETTINGS["engine"].choices),
    help="Engine of the framed protocol, if not that of the spec: fast, small.",
)
@root_option("Make the VHDL of one board")
@click.option(
    "--check", is_flag=True, help="Write nothing; exit with 1 if a file is missing, stale or edited."
)
def command(
    *,
    spec_file: str,
    out: str,
    only: str | None,
    physical: str | None,
    send_immediate: str | None,
    protocol: str | None,
    engine: str | None,
    root: str | None,
    check: bool,
) -> None:
    """Make typed Python classes and a gateware design in VHDL from a spec.

    The Python has an attribute for each item, with its address, type and unit. `cpp` and `c` are headers with
    the same objects for C++20 and C11. The VHDL, in the folder vhdl/,
    is a complete design: the link, a register for each item, and records that give your logic the items by
    name. A spec with several links gets a design for the board behind each.

    The same spec always gives the same files. Files that are up to date stay as they are. A file that was not
    generated is never overwritten. A generated module whose spec has changed cannot be imported.

    \b
    Examples:
      unitylink generate arm.ul
      unitylink generate arm.ul --out build --only python,vhdl
      unitylink generate arm.ul --only cpp
      unitylink generate arm.ul --out build --only vhdl,bench
      unitylink generate arm.ul --out build --only vhdl --physical ft245_async
      unitylink generate two_arms.ul --out build --only vhdl --root left_arm
      unitylink generate arm.ul --check
    """
    from unitylink.generate import ARTEFACTS, DEFAULT, SpecPlan, planned_files, stale_files, write_files
    from unitylink.spec import load

    artefacts = [name.strip() for name in only.split(",")] if only is not None else list(DEFAULT)
    for name in artefacts:
        if name not in ARTEFACTS:
            raise click.UsageError(
                f"--only {name}: there is no such artefact; there are: {', '.join(ARTEFACTS)}"
            )
    gateware = {"--physical": physical, "--send-immediate": send_immediate, "--protocol": protocol}
    gateware |= {"--engine": engine}
    given = {**gateware, "--root": root}
    if any(given.values()) and not any(ARTEFACTS[name].gateware for name in artefacts):
        raise click.UsageError(
            f"{' and '.join(o for o in given if given[o])}: only for VHDL; add --only vhdl"
        )
    configuration = {option[2:].replace("-", "_"): value for option, value in gateware.items() if value}
    spec = load(spec_file)
    whole = SpecPlan(spec, configuration)
    board = whole if root is None else SpecPlan(part_of(spec, root), configuration)
    made = (planned_files(board if ARTEFACTS[name].gateware else whole, [name]) for name in artefacts)
    if check:
        problems = [problem for files in made for problem in stale_files(files, out)]
        if problems:
            again = f"{spec_file} --out {out}" + (f" --only {only}" if only is not None else "")
            again += "".join(f" {option} {value}" for option, value in given.items() if value is not None)
            raise Failure("; ".join(problems), f"`unitylink generate {again}` brings them up to date")
        click.echo(f"{out}: up to date with {spec_file}")
        return
    unchanged = 0
    for files in made:
        written = write_files(files, out)
        unchanged += len(files) - len(written)
        for path in written:
            click.echo(f"wrote {path}")
    if unchanged:
        click.echo(f"{unchanged} file{'s' if unchanged > 1 else ''} already up to date")
