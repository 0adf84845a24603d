# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fleet status` and `check`: how all robots are, and what is not as described."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .fleet_run import as_option, fleet_argument
from .output import json_option, print_json, print_table

if TYPE_CHECKING:
    from unitylink.fleet.report import RobotReport


@click.command(short_help="Show all robots.")
@fleet_argument
@click.option(
    "--wait", "wait_s", type=click.FloatRange(0), default=0.0, metavar="S", help="Wait for robots up to S s."
)
@as_option
@json_option("all that is known of each robot")
def status(file: str, *, wait_s: float, who: str, as_json: bool) -> None:
    """Show all robots of a fleet: reachable, spec, gateware, losses, who writes, restarts.

    It asks the network, from any machine that has the description. `lost` counts publishes that were lost on
    the line to the board. It counts requests without an answer, too. If a robot is not reachable, the exit
    code is 1.

    \b
    Examples:
      unitylink fleet status fleet.toml
      unitylink fleet status fleet.toml --wait 20
      unitylink fleet status fleet.toml --json
    """
    from unitylink.fleet.look import look_at
    from unitylink.fleet.reader import read_fleet
    from unitylink.fleet.report import HEADERS, RIGHT

    from .fleet_table import rows

    fleet = read_fleet(file)
    run_by, reports = look_at(fleet, wait_s, who=who)
    if as_json:
        print_json({"fleet": fleet.name, "running": run_by, "robots": [one.as_dict() for one in reports]})
    else:
        print_table(HEADERS, rows(reports), right=RIGHT)
        if not run_by:
            click.echo(f"no program runs the fleet {fleet.name}: unitylink fleet {file}", err=True)
    if not all(one.reachable for one in reports):
        click.get_current_context().exit(1)


@click.command(short_help="Compare them with the description.")
@fleet_argument
@as_option
@json_option("what differs")
def check(file: str, *, who: str, as_json: bool) -> None:
    """Compare all robots with the description: their specs, and the gateware of their boards.

    These differ: a robot that is away; a bridge that runs with another spec than the file has now; gateware
    that was built from another spec. Then the exit code is 1. Gateware that does not know its spec is only
    named.

    \b
    Examples:
      unitylink fleet check fleet.toml
    """
    from unitylink.fleet.checks import differences
    from unitylink.fleet.look import look_at
    from unitylink.fleet.reader import read_fleet
    from unitylink.fleet.specs import SpecStore

    fleet = read_fleet(file)
    with SpecStore(fleet) as specs:
        wanted = {robot.name: specs.hash(robot) for robot in fleet.robots}
    _, reports = look_at(fleet, who=who)
    found = differences(wanted, reports)
    if as_json:
        print_json([{"robot": one.robot, "kind": one.kind, "text": one.text} for one in found])
    else:
        for one in found:
            click.echo(f"{one.robot}: {one.text}")
        click.echo(_summary(reports, wanted))
    if any(one.counts for one in found):
        click.get_current_context().exit(1)


def _summary(reports: list[RobotReport], wanted: dict[str, str]) -> str:
    specs = len(set(wanted.values()))
    gateware = len({one.gateware_hash for one in reports if one.gateware_hash})
    up = sum(one.reachable for one in reports)
    return f"{up} of {len(reports)} robots are up; specs: {specs}; gateware built from: {gateware}"
