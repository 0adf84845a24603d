# SPDX-License-Identifier: BSD-3-Clause
"""Brings the robots of a running fleet to what its file says now, one by one, up to one that is unwell."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from unitylink.errors import FleetError

from .description import Fleet, FleetRobot
from .report import RobotReport
from .supervisor import Supervisor

WITHIN_S = 30.0  # how long a robot has to be well
SETTLE_S = 2.0  # how long it has to stay well
_STEP_S = 0.05


@dataclass(frozen=True)
class Step:
    """One robot that differs: how it is to be, and the hash that its spec then has."""

    robot: FleetRobot
    hash: str


class Rollout:
    """One update. `say` gets what happens, with the name of the robot."""

    def __init__(
        self,
        supervisor: Supervisor,
        say: Callable[[str, str], None],
        *,
        settle_s: float = SETTLE_S,
        within_s: float = WITHIN_S,
    ) -> None:
        self._supervisor, self._say = supervisor, say
        self._settle_s, self._within_s = settle_s, within_s

    def run(self, wanted: Fleet, only: Sequence[str] = (), *, force: bool = False) -> bool:
        """Bring the robots to what `wanted` says. Return whether all are well.

        `only` names the robots to begin with; without it all that differ. Robots that somebody writes or has
        stopped are left alone, except with `force`. Raises FleetError for what needs a new start of the
        fleet.
        """
        steps = self._steps(wanted, only)
        if not steps:
            self._say(wanted.name, "all robots are as the file says")
        for number, step in enumerate(steps, 1):
            name = step.robot.name
            if (stopper := self._report(name).stopped_by) and not force:
                self._say(
                    name, f"is stopped by {stopper}, which would end with its bridge; the update stops here"
                )
                self._say(name, "arm it first (link.arm()), or go on with --force")
                return False
            holders = self._report(name).leases or {}
            if holders and not force:
                whose = ", ".join(f"{part} by {holder}" for part, holder in holders.items())
                self._say(name, f"is written: {whose}; the update stops here; --force goes on")
                return False
            if not self._step(step, f"{number} of {len(steps)}"):
                left = [one.robot.name for one in steps[number:]]
                self._say(wanted.name, f"the update stops here; as before: {', '.join([name, *left])}")
                return False
        return True

    def _steps(self, wanted: Fleet, only: Sequence[str]) -> list[Step]:
        now = self._supervisor.robots
        new = {robot.name: robot for robot in wanted.robots}
        if set(new) != set(now) or any(new[name].key != now[name].key for name in now):
            raise FleetError(
                f"{wanted.file}: other robots or keys than before; end the fleet and start it anew"
            )
        if unknown := [name for name in only if name not in new]:
            raise FleetError(f"{wanted.file}: no robot {unknown[0]}; there are {', '.join(new)}")
        return [
            Step(robot, self._supervisor.wanted_hash(robot))
            for name, robot in new.items()
            if (not only or name in only) and self._supervisor.differs(robot)
        ]

    def _step(self, step: Step, which: str) -> bool:
        name, before = step.robot.name, self._supervisor.robots[step.robot.name]
        old_hash = self._report(name).hash
        old = self._supervisor.change(step.robot)
        self._say(name, f"{which}: from the spec {old_hash or 'unknown'} to {step.hash}")
        unwell = self._unwell(name, step.hash)
        if not unwell:
            self._say(name, "is well")
            return True
        self._say(name, f"is unwell, and goes back: {unwell}")
        self._supervisor.change_back(before, old)
        still = self._unwell(name, old_hash)
        self._say(name, "is as before" if not still else f"is unwell with what it had before, too: {still}")
        return False

    def _unwell(self, name: str, wanted: str) -> str:
        """Wait until a robot has been well for a while. Return why it is not, or an empty text."""
        limit_s = time.monotonic() + self._within_s
        since_s = None
        restarts = self._report(name).restarts
        while time.monotonic() < limit_s:
            report = self._report(name)
            if report.restarts != restarts:
                return report.trouble or "its bridge ended"
            why = _why(report, wanted)
            if why:
                since_s = None
            elif since_s is None:
                since_s = time.monotonic()
            elif time.monotonic() - since_s >= self._settle_s:
                return ""
            time.sleep(_STEP_S)
        return why or "it was not well for long enough"

    def _report(self, name: str) -> RobotReport:
        return next(one for one in self._supervisor.reports() if one.name == name)


def _why(report: RobotReport, wanted: str) -> str:
    if not report.reachable:
        return report.state
    if not report.hash:
        return "its bridge has not told its state"
    if wanted and report.hash != wanted:
        return f"it has the spec {report.hash}"
    if report.gateware_hash not in ("", report.hash):
        return f"its gateware was built from {report.gateware_hash}"
    return ""
