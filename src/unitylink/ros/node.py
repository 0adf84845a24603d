# SPDX-License-Identifier: BSD-3-Clause
"""The node behind every front end: topics on one side, a link that may come and go on the other."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from unitylink.errors import BindingError, LinkError, UnityLinkError, ValueRangeError
from unitylink.layer4_data import Node, ValueGroup

from .dead_man import DeadManGuard
from .health import Health, health
from .inbox import Inbox
from .interface import Interface, Topic
from .keeper import LinkKeeper
from .outbox import Outbox
from .plane import READ, SET_BOOL, TRIGGER, WRITE, Plane
from .receivers import Read, receiver
from .senders import Send, sender
from .values import read_values, write_values

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

COMPLAIN_EVERY_S = 1.0


@dataclass(frozen=True)
class Options:
    """What a user sets: `command_timeout_s` without a command makes the robot safe (0: never); `deadman_s`
    without a sign of life from the node makes the gateware do so by itself (0: never); `safe_at_exit`
    writes the safe values when the node ends; `armed` False takes no commands before `arm` was called."""

    command_timeout_s: float = 0.0
    deadman_s: float = 1.0
    safe_at_exit: bool = True
    armed: bool = True
    retry_s: float = 1.0


class RobotNode:
    """Connect a robot to a plane of messages, from construction until `close`.

    `connect()` opens the link and `build(link)` makes the robot's values on it. Raises nothing when there is
    no device: the node waits for it, and says so.
    """

    def __init__(
        self,
        interface: Interface,
        plane: Plane,
        connect: Callable[[], Link],
        build: Callable[[Link], Node],
        options: Options | None = None,
        *,
        services: bool = True,
    ) -> None:
        self.interface = interface
        self.options = options if options is not None else Options()
        self.armed = self.options.armed
        self.accepted = self.refused = 0
        self._plane = plane
        self.gathered = plane.gathered
        self._build = build
        self._session: _Session | None = None
        self._complained_s = 0.0
        self._lock = threading.Lock()
        self.senders: Sequence[tuple[Topic, Send]] = [
            (topic, sender(interface, topic, plane)) for topic in interface.published
        ]
        # before the first subscription, whose messages ask it how it stands
        self.keeper = LinkKeeper(connect, self._begin, plane.say, retry_s=self.options.retry_s)
        for topic in interface.commanded:
            plane.subscribe(topic, self._taker(receiver(interface, topic)))
        plane.serve("set_safe", TRIGGER, self.set_safe)
        plane.serve("arm", SET_BOOL, self.arm)
        if services:  # their types are those of a generated package
            plane.serve("read", READ, self.read)
            plane.serve("write", WRITE, self.write)

    # What the link brings

    def _begin(self, link: Link, again: bool) -> _Session:
        tree = self._build(link)
        if link.unverified:
            self._plane.say(1, f"the gateware is not verified: {link.unverified}")
        values = {value.path: value for value in tree}
        missing = [path for t in self.interface.published for path in t.paths if path not in values]
        if missing:
            raise BindingError(
                f"{self.interface.package}: the robot has no {missing[0]}; generate both again"
            )
        guard = DeadManGuard(link, self.options.deadman_s, safe=bool(_said_safe(tree)))
        if guard.tripped and self.armed:
            guard.arm()
            self._plane.say(1, "the dead-man had tripped and made the outputs safe; they are armed again")
        if guard.tripped:
            self._plane.say(
                1, "the dead-man has tripped: the outputs are safe until the service arm is called"
            )
        elif again:  # before anything else: what it was told before the loss is old
            tree.apply_safe()
            said = _said_safe(tree) or "the spec gives no SAFE values, so its outputs stay as they are"
            self._plane.say(1, f"the device is back; {said}; commands of before are forgotten")
        elif guard.lacking and any(value.writable for value in tree):
            self._plane.say(0, guard.lacking)
        session = _Session(self, link, tree, guard)
        try:
            tree.start_publishing(fallback=True)
        except BaseException:
            session.close()
            raise
        self._session = session
        return session

    def forget(self, session: _Session) -> None:
        if self._session is session:
            self._session = None

    # What ROS brings

    def _taker(self, read: Read) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            session = self._session
            try:
                if session is None:
                    raise ValueRangeError(f"a command was not taken: {self.keeper.state}")
                if not self.armed:
                    raise ValueRangeError("a command was not taken: the robot is not armed (service arm)")
                session.inbox.put(read(message))
                self.accepted += 1
            except UnityLinkError as error:
                self.refused += 1
                self.complain(str(error))

        return take

    def complain(self, message: str) -> None:
        """Warn, at most once a second: a stream of wrong commands must not become a stream of warnings."""
        with self._lock:
            now = time.monotonic()
            if now - self._complained_s < COMPLAIN_EVERY_S:
                return
            self._complained_s = now
        self._plane.say(1, message)

    def _with(self, action: Callable[[_Session], str]) -> tuple[bool, str]:
        session = self._session
        if session is None:
            return False, self.keeper.state
        try:
            return True, action(session)
        except UnityLinkError as error:
            return False, str(error)

    def set_safe(self) -> tuple[bool, str]:
        """Write the safe values, and forget the commands that wait."""

        def act(session: _Session) -> str:
            session.inbox.clear()
            if session.guard.tripped:
                return "the outputs are safe already: the dead-man has tripped"
            session.tree.apply_safe()
            return _said_safe(session.tree) or "the spec gives no SAFE values; nothing was written"

        return self._with(act)

    def arm(self, on: bool) -> tuple[bool, str]:
        """Take commands from now on; without `on` take none any more, and write the safe values."""
        if on:
            session = self._session
            if session is not None:
                try:
                    session.guard.arm()
                except UnityLinkError as error:
                    return False, str(error)
            self.armed = True
            return True, "armed: commands are taken"
        self.armed = False
        done, message = self.set_safe()
        return done, f"disarmed: no commands are taken; {message}"

    def read(self, names: Sequence[str]) -> tuple[bool, str, list[float], list[str]]:
        """Read values by their paths in the spec, `j1.cpos`."""
        values: list[float] = []
        texts: list[str] = []
        done, message = self._with(lambda session: read_values(session.tree, names, values, texts))
        return (True, message, values, texts) if done else (False, message, [], [])

    def write(self, names: Sequence[str], values: Sequence[float]) -> tuple[bool, str]:
        """Write values by their paths; where it is armed."""
        if not self.armed:
            return False, "the robot is not armed (service arm); nothing was written"
        return self._with(lambda session: write_values(session.tree, names, values))

    # How it does

    def health(self) -> Health:
        session = self._session
        return health(self, session.link if session is not None else None, session)

    def close(self) -> None:
        """End the link; before that write the safe values, if the options say so and a command had come."""
        session = self._session
        if session is not None and self.options.safe_at_exit and self.accepted:
            try:
                session.inbox.close()
                if not session.guard.tripped:
                    session.tree.apply_safe()
            except LinkError as error:
                self._plane.say(2, f"the safe values were not written: {error}")
        self.keeper.close()


def _said_safe(tree: Node) -> str:
    names = [value.path for value in tree if value.quantity.safe is not None and value.writable]
    return f"safe values written: {', '.join(names)}" if names else ""


class _Session:
    """What lives as long as one link."""

    def __init__(self, node: RobotNode, link: Link, tree: Node, guard: DeadManGuard) -> None:
        self.link, self.tree, self.guard = link, tree, guard
        self._node = node
        self._probe = next((value.address for value in tree if value.pollable), None)
        self.outbox = Outbox(tree, node.senders, node.gathered)
        group = ValueGroup({value.path: value for value in tree if value.writable}, node.interface.robot)
        self.inbox = Inbox(
            group, node.complain, timeout_s=node.options.command_timeout_s, on_silence=self._silent
        )

    def _silent(self) -> None:
        self._node.complain("no command came for command_timeout_s: the safe values are written")
        try:
            self.tree.apply_safe()
        except LinkError as error:
            self._node.complain(f"the safe values were not written: {error}")

    def quiet_s(self) -> float:
        return time.monotonic() - self.outbox.last_s

    def check(self) -> None:
        self.guard.check()

    def probe(self) -> None:
        if self._probe is not None:
            self.link.read(self._probe)

    def close(self) -> None:
        self._node.forget(self)
        self.outbox.close()
        self.inbox.close()
        self.tree.stop_publishing()
