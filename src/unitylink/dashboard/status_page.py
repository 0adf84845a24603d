# SPDX-License-Identifier: BSD-3-Clause
"""The status page of a server: what it serves, who is there, who may write, and what has been counted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

EACH_S = 2  # a browser asks again after so many seconds
_COUNTED = ("requests", "refused", "repeats", "discarded", "publishes", "publishes_lost")


def status_page(report: Mapping[str, Any], user: str) -> str:
    """Return the page for the report of `Server.report()`. It is whole without a script or a style.

    >>> arm = {"name": "arm", "link": "tcp://a:1", "away": "<no cable>", "stopped_by": ""}
    >>> arm |= {"leases": [], "wishes": []}
    >>> page = status_page({"refused": 1, "turned_away": 0, "log_lines_lost": 0, "robots": [arm]}, "ann")
    >>> "<h2>arm</h2>" in page, "away: &lt;no cable&gt;" in page
    (True, True)
    """
    parts = [
        "<!DOCTYPE html>",
        '<html lang="en"><head><meta charset="utf-8"><title>Unity-Link status</title>',
        f'<meta http-equiv="refresh" content="{EACH_S}">',
        '<meta name="color-scheme" content="light dark">',
        '<meta name="viewport" content="width=device-width, initial-scale=1"></head><body>',
        f'<h1>Status</h1><p>You are {escape(user)}. <a href="/">the robot</a></p>',
    ]
    for robot in report["robots"]:
        parts += _robot(robot)
    parts += _table(
        "This server has",
        ("what", "how often"),
        [
            ("refused callers with a wrong login", report["refused"]),
            ("turned away callers without a login", report["turned_away"]),
            ("lost lines of its log", report["log_lines_lost"]),
        ],
    )
    return "\n".join([*parts, "</body></html>", ""])


def _robot(robot: Mapping[str, Any]) -> Iterator[str]:
    yield f"<h2>{escape(robot['name'])}</h2>"
    state = f"away: {robot['away']}" if robot["away"] else "up"
    yield f"<p>{escape(robot['link'])}, {escape(state)}</p>"
    if robot["stopped_by"]:
        yield f"<p><strong>stopped by {escape(robot['stopped_by'])}</strong></p>"
    holders = [
        (lease["part"], lease["holder"], lease["where"], f"being made safe: {ending}" if ending else "")
        for lease in robot["leases"]
        for ending in [lease["ending"]]
    ]
    yield from _table("Who writes", ("part", "user", "from", "state"), holders)
    wishes = [
        (wish["part"], wish["user"], "kept" if wish["kept"] else "", f"{wish['left_s']:.0f} s")
        for wish in robot["wishes"]
    ]
    yield from _table("Who wants to write", ("part", "user", "kept for this user", "for"), wishes)
    clients = [
        (
            client["name"],
            client["where"],
            f"{client['age_s']:.0f} s",
            f"{client['silent_s']:.3g} s",
            "yes" if client["dead_man"] else "",
            *(client[name] for name in _COUNTED),
        )
        for client in robot.get("clients", [])
    ]
    counted = [name.replace("_", " ") for name in _COUNTED]
    yield from _table("Programs", ("user", "from", "here for", "silent for", "dead-man", *counted), clients)
    if statistics := robot.get("statistics"):
        yield from _table("The link", ("what", "value"), sorted(statistics.items()))


def _table(caption: str, head: tuple[str, ...], rows: list[tuple[Any, ...]]) -> Iterator[str]:
    if not rows:
        yield f"<p>{escape(caption)}: nobody</p>"
        return
    yield f"<table><caption>{escape(caption)}</caption>"
    for cell, row in [("th", head), *(("td", row) for row in rows)]:
        yield "<tr>" + "".join(f"<{cell}>{escape(str(value))}</{cell}>" for value in row) + "</tr>"
    yield "</table>"
