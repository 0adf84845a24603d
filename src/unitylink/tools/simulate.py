# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink simulate`: a virtual board for other programs."""

from __future__ import annotations

import ipaddress
import signal
import sys
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from .output import json_option, print_json

if TYPE_CHECKING:
    from unitylink.simulate import Board
    from unitylink.spec.model import Spec

_LOOPBACK = "127.0.0.1"
_TICK_S = 0.2  # between two looks at whether the board still runs


def _number(name: str, what: str, *, field: str | None = None, least: int = 1) -> Callable[[Any], Any]:
    names = (name, field) if field is not None else (name,)
    return click.option(*names, type=click.IntRange(least), metavar="N", help=what)


@click.command()
@click.argument("spec_file", metavar="SPEC")
@click.option(
    "--tcp", metavar="[HOST:]PORT", help="Serve on TCP; port 0 takes a free one (the default is --tcp 0)."
)
@click.option("--udp", metavar="[HOST:]PORT", help="Serve on UDP.")
@click.option("--pty", metavar="PATH", help="Serve on a pseudo-terminal, a serial port in software, at PATH.")
@click.option(
    "--bind", metavar="ADDRESS", help="Serve others than this machine too: the address to listen on."
)
@click.option(
    "--plant", metavar="PLANT", help="What moves behind the registers: ramp, loopback, scara or FILE.py."
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
      unitylink simulate scara.ul --tcp 5555 --plant scara
      unitylink simulate scara.ul --pty ./scara.tty --baud 3000000 --fifo 16
      unitylink simulate arm.ul --tcp 5555 --bind 0.0.0.0
      unitylink simulate scara.ul --rtl --tcp 5555 --plant scara
    """
    endpoint, address = endpoint_of(tcp, udp, pty, bind)
    from unitylink.simulate import DEFAULT_PLANT, load_plant
    from unitylink.spec import load

    spec = load(spec_file)
    given = {name: value for name, value in generics.items() if value is not None}
    moving = load_plant(plant or DEFAULT_PLANT, spec)
    with _board(rtl, spec, given, plant=moving, endpoint=endpoint, bind=address) as board:
        stop = threading.Event()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: stop.set())
        _announce(board, spec, spec_file, plant or DEFAULT_PLANT, as_json)
        while not stop.wait(_TICK_S):
            if board.error is not None:
                raise board.error


def _board(rtl: bool, spec: Spec, generics: dict[str, int], **options: Any) -> Board:
    """Make the twin of `spec`, or the board that is its VHDL."""
    from unitylink.simulate import Board, BoardConfiguration

    if not rtl:
        return Board(spec, configuration=BoardConfiguration.for_spec(spec, **generics), **options)
    from unitylink.simulate.rtl import RtlBoard, rtl_configuration

    return RtlBoard(spec, configuration=rtl_configuration(spec, **generics), **options)


def _announce(board: Board, spec: Spec, spec_file: str, plant: str, as_json: bool) -> None:
    """Say where the board is and what to try; flushed, for whoever waits for it."""
    if as_json:
        print_json({"url": board.url, "spec": spec_file, "plant": plant}, indent=None)
    else:
        first = next((name for name, element in spec.walk() if element.access == "READ"), None)
        click.echo(f"serving {spec_file} (plant {plant}) at {board.url}")
        if first is not None:
            click.echo(f"try:  unitylink read {board.url} {first} --spec {spec_file}")
        click.echo("Ctrl-C ends it")
    sys.stdout.flush()


def endpoint_of(tcp: str | None, udp: str | None, pty: str | None, bind: str | None) -> tuple[str, str]:
    """Return (endpoint, address to bind) of a Board; one others can reach has to come from `--bind`."""
    given = [kind for kind, value in (("tcp", tcp), ("udp", udp), ("pty", pty)) if value is not None]
    if len(given) > 1:
        raise click.UsageError(f"--{' and --'.join(given)} exclude each other; one board serves one endpoint")
    if pty is not None:
        if bind is not None:
            raise click.UsageError("--bind goes with --tcp or --udp")
        return f"pty:{pty}", _LOOPBACK
    kind = given[0] if given else "tcp"
    host, port = _place(kind, tcp if tcp is not None else udp if udp is not None else "0")
    if host is not None and bind is not None and host != bind:
        raise click.UsageError(f"--{kind} says {host} and --bind says {bind}; leave the host out of --{kind}")
    if host is not None and bind is None and not _is_loopback(host):
        raise click.UsageError(
            f"{host} is not a loopback address: other machines could reach the board; if that is meant: "
            f"--{kind} {port} --bind {host}"
        )
    return f"{kind}:{port}", bind or host or _LOOPBACK


def _place(kind: str, text: str) -> tuple[str | None, int]:
    """Take `[HOST:]PORT` apart."""
    host, colon, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise click.UsageError(
            f"--{kind} {text}: expected [HOST:]PORT with a port from 0 to 65535, like 5555"
        )
    return (host.strip("[]") or None) if colon else None, int(port)


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
