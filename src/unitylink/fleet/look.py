# SPDX-License-Identifier: BSD-3-Clause
"""One look at a fleet from anywhere on its network."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkNotFound
from unitylink.zenoh.session import Network

from .description import Fleet
from .report import RobotReport, report_of
from .roll_call import RollCall, told_by
from .supervisor import state_key

if TYPE_CHECKING:
    import zenoh

ANSWER_S = 2.0  # how long a bridge has to tell its state
_EACH_S = 0.5  # how long one question waits for the program that runs the fleet; then it is asked again
_TOKENS_S = 1.0  # how long the tokens have to come; they come at once where all is well
_STEP_S = 0.02
_PAUSE_S = 0.2  # between two attempts to reach the router


def look_at(fleet: Fleet, wait_s: float = 0.0, *, who: str = "") -> tuple[bool, list[RobotReport]]:
    """Return whether a program runs the fleet, and what the network tells of each robot.

    It waits up to `wait_s` for robots that are not there. Raises LinkNotFound if no router answers.
    """
    limit_s = time.monotonic() + max(wait_s, _TOKENS_S)
    with _opened(fleet.network(who), limit_s if wait_s else 0.0) as session:
        call = RollCall(session, [robot.key for robot in fleet.robots])
        while time.monotonic() < limit_s and not all(call.of(one.key).reachable for one in fleet.robots):
            time.sleep(_STEP_S)
        told = _told(session, fleet.name, limit_s)
        call.ask_and_wait(ANSWER_S)
        processes = told.get("robots")
        rows = processes.items() if isinstance(processes, dict) else ()
        of = {name: row for name, row in rows if isinstance(row, dict)}  # anybody may have told it
        reports = [report_of(one, call.of(one.key), of.get(one.name)) for one in fleet.robots]
        call.close()
    return bool(told), reports


def _opened(network: Network, limit_s: float) -> zenoh.Session:
    """Open a session. Wait for the router until `limit_s`, by the monotonic clock."""
    while True:
        try:
            return network.opened()
        except LinkNotFound:
            if time.monotonic() > limit_s:
                raise
            time.sleep(_PAUSE_S)


def _told(session: zenoh.Session, name: str, limit_s: float) -> dict[str, Any]:
    """Return what the program that runs the fleet tells, or nothing.

    It is asked until `limit_s`, by the monotonic clock: on a network that was just made, a question may find
    no way to it. One that is there and does not answer has ANSWER_S.
    """
    silent_s = time.monotonic() + ANSWER_S
    while True:
        asked_s = time.monotonic()
        for reply in session.get(state_key(name), timeout=_EACH_S):
            if (told := told_by(reply)) is not None:
                return told
        now_s = time.monotonic()
        there = now_s - asked_s >= _EACH_S  # a question to nobody is over at once
        if now_s >= (max(limit_s, silent_s) if there else limit_s):
            return {}
        time.sleep(_STEP_S)
