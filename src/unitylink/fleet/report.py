# SPDX-License-Identifier: BSD-3-Clause
"""What is known of one robot at one moment, as a row for people and as plain values for programs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from .bridge_process import START_S
from .description import FleetRobot

if TYPE_CHECKING:
    from .roll_call import Presence

HEADERS = ("robot", "state", "spec", "gateware", "lost", "written by", "restarts")
RIGHT = (4, 6)  # the columns that are numbers
_TEXT_MOST = 1000  # characters
_HASH_SHOWN = 8  # hex digits of a hash in a table


@dataclass(frozen=True)
class RobotReport:
    """One robot. Hashes have 16 hex digits; `gateware_hash` is empty if the board does not know it."""

    name: str
    key: str
    link: str
    reachable: bool
    state: str  # "up", or why it is not
    spec: str = ""
    hash: str = ""
    gateware_hash: str = ""
    lost: int = 0  # publishes that were lost on the line, and requests without an answer
    refused: int = 0
    published: int = 0
    leases: Mapping[str, str] | None = None  # part: holder
    clients: int = 0
    restarts: int | None = None  # None: no program that runs the fleet tells it
    pid: int | None = None
    uptime_s: float = 0.0
    trouble: str = ""
    stopped_by: str = ""  # an update leaves such a robot alone

    def row(self) -> tuple[str, ...]:
        """Return the cells below `HEADERS`."""
        leases = self.leases or {}
        holders = list(dict.fromkeys(leases.values()))
        return (
            self.name,
            self.state,
            self.hash[:_HASH_SHOWN] or "-",
            self.gateware_hash[:_HASH_SHOWN] or "-",
            str(self.lost),
            ", ".join(holders) or "-",
            "-" if self.restarts is None else str(self.restarts),
        )

    def as_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return asdict(self)


def report_of(robot: FleetRobot, presence: Presence, process: Mapping[str, Any] | None) -> RobotReport:
    """Return what is known of a robot.

    `process` is what the program that runs the fleet tells of its bridge: restarts, pid, uptime_s, trouble,
    spec. It is None if nobody tells. Anybody on an open network can tell anything.
    """
    told = presence.state if presence.known else {}
    device = _table(told.get("device"))
    line = _table(told.get("statistics"))
    own = process or {}
    return RobotReport(
        robot.name,
        robot.key,
        robot.link,
        presence.reachable,
        _text(_state(presence, told, own)),
        spec=_text(own.get("spec") or robot.spec),
        hash=_text(told.get("hash", "")),
        gateware_hash=_text(device.get("hash", "")),
        lost=sum(_count(line.get(name)) for name in ("missing_publishes", "overruns", "timeouts")),
        refused=sum(_count(_table(one).get("count")) for one in _table(told.get("refused")).values()),
        published=_count(told.get("published")),
        leases={_text(part): _text(holder) for part, holder in presence.leases.items()},
        clients=len(told["clients"]) if isinstance(told.get("clients"), list) else 0,
        restarts=_count(own.get("restarts")) if process is not None else None,
        pid=_count(own.get("pid")) or None,
        uptime_s=_seconds(own.get("uptime_s")),
        trouble=_text(own.get("trouble", "")),
        stopped_by=_text(told.get("stopped_by") or ""),
    )


def _state(presence: Presence, told: Mapping[str, Any], process: Mapping[str, Any]) -> str:
    if presence.reachable:
        return "up" if not told.get("stopped_by") else f"stopped by {told['stopped_by']}"
    if presence.bridges:
        return f"board away: {told['away']}" if told.get("away") else "board away"
    if process.get("pid"):
        return "starting" if _seconds(process.get("uptime_s")) < START_S else "not seen on the network"
    return f"down: {process['trouble']}" if process.get("trouble") else "down"


def _table(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _text(value: object) -> str:
    """Return a text that a terminal shows as it is, and a file takes."""
    return "".join(one if one.isprintable() else "?" for one in str(value)[:_TEXT_MOST])


def _seconds(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) and 0 <= value < 1e12 else 0.0


def _count(value: object) -> int:
    return value if isinstance(value, int) and value >= 0 else 0
