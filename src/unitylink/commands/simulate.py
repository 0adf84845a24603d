# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink simulate`: a virtual board for other programs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from unitylink.settings import SETTINGS

from .model_view import ModelView, view_options
from .output import json_option, print_json
from .root_option import part_of, root_option
from .serving import endpoint_of, serve, serving_options

if TYPE_CHECKING:
    from unitylink.simulate import Board
    from unitylink.spec.model import Spec


def _setting_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for every setting that a URL may change."""
    for setting in reversed([one for one in SETTINGS.values() if one.option]):
        name = f"--{setting.option.replace('_', '-')}"
        what = f"{setting.what[0].upper()}{setting.what[1:]}"
        if setting.type == "choice":
            option = click.option(name, setting.name, type=click.Choice(setting.choices), help=f"{what}.")
        else:
            kind = click.IntRange(setting.least, setting.most)
            unit = f" ({setting.unit})" if setting.unit else ""
            option = click.option(name, setting.name, type=kind, metavar="N", help=f"{what}{unit}.")
        command = option(command)
    return command


@click.command()
@click.argument("spec_file", metavar="SPEC")
@serving_options
@root_option("Serve one board")
@click.option(
    "--plant",
    metavar="PLANT",
    help="What moves behind the registers: ramp, loopback, scara, FILE.py, mujoco:FILE.xml or a recording.",
)
@view_options
@click.option("--rtl", is_flag=True, help="Serve the VHDL of the spec, compiled, instead of the twin.")
@_setting_options
@json_option("the address")
def command(
    spec_file: str,
    *,
    tcp: str | None,
    udp: str | None,
    pty: str | None,
    bind: str | None,
    anyone: bool,
    root: str | None,
    plant: str | None,
    view: bool,
    picture: Path | None,
    film: Path | None,
    rtl: bool,
    as_json: bool,
    **settings: int | str | None,
) -> None:
    """Serve a virtual board of a spec until Ctrl-C: a model of the gateware, and a plant that moves.

    The model speaks both protocols. It gives the same replies as the VHDL, byte for byte. Their times are
    exact only for the classic protocol.

    docs/settings.md explains the settings of the board.

    With --rtl, the board is the VHDL that `unitylink generate --only vhdl` makes. GHDL and Verilator compile
    it. That takes half a minute the first time. Later it comes from a cache.

    Anybody on this machine can connect, one at a time. Other machines need --bind and --anyone.

    \b
    Examples:
      unitylink simulate arm.ul --tcp 5555 --plant loopback
      unitylink simulate arm.ul --pty ./arm.tty --baud 3000000 --fifo 16
      unitylink simulate arm.ul --tcp 5555 --bind 0.0.0.0 --anyone
      unitylink simulate arm.ul --rtl --tcp 5555 --plant loopback
      unitylink simulate two_arms.ul --root left_arm --tcp 5555
      unitylink simulate arm.ul --plant mujoco:arm.xml --film arm.gif
    """
    endpoint, address = endpoint_of(tcp, udp, pty, bind, anyone)
    from unitylink.simulate import DEFAULT_PLANT, load_plant
    from unitylink.spec import load

    spec = part_of(load(spec_file), root)
    given = {name: value for name, value in settings.items() if value is not None}
    moving = load_plant(plant or DEFAULT_PLANT, spec)
    shown = ModelView(moving, view, picture, film)
    with _board(rtl, spec, given, plant=moving, endpoint=endpoint, bind=address) as board:
        try:
            serve(
                board,
                lambda: _announce(board, spec, spec_file, plant or DEFAULT_PLANT, as_json),
                shown.look,
                shown.tick_s,
            )
        finally:
            shown.finish()


def _board(rtl: bool, spec: Spec, settings: dict[str, int | str], **options: Any) -> Board:
    """Make the twin of `spec`, or a board that runs its VHDL."""
    from unitylink.simulate import Board, BoardConfiguration

    if not rtl:
        return Board(spec, configuration=BoardConfiguration.for_spec(spec, **settings), **options)
    from unitylink.simulate.rtl import RtlBoard, rtl_configuration

    return RtlBoard(spec, configuration=rtl_configuration(spec, **settings), **options)


def _announce(board: Board, spec: Spec, spec_file: str, plant: str, as_json: bool) -> None:
    """Print the address of the board, and commands to try."""
    if as_json:
        print_json({"url": board.url, "spec": spec_file, "plant": plant}, indent=None)
    else:
        first = next((name for name, element in spec.walk() if element.access == "READ"), None)
        click.echo(f"serving {spec_file} (plant {plant}) at {board.url}")
        if first is not None:
            click.echo(f"try:  unitylink read {board.url} {first} --spec {spec_file}")
        click.echo("Ctrl-C ends it")
