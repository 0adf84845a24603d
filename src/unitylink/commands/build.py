# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink build`: a bitstream from a spec, with open tools."""

from __future__ import annotations

import json
import time
from pathlib import Path

import click

from .failure import Failure
from .output import json_option, print_table
from .root_option import root_option


@click.command()
@click.argument("spec_file", metavar="SPEC", required=False)
@click.option(
    "--board", "board_name", metavar="NAME", help="Which board. A folder with your own board.toml works too."
)
@root_option("Build one board")
@click.option("--list", "listing", is_flag=True, help="List the boards.")
@click.option(
    "--logic",
    multiple=True,
    metavar="FILE.vhd",
    help="Your own VHDL around the link. If several, the top's first.",
)
@click.option("--top", metavar="ENTITY", help="The entity of --logic that is built.")
@click.option(
    "--pin", "pins", multiple=True, metavar="PORT=PIN", help="Where a port goes: servos=P1A1,P1A2 or lamp=-."
)
@click.option(
    "--clock-hz", type=click.IntRange(1), metavar="N", help="Clock of the design, by the board's PLL."
)
@click.option("--baud", "baud_hz", type=click.IntRange(1), metavar="N", help="Baud rate of the link.")
@click.option(
    "--seeds", type=click.IntRange(1, 100), default=3, help="Seeds of nextpnr to try for the clock (3)."
)
@click.option(
    "--protocol",
    type=click.Choice(("both", "framed", "classic")),
    help="Protocol of the link, if not that of the board's manifest.",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help="A setting of the gateware, if not that of the spec: groups=2.",
)
@click.option("--part", metavar="PART", help="The chip, for --board vendor:TOOL.")
@click.option(
    "--out", metavar="FOLDER", help="Where to build (build/SPEC-BOARD; with --root build/NAME-BOARD)."
)
@json_option("the report")
def command(
    spec_file: str | None,
    *,
    board_name: str | None,
    root: str | None,
    listing: bool,
    logic: tuple[str, ...],
    top: str | None,
    pins: tuple[str, ...],
    clock_hz: int | None,
    baud_hz: int | None,
    seeds: int,
    protocol: str | None,
    settings: tuple[str, ...],
    part: str | None,
    out: str | None,
    as_json: bool,
) -> None:
    """Build a bitstream from SPEC with GHDL, yosys and nextpnr, and a report of area, clock and link.

    NAME_board.vhd beside the spec is the logic around the link. Without it, and without --logic, words and
    components go to pins by --pin, or by their names (led, buttons, servo, encoder ...).

    \b
    Examples:
      unitylink build --list
      unitylink build servo.ul --board icebreaker
      unitylink build arm.ul --board ulx3s:85f --pin brake=GP5 --clock-hz 40000000
      unitylink build two_arms.ul --root left_arm --board ulx3s:85f
      unitylink build arm.ul --board vendor:vivado --part xc7a35ticsg324-1L --clock-hz 100000000
    """
    from unitylink.boards import Order, board_names, build_bitstream, load_board
    from unitylink.boards.fit import settings_of

    if listing:
        print_table(("board", ""), [(name, load_board(name).title) for name in board_names()])
        return
    if spec_file is None or board_name is None:
        raise click.UsageError("name a SPEC and a --board; `unitylink build --list` shows which there are")
    name = Path(board_name).name.replace(":", "-").removesuffix(".toml")
    folder = Path(out) if out is not None else Path("build") / f"{root or Path(spec_file).stem}-{name}"
    started = time.monotonic()

    def tell(text: str) -> None:
        click.echo(f"{time.monotonic() - started:5.0f} s  {text}", err=True)

    if board_name.startswith("vendor:"):
        from unitylink.boards.vendor import VendorOrder, write_project

        if part is None or clock_hz is None:
            raise Failure(
                f"{board_name} needs --part PART and --clock-hz N",
                "the chip's full name, the clock at its pin",
            )
        wanted = VendorOrder(
            spec_file=spec_file,
            folder=folder,
            root=root,
            logic=tuple(map(Path, logic)),
            top=top,
            pins=pins,
            vendor=board_name.partition(":")[2],
            part=part,
            clock_hz=clock_hz,
            baud_hz=baud_hz,
            protocol=protocol,
            settings=settings_of(settings),
        )
        for path in write_project(wanted):
            click.echo(f"wrote {path}")
        return
    if part is not None:
        raise click.UsageError("--part is for --board vendor:TOOL, as vendor:vivado")
    order = Order(
        spec_file=spec_file,
        folder=folder,
        root=root,
        board=load_board(board_name),
        logic=tuple(map(Path, logic)),
        top=top,
        pins=pins,
        clock_hz=clock_hz,
        baud_hz=baud_hz,
        seeds=seeds,
        protocol=protocol,
        settings=settings_of(settings),
    )
    report = build_bitstream(order, tell)
    if as_json:
        click.echo(json.dumps(json.loads((folder / "report.json").read_text(encoding="utf-8")), indent=2))
    else:
        click.echo(report.text())
        click.echo(f"next: unitylink flash {folder}")
