# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet update`: a running fleet becomes what its file says now, robot by robot."""

from __future__ import annotations

import click

from .failure import Failure
from .fleet_run import fleet_argument


@click.command(short_help="Bring a running fleet to what its file says now.")
@fleet_argument
@click.option("--robot", "robots", multiple=True, metavar="NAME", help="Only this one. May be repeated.")
@click.option("--force", is_flag=True, help="Update a robot although somebody writes it or has stopped it.")
def update(file: str, *, robots: tuple[str, ...], force: bool) -> None:
    """Roll changes out: a new spec, another link, other rights. One robot after the other.

    Edit the specs or FLEET.toml first. The program that runs the fleet takes each robot that differs, and
    starts its bridge anew. Then it waits until the robot is well for 2 s: its board answers, with the new
    spec, and its gateware was built from that. If it is not well within 30 s, it gets back what it had, and
    the update stops.

    A robot that somebody writes stops the update, too. Gateware is not flashed: do that before.

    \b
    Examples:
      unitylink fleet update fleet.toml --robot arm1
      unitylink fleet update fleet.toml
    """
    from unitylink.fleet.control import ask
    from unitylink.fleet.reader import read_fleet

    fleet = read_fleet(file)  # a mistake is named here, before anything is asked
    done = None
    for told in ask(fleet.file, {"update": list(robots), "force": force}):
        if "error" in told:
            raise Failure(str(told["error"]))
        if "done" in told:
            done = bool(told["done"])
        else:
            click.echo(f"{told['robot']}: {told['text']}")
    if done is None:
        raise Failure("the program that runs the fleet has ended meanwhile", f"unitylink fleet status {file}")
    click.get_current_context().exit(0 if done else 1)
