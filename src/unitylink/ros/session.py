# SPDX-License-Identifier: BSD-3-Clause
"""The work of a node on an open link: the robot's values, its dead-man, incoming commands and outgoing
publishes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from unitylink.errors import BindingError, DeviceMismatch, LinkError
from unitylink.layer4_data import Node, ValueGroup

from .dead_man import DeadManGuard
from .inbox import Inbox
from .interface import Interface, Topic
from .outbox import Outbox
from .plane import Plane, Port
from .senders import Send
from .sim_clock import SimClock

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


@dataclass(frozen=True)
class SessionNeeds:
    """What a session gets from its node: the robot, where messages go, and who learns of changes."""

    interface: Interface
    plane: Plane
    senders: Sequence[tuple[Topic, Send]]
    deadman_s: float
    command_timeout_s: float
    armed: Callable[[], bool]
    complain: Callable[[str], None]
    looked_after: Callable[[RobotSession], None]  # called each time the keeper checks the session
    ended: Callable[[RobotSession], None]
    speed: float = 1.0
    clock_port: Callable[[], Port] | None = None  # None: no time is told


class RobotSession:
    """A robot on one link, from its first connection on. The line may be lost and come back.

    `again` means that this node had another link before. Then the device is made safe first.
    """

    def __init__(self, needs: SessionNeeds, link: Link, tree: Node, *, again: bool) -> None:
        self.link, self.tree = link, tree
        self._needs, self._say = needs, needs.plane.say
        values = {value.path: value for value in tree}
        missing = [path for topic in needs.interface.published for path in topic.paths if path not in values]
        if missing:
            raise BindingError(
                f"{needs.interface.package}: the robot has no {missing[0]}; generate both again"
            )
        if link.notice:
            self._say(1, link.notice)
        if link.unverified:
            self._say(1, f"the gateware is not verified: {link.unverified}")
        self.guard = DeadManGuard(link, needs.deadman_s, safe=bool(self.said_safe()))
        self._make_fit(again)
        if self.guard.lacking and not again and any(value.writable for value in tree):
            self._say(0, self.guard.lacking)
        self.outbox = Outbox(tree, needs.senders, needs.plane.gathered, needs.plane.life)
        group = ValueGroup({path: v for path, v in values.items() if v.writable}, needs.interface.robot)
        self.inbox = Inbox(
            group,
            needs.complain,
            timeout_s=needs.command_timeout_s,
            on_silence=self._silent,
            current=self._current,
            life=needs.plane.life,
        )
        self._clock: SimClock | None = None
        try:
            tree.start_publishing(fallback=True)
            if link.in_steps and needs.clock_port is not None:
                self._clock = SimClock(link, needs.plane, needs.clock_port(), needs.speed)
                self._clock.start()
            if not link.in_steps:  # there a second of the board may be over in no time
                with suppress(DeviceMismatch):  # mapped memory has no line
                    link.watch_program(needs.plane.life.patience_s)
        except BaseException:
            self.close()
            raise

    def said_safe(self) -> str:
        """Return a sentence about the SAFE values that are written, or "" if the spec has none."""
        names = [v.path for v in self.tree if v.quantity.safe is not None and v.writable]
        return f"safe values written: {', '.join(names)}" if names else ""

    def _make_fit(self, old: bool) -> None:
        """If the node is armed, arm gateware whose dead-man has tripped. Then write the safe values."""
        if self.guard.tripped and self._needs.armed():
            self.guard.arm()
            self._say(1, "the dead-man had tripped and made the outputs safe; they are armed again")
        self._generation = self.link.generation  # after a loss from here on, everything is done again
        if self.guard.tripped:
            self._say(1, "the dead-man has tripped: the outputs are safe until the service arm is called")
        elif old:  # first of all, because commands from before the loss are old
            self.tree.apply_safe()
            said = self.said_safe() or "the spec gives no SAFE values, so its outputs stay as they are"
            self._say(1, f"the device is back; {said}; earlier commands are dropped")

    # Called by the keeper

    def forget(self) -> None:
        self.inbox.forget()

    def stale(self) -> bool:
        self._needs.looked_after(self)
        return not self._current() or self.guard.has_tripped()

    def renew(self) -> None:
        self.guard.renew()
        self.inbox.forget()
        self._make_fit(True)

    def close(self) -> None:
        if self._clock is not None:
            self._clock.close()
        self._needs.ended(self)
        self.outbox.close()
        self.inbox.close()
        with suppress(LinkError):
            self.tree.stop_publishing()

    # Called by the inbox

    def _current(self) -> bool:
        """Whether the device is still the one that was made ready, and holds what was written since."""
        return self.link.generation == self._generation and self.link.up

    def _silent(self) -> None:
        self._needs.complain("no command came for command_timeout_s: the safe values are written")
        try:
            self.tree.apply_safe()
        except LinkError as error:
            self._needs.complain(f"the safe values were not written: {error}")
