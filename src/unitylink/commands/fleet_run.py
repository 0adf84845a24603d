# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet run`: a bridge for each robot, watched and started again, until Ctrl-C."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from unitylink.errors import FleetError

if TYPE_CHECKING:
    from unitylink.fleet.description import Fleet
    from unitylink.fleet.supervisor import Supervisor

_LAST_LINES_S = 1.0  # how long the last lines may take
fleet_argument = click.argument("file", metavar="FLEET.toml")
as_option = click.option(
    "--as", "who", default="", metavar="NAME", help="Your name, if the network asks for it."
)


@click.command(short_help="Run it, until Ctrl-C (without an action, too).")
@fleet_argument
@click.option("--check-config", is_flag=True, help="Check the description and the specs, and end.")
@click.option("--duration", "duration_s", type=click.FloatRange(0), metavar="S", help="End after S seconds.")
def run(file: str, *, check_config: bool, duration_s: float | None) -> None:
    """Run a fleet: a bridge for each robot, as a process of its own, until Ctrl-C.

    A bridge that ends is started again, after a pause that doubles from 0.25 s up to 30 s. On a terminal,
    one table shows all robots. Elsewhere each change is a line. Ctrl-C and SIGTERM end all of it in order:
    outputs keep their values.

    Without `connect` or `zenoh_config` in the file, this program is the router of the network.

    \b
    Examples:
      unitylink fleet fleet.toml
      unitylink fleet run fleet.toml --check-config
    """
    from unitylink.fleet.control import Control
    from unitylink.fleet.reader import read_fleet
    from unitylink.fleet.specs import SpecStore
    from unitylink.fleet.supervisor import Supervisor
    from unitylink.program import stopped_by_signals

    from .fleet_bridges import start_bridge
    from .fleet_table import News, show

    fleet = read_fleet(file)
    _check_router(fleet)
    if check_config:
        with SpecStore(fleet) as specs:
            for robot in fleet.robots:
                click.echo(f"{robot.name}: {robot.link} as {robot.key}, spec {specs.hash(robot)}")
        return
    news = News()
    with stopped_by_signals() as stop, ExitStack() as stack:
        stack.callback(news.finish, _LAST_LINES_S)
        supervisor = stack.enter_context(Supervisor(fleet, news.say, start_bridge))
        stack.callback(Control(fleet.file, partial(_update, supervisor)).close)
        where = fleet.connect or fleet.zenoh_config or fleet.router
        click.echo(f"{len(fleet.robots)} robots of {fleet.name} on Zenoh, at {where}; Ctrl-C ends it")
        sys.stdout.flush()
        if duration_s is not None:
            timer = threading.Timer(duration_s, stop.set)
            timer.daemon = True
            timer.start()
        show(supervisor, news, stop)
        news.say(fleet.name, "ends its bridges")


def _update(supervisor: Supervisor, wish: dict[str, Any], say: Callable[[str, str], None]) -> bool:
    """Do what `unitylink fleet update` asks for."""
    from unitylink.fleet.reader import read_fleet
    from unitylink.fleet.rollout import Rollout

    fleet = read_fleet(supervisor.fleet.file)
    only = [str(name) for name in wish.get("update", ())]
    return Rollout(supervisor, say).run(fleet, only, force=wish.get("force") is True)


def _check_router(fleet: Fleet) -> None:
    from .bridge_zenoh import unfit

    anyone = fleet.anyone or bool(fleet.security)
    if why := unfit(fleet.router, anyone=anyone, remedy="add anyone = true below [fleet]"):
        raise FleetError(f"{fleet.file}: [fleet]: router = {fleet.router!r}: {why}")
