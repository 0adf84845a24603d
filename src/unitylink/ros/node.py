# SPDX-License-Identifier: BSD-3-Clause
"""The node behind every front end, with topics on one side.

On the other side is a link that may come and go.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkError, UnityLinkError, ValueRangeError
from unitylink.layer4_data import Node

from .health import Health, NodeState, health
from .interface import Interface, Topic
from .keeper import LinkKeeper
from .life import DEVICE_S, Watch
from .plane import READ, SET_BOOL, TRIGGER, WRITE, Plane, Port
from .receivers import Read, receiver
from .senders import Send, sender
from .session import RobotSession, SessionNeeds
from .sim_clock import CLOCK
from .values import read_values, write_values

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

COMPLAIN_EVERY_S = 1.0


@dataclass(frozen=True)
class Options:
    """The options that a user can set.

    After `command_timeout_s` without a command, the node makes the robot safe. With 0 it never does. After
    `deadman_s` without a sign of life from the node, the gateware does so. With 0 it never does.
    `safe_at_exit` writes the safe values when the node ends. If `armed` is False, no commands are taken
    before `arm` is called. The time of a virtual board in steps passes `speed` times as fast as real time;
    with 0 as fast as it can.
    """

    command_timeout_s: float = 0.0
    deadman_s: float = 1.0
    safe_at_exit: bool = True
    armed: bool = True
    retry_s: float = 1.0
    speed: float = 1.0


class RobotNode:
    """Connects a robot to a plane of messages, from the constructor until `close`.

    `connect()` opens the link, and `build(link)` makes the robot's values on it. If there is no device,
    nothing is raised. The node reports this and waits for the device.
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
        self.plane, self.life = plane, plane.life
        self.hanging = ""
        self._made_safe = False
        self._build = build
        self._session: RobotSession | None = None
        self._complained_s = 0.0
        self._clock: Port | None = None  # only for a board in steps
        self._lock = threading.Lock()
        self.senders: Sequence[tuple[Topic, Send]] = [
            (topic, sender(interface, topic, plane)) for topic in interface.published
        ]
        # made before the first subscription, because its messages ask the keeper for the state
        self.keeper = LinkKeeper(connect, self._begin, plane.say, retry_s=self.options.retry_s)
        self._watch = Watch(self.life, self._alive, self._hangs)
        for topic in interface.commanded:
            plane.subscribe(topic, self._taker(receiver(interface, topic)), self.undecodable)
        plane.serve("set_safe", TRIGGER, self.set_safe)
        plane.serve("arm", SET_BOOL, self.arm)
        if services:  # their types are in the generated package
            plane.serve("read", READ, self.read)
            plane.serve("write", WRITE, self.write)

    # What the link causes

    def _begin(self, link: Link, again: bool) -> RobotSession:
        needs = SessionNeeds(
            self.interface,
            self.plane,
            self.senders,
            self.options.deadman_s,
            self.options.command_timeout_s,
            armed=lambda: self.armed,
            complain=self.complain,
            looked_after=self.make_safe_when_hanging,
            ended=self.leave,
            speed=self.options.speed,
            clock_port=self._clock_port,
        )
        session = RobotSession(needs, link, self._build(link), again=again)
        self._session = session
        return session

    def _clock_port(self) -> Port:
        if self._clock is None:
            self._clock = self.plane.advertise(CLOCK)
        return self._clock

    def leave(self, session: RobotSession) -> None:
        if self._session is session:
            self._session = None

    @property
    def session(self) -> RobotSession | None:
        """The session while the link is up and the device is ready for commands, else None."""
        return self._session if self.keeper.up.is_set() else None

    # What the node's threads report

    def _alive(self) -> None:
        session = self._session
        if session is not None:
            session.link.alive()

    def _hangs(self, trouble: str) -> None:
        self.hanging = trouble
        if trouble:
            self._made_safe = False
            self.plane.say(2, f"{trouble}: no commands are taken, and the dead-man may trip")
        else:
            self.plane.say(1, "all threads work again")

    def make_safe_when_hanging(self, session: RobotSession) -> None:
        """Write the safe values once while the link still accepts them, because not all gateware has a
        dead-man.
        """
        if self.hanging and not self._made_safe and not session.guard.tripped:
            self._made_safe = True
            session.tree.apply_safe()

    @property
    def state(self) -> str:
        """A sentence: which task hangs, or the state of the link."""
        return self.hanging or self.keeper.state

    # What ROS causes

    def _taker(self, read: Read) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            session = self.session
            try:
                if session is None or self.hanging:
                    raise ValueRangeError(f"a command was not taken: {self.state}")
                if not self.armed:
                    raise ValueRangeError("a command was not taken: the robot is not armed (service arm)")
                session.inbox.put(read(message))
                self.accepted += 1
            except UnityLinkError as error:
                self._refuse(str(error))
            except Exception as error:  # whatever one message holds, the next one is taken
                self._refuse(f"a command was not understood: {error!r}")

        return take

    def _refuse(self, why: str) -> None:
        self.refused += 1
        self.complain(why)

    def undecodable(self, topic: str, error: Exception) -> None:
        """Refuse bytes on a topic that are not a message of its type."""
        self._refuse(f"{topic}: the message does not have its type: {error}")

    def complain(self, message: str) -> None:
        """Warn at most once a second, because a stream of wrong commands must not become a stream of
        warnings.
        """
        with self._lock:
            now = time.monotonic()
            if now - self._complained_s < COMPLAIN_EVERY_S:
                return
            self._complained_s = now
        self.plane.say(1, message)

    def _with(self, action: Callable[[RobotSession], str]) -> tuple[bool, str]:
        session = self.session
        if session is None:
            return False, self.state
        try:
            with self.life.work("a service", DEVICE_S):
                return True, action(session)
        except UnityLinkError as error:
            return False, str(error)

    def set_safe(self) -> tuple[bool, str]:
        """Write the safe values, and forget the waiting commands."""

        def act(session: RobotSession) -> str:
            session.inbox.clear()
            if session.guard.tripped:
                return "the outputs are safe already: the dead-man has tripped"
            session.tree.apply_safe()
            return session.said_safe() or "the spec gives no SAFE values; nothing was written"

        return self._with(act)

    def arm(self, on: bool) -> tuple[bool, str]:
        """Take commands from now on. Without `on`, take no more commands and write the safe values."""
        if on:
            if self.hanging:
                return False, self.hanging
            session = self.session
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
        """Write values by their paths, if the node is armed."""
        if not self.armed:
            return False, "the robot is not armed (service arm); nothing was written"
        return self._with(lambda session: write_values(session.tree, names, values))

    # Its health

    def health(self) -> Health:
        state = NodeState(
            self.accepted, self.refused, self.keeper.losses, self.armed, bool(self.hanging), self.state
        )
        return health(state, self.session)

    def close(self) -> None:
        """End the link. Before that, write the safe values if the options say so and a command has come."""
        session = self.session
        if session is not None and self.options.safe_at_exit and self.accepted:
            try:
                session.inbox.close()
                if not session.guard.tripped:
                    session.tree.apply_safe()
            except LinkError as error:
                self.plane.say(2, f"the safe values were not written: {error}")
        self.keeper.close()
        self._watch.close()
