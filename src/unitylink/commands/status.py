# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink status`: who is at a server, and who may write."""

from __future__ import annotations

import time
from typing import Any

import click

from .output import json_option, print_json

_BETWEEN_S = 0.5  # between the two looks from which rates are made


@click.command()
@click.argument("server", metavar="SERVER")
@json_option("the whole state")
def command(server: str, *, as_json: bool) -> None:
    """Show the boards of a server, its clients with their rates, and the write leases.

    SERVER is serve://HOST:PORT, or with /BOARD for one board. Every token of the server will do: put it into
    UNITYLINK_TOKEN, or name its file with ?token_file=. The link to the board is not used.

    \b
    Examples:
      unitylink status serve://127.0.0.1:7450
      unitylink status "serve://lab:7450/arm?tls_ca=cert.pem"
      unitylink status serve://127.0.0.1:7450/arm --json
    """
    from unitylink.server.questions import ask_server

    before = ask_server(server, "status")
    time.sleep(_BETWEEN_S)
    after = ask_server(server, "status")
    _add_rates(before, after)
    if as_json:
        print_json(after)
        return
    for robot in after["robots"]:
        _print_robot(robot)
    click.echo(f"refused: {after['refused']}; turned away without a login: {after['turned_away']}")
    if lost := after.get("log_lines_lost"):
        click.echo(f"lines of the log that could not be written: {lost}")


def _add_rates(before: dict[str, Any], after: dict[str, Any]) -> None:
    """Put requests and publishes per second into the clients of `after`."""
    earlier = {
        (robot["name"], client["id"]): client
        for robot in before["robots"]
        for client in robot.get("clients", [])
    }
    for robot in after["robots"]:
        for client in robot.get("clients", []):
            first = earlier.get((robot["name"], client["id"]))
            for counter in ("requests", "publishes"):
                passed_s = client["age_s"] - (first["age_s"] if first else 0.0)
                more = client[counter] - (first[counter] if first else 0)
                client[f"{counter}_per_s"] = round(more / passed_s, 1) if passed_s > 0 else 0.0


def _print_robot(robot: dict[str, Any]) -> None:
    away = f"away: {robot['away']}" if robot["away"] else "up"
    click.echo(f"{robot['name']} at {robot['link']}, {away}")
    if robot["stopped_by"]:
        click.echo(f"  stopped by {robot['stopped_by']}")
    for client in robot.get("clients", []):
        facts = [f"{client['requests_per_s']:g} requests/s", f"{client['publishes_per_s']:g} publishes/s"]
        facts += [f"{client['publishes_lost']} publishes lost"] if client["publishes_lost"] else []
        facts += [f"{client['refused']} refused"] if client["refused"] else []
        facts += ["dead-man"] if client["dead_man"] else []
        facts.append(f"silent for {client['silent_s']:.3g} s")
        click.echo(f"  {client['name']} from {client['where']}: {', '.join(facts)}")
    for lease in robot["leases"]:
        ending = f" (it is being made safe: {lease['ending']})" if lease["ending"] else ""
        click.echo(f"  {lease['holder']} from {lease['where']} writes {lease['part']}{ending}")
    for wish in robot["wishes"]:
        how = "is kept for" if wish["kept"] else "is wanted by"
        click.echo(f"  {wish['part']} {how} {wish['user']}, for {wish['left_s']:.0f} s more")
    if "joined" in robot:
        click.echo(
            f"  {robot['groups']} groups of publishes, {robot['joined']} reads joined others, "
            f"{robot['waiting']} requests wait"
        )
