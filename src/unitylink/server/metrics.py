# SPDX-License-Identifier: BSD-3-Clause
"""The state of a server as text for Prometheus."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any

_CLIENT_COUNTERS = ("requests", "refused", "repeats", "discarded", "publishes", "publishes_lost")
_BOARD_COUNTERS = ("trips", "dropped_silent", "dropped_lost", "served", "joined")


def metrics(report: Mapping[str, Any]) -> str:
    """Return the metrics of `Server.report()`, in the text format of Prometheus.

    >>> arm = {"name": "arm", "away": "", "leases": []}
    >>> print(metrics({"refused": 1, "turned_away": 0, "log_lines_lost": 0, "robots": [arm]}), end="")
    # TYPE unitylink_server_refused_total counter
    unitylink_server_refused_total 1
    # TYPE unitylink_server_turned_away_total counter
    unitylink_server_turned_away_total 0
    # TYPE unitylink_server_log_lines_lost_total counter
    unitylink_server_log_lines_lost_total 0
    # TYPE unitylink_board_up gauge
    unitylink_board_up{board="arm"} 1
    # TYPE unitylink_board_leases gauge
    unitylink_board_leases{board="arm"} 0
    # TYPE unitylink_board_clients gauge
    unitylink_board_clients{board="arm"} 0
    """
    families: dict[tuple[str, str], list[str]] = {}
    for name, kind, labels, value in _samples(report):
        said = ",".join(f'{key}="{_quoted(str(text))}"' for key, text in labels.items())
        families.setdefault((name, kind), []).append(
            f"{name}{{{said}}} {value}" if said else f"{name} {value}"
        )
    lines = []
    for (name, kind), samples in families.items():
        lines += [f"# TYPE {name} {kind}", *samples]
    return "\n".join(lines) + "\n"


def write_metrics(path: str, report: Mapping[str, Any]) -> None:
    """Write the metrics to a file, whole or not at all: the textfile collector of node_exporter reads it."""
    part = f"{path}.part"
    with open(part, "w", encoding="utf-8") as file:
        file.write(metrics(report))
    os.replace(part, path)


def _samples(report: Mapping[str, Any]) -> Iterator[tuple[str, str, dict[str, object], int]]:
    yield "unitylink_server_refused_total", "counter", {}, report["refused"]
    yield "unitylink_server_turned_away_total", "counter", {}, report["turned_away"]
    yield "unitylink_server_log_lines_lost_total", "counter", {}, report["log_lines_lost"]
    for robot in report["robots"]:
        board = {"board": robot["name"]}
        clients = robot.get("clients", [])
        yield "unitylink_board_up", "gauge", board, 0 if robot["away"] else 1
        yield "unitylink_board_leases", "gauge", board, len(robot["leases"])
        yield "unitylink_board_clients", "gauge", board, len(clients)
        for name in _BOARD_COUNTERS:
            if name in robot:
                yield f"unitylink_board_{name}_total", "counter", board, robot[name]
        for name, value in robot.get("statistics", {}).items():
            yield f"unitylink_link_{name}_total", "counter", board, value
        for client in clients:
            who = {**board, "user": client["name"], "client": client["id"]}
            for name in _CLIENT_COUNTERS:
                yield f"unitylink_client_{name}_total", "counter", who, client[name]


def _quoted(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
