# SPDX-License-Identifier: BSD-3-Clause
"""Whether the robots of a fleet are as their description says. No I/O."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from .report import RobotReport

AWAY, SPEC, GATEWARE, UNKNOWN = "away", "spec", "gateware", "unknown"


@dataclass(frozen=True)
class Difference:
    """What is not as described. `counts` tells whether it is a fault."""

    robot: str
    kind: str
    text: str

    @property
    def counts(self) -> bool:
        return self.kind != UNKNOWN


def differences(wanted: Mapping[str, str], reports: Sequence[RobotReport]) -> list[Difference]:
    """Return what differs. `wanted` is the hash of the spec that the file of each robot has now."""
    return [one for report in reports for one in _of(report, wanted[report.name])]


def _of(report: RobotReport, wanted: str) -> Iterator[Difference]:
    if not report.reachable:
        yield Difference(report.name, AWAY, report.state)
    if not report.hash:
        if report.reachable:
            yield Difference(report.name, AWAY, "its bridge does not tell its state")
        return
    if report.hash != wanted:
        text = f"runs with the spec {report.hash}, and {report.spec} is {wanted} now: unitylink fleet update"
        yield Difference(report.name, SPEC, text)
    if report.reachable and not report.gateware_hash:
        yield Difference(report.name, UNKNOWN, "its gateware does not know from which spec it was built")
    elif report.gateware_hash and report.gateware_hash != report.hash:
        text = f"its gateware was built from {report.gateware_hash}, and it runs with {report.hash}: flash it"
        yield Difference(report.name, GATEWARE, text)
