# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink experiments`: the paper's measurements, repeated."""

from __future__ import annotations

from pathlib import Path

import click

from unitylink.commands.failure import Failure


@click.command()
@click.option(
    "--out",
    metavar="DIR",
    default="experiments",
    show_default=True,
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder of the report.",
)
@click.option("--quick", is_flag=True, help="Repeat less often. Takes about ten minutes.")
@click.option(
    "--soak",
    metavar="SECONDS",
    type=click.FloatRange(min=1),
    help="How long memory is watched while publishes come.  [default: 60, with --quick 3]",
)
@click.option(
    "--only", metavar="PART", multiple=True, help="Only this part of the report. May be given several times."
)
@click.option(
    "--bit", is_flag=True, help="Add our gateware as unpacked from a bitstream to the part gateware."
)
def command(out: Path, quick: bool, soak: float | None, only: tuple[str, ...], bit: bool) -> int:
    """Repeat the measurements of the paper's section VI on a model of its USB chip.

    It writes report.md, report.html, the figures and results.json into DIR. The model has a clock of its own.
    So a busy machine changes only the measured cost of this host's software. The clocks of our gateware are
    those of its VHDL. They are compiled the first time, which needs GHDL and Verilator. With --bit,
    bitstreams for an iCE40 HX8K are made, unpacked and run as well. That takes some minutes.

    \b
    Parts: gateware, table-one, links, publishing, peers, scaling, ros, simplicity.

    \b
    Examples:
      unitylink experiments --out build/experiments
      unitylink experiments --quick
      unitylink experiments --only peers
      unitylink experiments --only gateware --bit
    """
    from unitylink_lab.experiments import PARTS, run_all, write

    if unknown := [name for name in only if name not in PARTS]:
        raise Failure(f"--only {unknown[0]}: there is no such part", f"there are: {', '.join(PARTS)}")
    soak_s = soak if soak is not None else 3.0 if quick else 60.0
    results = run_all(
        quick=quick,
        soak_s=soak_s,
        say=lambda text: click.echo(text, err=True),
        only=only,
        bitstreams=bit,
    )
    try:
        write(out, results)
    except OSError as error:
        raise Failure(
            f"{out}: {error.strerror or error}", "choose a folder that can be written to"
        ) from error
    click.echo(str(out / "report.html"))
    return 0
