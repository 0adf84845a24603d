# SPDX-License-Identifier: BSD-3-Clause
"""The state of a robot's link, for diagnostic_msgs."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from unitylink.errors import LinkError

from .plane import Plane

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .session import RobotSession

OK, WARN, ERROR = 0, 1, 2
STATUS = ("level", "name", "message", "hardware_id", "values")


@dataclass(frozen=True)
class Health:
    """A level of diagnostic_msgs, a sentence, and counters."""

    level: int
    message: str
    hardware: str
    facts: dict[str, str]


@dataclass(frozen=True)
class NodeState:
    """The state of a node: counters, whether it takes commands, and a sentence."""

    accepted: int
    refused: int
    losses: int
    armed: bool
    hanging: bool
    text: str


def health(node: NodeState, session: RobotSession | None) -> Health:
    """Return the health of a node.

    It is an error without a link or while a thread hangs. It is a warning while commands are refused or fail.
    """
    facts = {
        "commands accepted": str(node.accepted),
        "commands refused": str(node.refused),
        "links lost": str(node.losses),
        "armed": str(node.armed).lower(),
    }
    if session is None or node.hanging:
        return Health(ERROR, node.text, "", facts)
    link, inbox = session.link, session.inbox
    facts |= {
        "gateware": f"not verified: {link.unverified}" if link.unverified else "verified",
        "dead-man": session.guard.told(),
        "publishes taken": str(session.outbox.received),
        "publishes lost": str(sum(report.lost for report in session.tree.publisher.reports())),
        "writes": str(inbox.writes),
        "writes failed": str(inbox.failed),
    }
    statistics = link.statistics()
    facts |= {
        f"link {f.name.replace('_', ' ')}": str(getattr(statistics, f.name)) for f in fields(statistics)
    }
    facts |= _device_facts(link)
    level = OK
    message = node.text
    if session.guard.tripped:
        level, message = WARN, f"{message}; the dead-man has tripped"
    if not node.armed:
        level, message = WARN, f"{message}; not armed"
    if inbox.failed or node.refused:
        level, message = WARN, f"{message}; {node.refused} commands refused, {inbox.failed} writes failed"
    return Health(level, message, link.url, facts)


def _device_facts(link: Link) -> dict[str, str]:
    """The device's own counters, and the state of its clock. It is empty on a classic link."""
    facts = {}
    clock = link.clock
    if clock is not None:
        facts["device clock drift ppm"] = f"{clock.drift_ppm:.1f}"
        facts["device clock uncertainty us"] = f"{clock.uncertainty_ns / 1000:.0f}"
    try:
        counted = link.health()
    except LinkError as error:  # the keeper will report the cause
        return facts | {"device": str(error)}
    if counted is not None:
        facts |= {
            f"device {f.name.replace('_', ' ')}": str(getattr(counted, f.name)) for f in fields(counted)
        }
    return facts


def diagnostics(plane: Plane, name: str, found: Health, time_s: float) -> object:
    """Return a diagnostic_msgs/DiagnosticArray."""
    pair = plane.maker("diagnostic_msgs/KeyValue", ("key", "value"))
    status = plane.maker("diagnostic_msgs/DiagnosticStatus", STATUS)(
        plane.level(found.level),
        f"{name}: Unity-Link",
        found.message,
        found.hardware,
        [pair(key, value) for key, value in found.facts.items()],
    )
    return plane.maker("diagnostic_msgs/DiagnosticArray", ("header", "status"))(
        plane.header(time_s, ""), [status]
    )
