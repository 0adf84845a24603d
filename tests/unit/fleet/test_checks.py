# SPDX-License-Identifier: BSD-3-Clause
"""What is told of a robot, and how it differs from its description."""

from __future__ import annotations

import json
from typing import Any

import pytest

from unitylink.fleet.checks import differences
from unitylink.fleet.description import FleetRobot
from unitylink.fleet.report import RobotReport, report_of
from unitylink.fleet.roll_call import Presence

ROBOT = FleetRobot("arm1", "tcp://10.0.0.1:5555", "arm.ul", "lab/arm1")
STATE: dict[str, Any] = {
    "bridge": "b",
    "hash": "aa" * 8,
    "away": "",
    "device": {"hash": "aa" * 8},
    "statistics": {"missing_publishes": 2, "overruns": 1, "timeouts": 4, "requests": 99},
    "refused": {"value": {"count": 3, "last": "NaN"}, "access": {"count": 1, "last": ""}},
    "clients": [{"name": "ana"}],
    "published": 7,
}


def there(**more: Any) -> Presence:
    return Presence({"b"}, {"b"}, {"j1": "ana", "j2": "ana"}, {**STATE, **more})


def test_a_report_has_what_the_network_and_the_process_tell() -> None:
    report = report_of(ROBOT, there(), {"restarts": 5, "pid": 12, "uptime_s": 3.5, "spec": "arm.ul"})
    assert (report.reachable, report.lost, report.refused, report.clients) == (True, 7, 4, 1)
    assert report.row() == ("arm1", "up", "aaaaaaaa", "aaaaaaaa", "7", "ana", "5")
    assert report_of(ROBOT, there(stopped_by="ben"), None).state == "stopped by ben"


@pytest.mark.parametrize(
    ("presence", "process", "state"),
    [
        (Presence({"b"}, set(), {}, {"away": "no port", "bridge": "b"}), {"pid": 1}, "board away: no port"),
        (Presence({"b"}, {"other"}), None, "board away"),
        (Presence(), {"pid": 1, "uptime_s": 59.0}, "starting"),
        (Presence(), {"pid": 1, "uptime_s": 61.0}, "not seen on the network"),
        (Presence(), {"pid": None, "trouble": "ended with code 3"}, "down: ended with code 3"),
        (Presence(set(), {"b"}, {}, STATE), None, "down"),
    ],
)
def test_a_robot_that_is_not_there_says_why(presence: Presence, process: Any, state: str) -> None:
    report = report_of(ROBOT, presence, process)
    assert (report.reachable, report.state) == (False, state)


@pytest.mark.parametrize(
    "told", [{"refused": 3}, {"device": []}, {"clients": 1, "statistics": {"timeouts": "x"}}]
)
def test_a_state_that_is_no_state_is_no_error(told: dict[str, Any]) -> None:
    report = report_of(ROBOT, Presence({"b"}, {"b"}, {}, {"bridge": "b", **told}), None)
    assert report.reachable and report.lost == report.refused == report.clients == 0


@pytest.mark.parametrize("bridge", [[], {}, None, 3])
def test_a_state_of_no_bridge_is_not_known_and_that_counts(bridge: object) -> None:
    presence = Presence({"b"}, {"b"}, {}, {"bridge": bridge, "hash": "aa" * 8})
    report = report_of(ROBOT, presence, None)
    assert not presence.known and report.hash == ""
    (found,) = differences({"arm1": "aa" * 8}, [report])
    assert found.counts and found.text == "its bridge does not tell its state"


@pytest.mark.parametrize("hostile", ["x", None, [], {}, -1, float("nan"), float("inf"), 10**400])
def test_what_a_stranger_tells_of_a_process_is_no_error(hostile: Any) -> None:
    told = {"restarts": hostile, "pid": hostile, "uptime_s": hostile, "trouble": hostile, "spec": hostile}
    report = report_of(ROBOT, Presence(), told)
    assert report.uptime_s == 0 and not report.reachable
    assert all(cell.isprintable() for cell in report.row())


def test_a_text_from_the_network_cannot_write_to_the_terminal_nor_break_a_line() -> None:
    presence = there(hash="\x1b[2J\ud800", stopped_by="a\nb", device={"hash": "\x07"})
    presence.leases["\x1b"] = "\x1b]0;x"
    report = report_of(ROBOT, presence, {"trouble": "\x1b[31m"})
    json.dumps(report.as_dict(), ensure_ascii=False).encode()
    assert all(cell.isprintable() for cell in report.row()) and report.trouble == "?[31m"


def found(wanted: str, **more: Any) -> list[tuple[str, bool]]:
    reports: list[RobotReport] = [report_of(ROBOT, there(**more), None)]
    return [(one.kind, one.counts) for one in differences({"arm1": wanted}, reports)]


def test_the_state_of_a_bridge_that_is_gone_counts_no_more() -> None:
    report = report_of(ROBOT, Presence({"new"}, {"new"}, {}, STATE), None)
    assert (report.state, report.hash, report.lost) == ("up", "", 0)


def test_differences() -> None:
    assert found("aa" * 8) == []
    assert found("bb" * 8) == [("spec", True)]
    assert found("aa" * 8, device={"hash": "bb" * 8}) == [("gateware", True)]
    assert found("aa" * 8, device={}) == [("unknown", False)]
    away = differences({"arm1": "aa" * 8}, [report_of(ROBOT, Presence(), None)])
    assert [(one.kind, one.text, one.counts) for one in away] == [("away", "down", True)]
