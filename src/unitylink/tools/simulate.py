# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink simulate`: a virtual board for other programs."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from .output import json_option, print_json
from .root import part_of, root_option
from .serving import endpoint_of, serve, serving_options

if TYPE_CHECKING:
    from unitylink.simulate import Board
    from unitylink.spec.model import Spec


def _number(name: str, what: str, *, field: str | None = None, least: int = 1) -> Callable[[Any], Any]:
    names = (name, field) if field is not None else (name,)
    return click.option(*names, type=click.IntRange(least), metavar="N", help=what)


@click.command()
@click.argument("spec_file", metavar="SPEC")
@serving_options
@root_option("Serve one board")
@click.option(
    "--plant",
    metavar="PLANT",
    help="What moves behind the registers: ramp, loopback, scara, FILE.py or a recording.",
)
@_number("--fifo", "Bytes in the board's receive and transmit buffers, as on real boards.")
@_number("--baud", "Pace bytes as a UART of this baud rate does.", field="baud_hz")
@click.option("--rtl", is_flag=True, help="Serve the VHDL of the spec, compiled, instead of the twin.")
@_number("--clock-hz", "Clock of the board; with --rtl 1 MHz unless told.")
@_number("--data-bits", "Width of a word (8 to 32).")
@_number("--base-hz", "Base publish frequency.")
@_number("--groups", "Publish groups (1 to 256).")
@_number("--group-size", "Addresses of a publish group (1 to 255).")
@_number("--rate-bytes", "Bytes of a publish rate (1 to 4).")
@_number("--publish-mode", "0 no publishing, 1 requests first, 2 publishes first.", least=0)
@_number("--read-many", "Most words of one read-many (0 to 255).", least=0)
@json_option("the address")
def command(
    spec_file: str,
    *,
    tcp: str | None,
    udp: str | None,
    pty: str | None,
    bind: str | None,
    root: str | None,
    plant: str | None,
    rtl: bool,
    as_json: bool,
    **generics: int | None,
) -> None:
    """Serve a virtual board of a spec until Ctrl-C: the classic gateware, bit by bit, and a plant that moves.

    With --rtl it is the VHDL that `unitylink generate --only vhdl` makes, compiled by GHDL and Verilator:
    half a minute the first time, then from a cache.

    Anybody on this machine can connect, one at a time; other machines only where --bind allows it.

    \b
    Examples:
      unitylink simulate arm.ul --tcp 5555 --plant loopback
      unitylink simulate arm.ul --pty ./arm.tty --baud 3000000 --fifo 16
      unitylink simulate arm.ul --tcp 5555 --bind 0.0.0.0
      unitylink simulate arm.ul --rtl --tcp 5555 --plant loopback
      unitylink simulate two_arms.ul --root left_arm --tcp 5555
    """
    endpoint, address = endpoint_of(tcp, udp, pty, bind)
    from unitylink.simulate import DEFAULT_PLANT, load_plant
    from unitylink.spec import load

    spec = part_of(load(spec_file), root)
    given = {name: value for name, value in generics.items() if value is not None}
    moving = load_plant(plant or DEFAULT_PLANT, spec)
    with _board(rtl, spec, given, plant=moving, endpoint=endpoint, bind=address) as board:
        serve(board, lambda: _announce(board, spec, spec_file, plant or DEFAULT_PLANT, as_json))


def _board(rtl: bool, spec: Spec, generics: dict[str, int], **options: Any) -> Board:
    """Make the twin of `spec`, or the board that is its VHDL."""
    from unitylink.simulate import Board, BoardConfiguration

    if not rtl:
        return Board(spec, configuration=BoardConfiguration.for_spec(spec, **generics), **options)
    from unitylink.simulate.rtl import RtlBoard, rtl_configuration

    return RtlBoard(spec, configuration=rtl_configuration(spec, **generics), **options)


def _announce(board: Board, spec: Spec, spec_file: str, plant: str, as_json: bool) -> None:
    """Say where the board is and what to try."""
    if as_json:
        print_json({"url": board.url, "spec": spec_file, "plant": plant}, indent=None)
    else:
        first = next((name for name, element in spec.walk() if element.access == "READ"), None)
        click.echo(f"serving {spec_file} (plant {plant}) at {board.url}")
        if first is not None:
            click.echo(f"try:  unitylink read {board.url} {first} --spec {spec_file}")
        click.echo("Ctrl-C ends it")
