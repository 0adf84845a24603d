# SPDX-License-Identifier: BSD-3-Clause
"""The part that `simulate` and `replay` share: where a board is served, and serving it until Ctrl-C."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from unitylink.dashboard.place import is_loopback
from unitylink.program import stopped_by_signals

from .several_options import Command, with_options

if TYPE_CHECKING:
    from unitylink.simulate import Board


_LOOPBACK = "127.0.0.1"
_TICK_S = 0.2  # s between two checks whether the board still runs
_LAG_S = 0.05  # a shorter slip is not reported
_OPTIONS = (
    click.option(
        "--tcp", metavar="[HOST:]PORT", help="Serve on TCP. Port 0 takes a free one (the default is --tcp 0)."
    ),
    click.option("--udp", metavar="[HOST:]PORT", help="Serve on UDP."),
    click.option(
        "--pty", metavar="PATH", help="Serve on a pseudo-terminal, a serial port in software, at PATH."
    ),
    click.option(
        "--bind", metavar="ADDRESS", help="The address to listen on. Other machines reach it with --anyone."
    ),
    click.option(
        "--anyone", is_flag=True, help="With --bind: everybody who reaches the address may command the board."
    ),
)


def serving_options(command: Command) -> Command:
    """Give a command `--tcp --udp --pty --bind --anyone`: the arguments of `endpoint_of`."""
    return with_options(command, _OPTIONS)


def serve(
    board: Board,
    announce: Callable[[], None],
    look: Callable[[], object] = lambda: None,
    tick_s: float | None = None,
) -> None:
    """Announce `board` and wait for Ctrl-C or SIGTERM.

    `look` is called every `tick_s` meanwhile, by default five times a second. If it returns True, it is over.

    The output of `announce` is flushed, for programs that wait for it. Raises the error that ended the board.
    """
    with stopped_by_signals() as stop:  # before the announcement, because its reader may send a signal
        announce()
        sys.stdout.flush()
        while not stop.wait(tick_s or _TICK_S):
            if board.error is not None:
                raise board.error
            if look() is True:
                break
    lag_s = board.statistics.time_slipped_s
    if lag_s >= _LAG_S:  # everything that it publishes stood still with its clock now and then
        lag = f"the clock of the board is late by {lag_s:.2f} s: this machine was too busy to run it in time"
        click.echo(lag, err=True)


def endpoint_of(
    tcp: str | None, udp: str | None, pty: str | None, bind: str | None, anyone: bool
) -> tuple[str, str]:
    """Return (endpoint, address to bind) of a Board.

    If others can reach the address, it must come from `--bind`, with `--anyone`. A warning is printed.
    """
    given = [kind for kind, value in (("tcp", tcp), ("udp", udp), ("pty", pty)) if value is not None]
    if len(given) > 1:
        raise click.UsageError(f"--{' and --'.join(given)} exclude each other; one board serves one endpoint")
    if pty is not None:
        if bind is not None:
            raise click.UsageError("--bind goes with --tcp or --udp")
        return f"pty:{pty}", _LOOPBACK
    kind = given[0] if given else "tcp"
    host, port = place_of(kind, tcp if tcp is not None else udp if udp is not None else "0")
    if host is not None and bind is not None and host != bind:
        raise click.UsageError(f"--{kind} says {host} and --bind says {bind}; leave the host out of --{kind}")
    if host is not None and bind is None and not is_loopback(host):
        raise click.UsageError(
            f"{host} is not a loopback address: other machines could reach the board; if you want that: "
            f"--{kind} {port} --bind {host} --anyone"
        )
    if bind is not None and not is_loopback(bind):
        if not anyone:
            raise click.UsageError(
                f"--bind {bind}: everybody who reaches this machine over a network could command the board, "
                "because there is no log-in; if you want that, add --anyone"
            )
        click.echo(f"warning: everybody who reaches {bind} over a network may command this board", err=True)
    return f"{kind}:{port}", bind or host or _LOOPBACK


def place_of(kind: str, text: str) -> tuple[str | None, int]:
    """Split `[HOST:]PORT`."""
    host, colon, port = text.rpartition(":")
    if not port.isdecimal() or int(port) > 65535:
        raise click.UsageError(
            f"--{kind} {text}: expected [HOST:]PORT with a port from 0 to 65535, like 5555"
        )
    return (host.strip("[]") or None) if colon else None, int(port)
