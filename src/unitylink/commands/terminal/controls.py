# SPDX-License-Identifier: BSD-3-Clause
"""What a person at the terminal does to the robot. The thread of the screen never waits for the board."""

from __future__ import annotations

import getpass
import json
import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, ExitStack, suppress
from typing import TYPE_CHECKING, Any

from unitylink.dashboard.desk import Desk
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import load_spec_objects
from unitylink.server.audit import Audit
from unitylink.server.gate import LEASE_S, Client, Gate
from unitylink.server.scopes import Rights
from unitylink.server.stop_switch import now
from unitylink.server.subtree import shown
from unitylink.server.tokens import Tokens, User, digest, new_token

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.spec.model import Instance, Spec

_KEEP_S = 0.1  # between two looks at the leases
_AGAIN_S = 0.5  # between two attempts to stop
_NOTES = 500


class Controls:
    """Writes, control of parts, and the stop. Use it in a `with` block.

    `open_link` gives the link that writes. With `shared` it leads to a server, whose other programs a stop
    has to hold, too. There it is opened anew when control is given back, because the server keeps the leases
    of a program as long as its connection lives. `notes` gets (time in s since 1970, text) of what happened.

    Leases end 2 s after the last `alive()`. Then the outputs of their parts get their SAFE values.
    """

    def __init__(
        self,
        open_link: Callable[[], AbstractContextManager[Link]],
        spec: Spec,
        root: Instance,
        *,
        shared: bool = False,
    ) -> None:
        self.notes: deque[tuple[float, str]] = deque(maxlen=_NOTES)
        self._open_link, self._spec, self._root, self._shared = open_link, spec, root, shared
        self._user = _user()
        self._client: Client
        self._desk: Desk
        self._link: ExitStack  # closes the link of the desk
        self._alive_s = time.monotonic()
        self._stops_asked = self._stops_done = 0
        self._stop_wanted, self._ended = threading.Event(), threading.Event()
        self._pool = ThreadPoolExecutor(4, "unitylink-desk")
        self._threads = [
            threading.Thread(target=self._keep, name="unitylink-keep", daemon=True),
            threading.Thread(target=self._stop_when_asked, name="unitylink-stop", daemon=True),
        ]

    def __enter__(self) -> Controls:
        self._client, self._desk, self._link = self._begin()
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._stop_wanted.set()
        for thread in self._threads:
            thread.join(2.0)
        self._pool.shutdown(wait=False, cancel_futures=True)
        with suppress(UnityLinkError):
            self._end()

    def _begin(self) -> tuple[Client, Desk, ExitStack]:
        """Open a link that writes, and log in at a gate of this program."""
        with ExitStack() as stack:
            link = stack.enter_context(self._open_link())
            token = new_token()
            owner = User(self._user, Rights.of(["admin"]))
            gate = Gate(self._root.name, self._root, Tokens([(digest(token), owner)]), Audit(self._heard))
            robot = load_spec_objects(self._spec, link, root=self._root.name)
            return gate.login(token, "this terminal", now()), Desk(robot, gate), stack.pop_all()

    def _end(self) -> None:
        """Give back control in order, and close the link. The outputs keep their values."""
        with self._desk.gate() as gate:
            gate.logout(self._client, now())
        self._link.close()

    # -- what is the case

    def control(self) -> dict[str, str]:
        """Return who has control of which part, as text. The whole robot is "all"."""
        with self._desk.gate() as gate:
            return {
                shown(lease.part): f"being made safe ({lease.ending})" if lease.ending else lease.holder
                for lease in gate.leases.all()
            }

    def has(self, path: str) -> bool:
        """Tell whether this terminal has control of an item."""
        with self._desk.gate() as gate:
            return gate.leases.may_write(self._client.number, path, time.monotonic())

    @property
    def stopped_by(self) -> str:
        """Who has stopped the robot at this terminal, or an empty text."""
        with self._desk.gate() as gate:
            return gate.stopped_by

    @property
    def stopping(self) -> bool:
        """Whether a stop was asked for and is not done yet."""
        return self._stops_done != self._stops_asked

    def note(self, text: str) -> None:
        self.notes.append((time.time(), text))

    def _heard(self, line: str) -> None:
        """Note what the gate has decided by itself."""
        told = json.loads(line)
        if told["event"] == "lost":
            self.note(f"{told['part']}: control is lost, because {told['reason']}")
        elif told["event"] == "safe":
            self.note(f"{told['part']}: the outputs are safe")

    # -- what to do

    def alive(self) -> None:
        """A sign of life of the screen."""
        self._alive_s = time.monotonic()

    def take(self, part: str) -> None:
        """Take control of a part. "" is the whole robot."""

        def do() -> str:
            with self._desk.gate() as gate:
                lease = gate.take(self._client, part, LEASE_S, now())
            return f"you have control of {shown(lease.part)}"

        self._soon(do)

    def give_back(self) -> None:
        """End control in order. The outputs keep their values."""

        def do() -> str:
            with self._desk.gate() as gate:
                held = gate.leases.of(self._client.number)
            if self._shared and held:
                fresh = self._begin()  # before anything is given back, because it may fail
                self._end()
                self._client, self._desk, self._link = fresh
            with self._desk.gate() as gate:
                for lease in held:
                    gate.release(self._client, lease.part, now())
            return "control is given back; the outputs keep their values"

        self._soon(do)

    def write(self, path: str, value: Any, text: str) -> None:
        """Write a value. `text` says it in the note."""

        def do() -> str:
            self._desk.write(self._client, {path: value})
            return f"{path} = {text}"

        self._soon(do)

    def pulse(self, path: str) -> None:
        """Write a PULSE once."""

        def do() -> str:
            self._desk.pulse(self._client, path)
            return f"{path}: pulse"

        self._soon(do)

    def clear(self, path: str, seen: Any) -> None:
        """Clear those flags of a W1C item that were seen."""

        def do() -> str:
            self._desk.clear(self._client, path, seen)
            return f"{path}: cleared"

        self._soon(do)

    def go_on(self) -> None:
        """Allow writes again after a stop, or after the dead-man of the board has tripped."""

        stops = self._desk.switch.stops

        def do() -> str:
            self._desk.arm(self._client, stops)
            return "writes are allowed again"

        self._soon(do)

    def stop(self) -> None:
        """Make the outputs safe. Any thread may call it, at any time. It waits for nothing."""
        self._stops_asked += 1
        self._stop_wanted.set()

    def lost(self) -> None:
        """The person is gone without a word. The parts under control are made safe. Waits for that."""
        with self._desk.gate() as gate:
            gate.gone(self._client, now())
        with suppress(UnityLinkError):
            self._desk.keep_safe()

    # -- threads

    def _soon(self, do: Callable[[], str]) -> None:
        def run() -> None:
            try:
                self.note(do())
            except UnityLinkError as error:
                self.note(f"NOT DONE: {error}")

        if not self._ended.is_set():
            self._pool.submit(run)

    def _stop_when_asked(self) -> None:
        while not self._ended.is_set():
            self._stop_wanted.wait()
            self._stop_wanted.clear()
            while self.stopping and not self._ended.is_set():
                asked = self._stops_asked
                try:
                    self.note(self._stop())
                    self._stops_done = asked
                except UnityLinkError as error:
                    self.note(f"THE STOP DOES NOT WORK YET, trying again: {error}")
                    self._ended.wait(_AGAIN_S)

    def _stop(self) -> str:
        count = self._desk.stop(self._client)
        return f"STOPPED: {count} outputs are safe, and nobody may write"

    def _keep(self) -> None:
        failed = ""
        while not self._ended.wait(_KEEP_S):
            try:
                if time.monotonic() - self._alive_s < LEASE_S / 2:
                    with self._desk.gate() as gate:
                        gate.renew(self._client, now())
                self._desk.keep_safe()
                failed = ""
            except UnityLinkError as error:
                if str(error) != failed:
                    failed = str(error)
                    self.note(f"OUTPUTS ARE NOT SAFE YET: {failed}")


def part_of(path: str) -> str:
    """Return the part of the robot that is under control together: what is directly below the root."""
    return path.split(".", 1)[0]


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user without a name, as in a container
        return "you"
