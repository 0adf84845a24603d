# SPDX-License-Identifier: BSD-3-Clause
"""The stop of a robot: the gate refuses writes, the outputs become safe, and the board remembers it."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from unitylink.connection.schemes import scheme_of
from unitylink.errors import AccessRefused, DeadManTripped, DeviceMismatch, LinkDown, UnityLinkError
from unitylink.protocol import CONTROL_VALUE_FEATURE_DEADMAN

from .audit import complain
from .gate import Client, Gate, Now

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .stop_file import StopFile

DEAD_MAN = "the board's dead-man"  # who has stopped a robot whose board was found tripped


def now() -> Now:
    """Return the time, by the clock that does not jump and by that of the wall."""
    return Now(time.monotonic(), time.time())


class StopSwitch:
    """Stops and arms the robot of `gate`, from any thread. `lock` guards the gate.

    A stop also trips the dead-man of the board. So the board itself refuses writes until `arm`, whatever
    becomes of this program: who begins with a board that has tripped begins stopped (`attach`). A stop that
    cannot reach the board is done when it can (`keep`). `arm` lets the dead-man run again as before.

    `memory` is a file that remembers a stop, too: for boards that have no dead-man, or lose their power.
    `changed` is called when a stop begins, with the lock held. Hold `board` while a request is under way.
    """

    def __init__(
        self, gate: Gate, memory: StopFile | None = None, changed: Callable[[], object] = lambda: None
    ) -> None:
        self.gate, self.lock = gate, threading.Lock()
        self.board = threading.Lock()
        self._memory, self._changed = memory, changed
        self._orders = threading.Lock()  # held while a stop, or an arm, is at the board
        # Stops that have begun, and that have reached the board or failed. They do not begin with 0, so that
        # what somebody knew of the program before this one is no knowledge of this one.
        self._begun = self._over = secrets.randbelow(1 << 31)
        self._over_ns = 0  # when the last one did, by time.monotonic_ns
        self._due = False  # a stop has not reached the board
        self._links: tuple[Link, ...] = ()
        self._seen: tuple[int, ...] = ()  # the generations of the links, when the board was stopped
        self._write_safe: Callable[[], object] = lambda: None
        if memory is not None and (who := memory.read()):
            gate.found_stopped(who, f"{memory.path} says so", now())

    def attach(self, links: Sequence[Link], write_safe: Callable[[], object]) -> None:
        """Begin with the links to the board, before anybody can write. Raises LinkError.

        `write_safe` writes all SAFE values. Who stops the robot of a server or bridge leaves it to that.
        """
        tripped = not any(map(_is_served, links)) and any(map(_tripped, links))
        with self.lock:
            if tripped and not self.gate.stopped_by:
                self.gate.found_stopped(DEAD_MAN, "it had tripped when the board was opened", now())
            self._due = bool(self.gate.stopped_by)
            self._links, self._write_safe = tuple(links), write_safe
        try:
            self.keep()
        except UnityLinkError:
            self.detach()
            raise

    @property
    def stops(self) -> int:
        """A number that each stop changes. Who has seen it knows of all stops until then."""
        return self._begun

    def detach(self) -> None:
        """The links are gone."""
        self._links = ()

    def stop(self, client: Client) -> None:
        """Make the outputs safe now, end all leases, and refuse writes until `arm`.

        Raises AccessRefused if the user is not logged in any more, and a LinkError if the board did not
        answer, or is away. Then writes are refused all the same, and `keep` tries again.
        """
        with self.lock:
            self.gate.stopped(client, now())
            self._begun += 1
            self._due = True
        try:
            with self.lock:
                self._changed()  # so the SAFE values are not followed by what others write
            self._make_safe_at_once()
            self._stop_board()
        finally:
            with self.lock:
                self._over += 1
                self._over_ns = time.monotonic_ns()

    def arm(self, client: Client, asked_ns: int | None = None, *, stops: int | None = None) -> None:
        """Allow writes again, after a stop or after the board's dead-man has tripped.

        `asked_ns` is when it was asked for, by `time.monotonic_ns`; without it, that is now. `stops` is the
        number that whoever asks has seen. A stop that is under way then, or comes later, wins: who asked for
        this did not know of it. Raises AccessRefused then, or if the user may not arm, and a LinkError if the
        board did not answer. Then the robot stays stopped.
        """
        with self.lock:
            self.gate.check_arm(client, now())
            known = self._over
            self._check_no_stop(known)
            late = asked_ns is not None and asked_ns < self._over_ns
            if late or (stops is not None and stops != known):
                raise AccessRefused(
                    "the robot was stopped after this was asked for; if it may move, arm it again"
                )
        with self._orders:
            with self.lock:
                self._check_no_stop(known)
            if not self._links:
                raise LinkDown(f"the board of {self.gate.name} is away; arm it when it is back")
            self._forget()  # before the board may move
            try:
                if self._wanted():
                    self._reach_board()  # else it would move on, although it was stopped
                for link in self._links:
                    if _is_served(link) or _has_dead_man(link):
                        link.arm()
                with self.lock:
                    self._check_no_stop(known)
                    self.gate.armed(client, now())
                    self._due = False
            finally:
                if who := self.gate.stopped_by:  # perhaps the board was armed: `keep` stops it
                    self._due = True
                    self._remember(who)

    def keep(self) -> None:
        """Do a stop that has not reached the board, or that the board has lost. Raises LinkError.

        Call it often.
        """
        if self._links and self._wanted():
            self._stop_board()

    def _wanted(self) -> bool:
        """Whether the robot is stopped, and the board does not know it."""
        lost = self._seen != self._generations() and not any(map(_is_served, self._links))
        return bool(self.gate.stopped_by) and (self._due or lost)

    def _check_no_stop(self, known: int) -> None:
        if self._begun != known:
            raise AccessRefused(f"{self.gate.stopped_by} is stopping the robot; arm it after that")

    def _make_safe_at_once(self) -> None:
        """Write the SAFE values beside a request or an arm that is under way, before the dead-man trips."""
        if not any(map(_is_served, self._links)):  # there, the first write would take leases
            with suppress(UnityLinkError):  # what follows tells it
                self._write_safe()

    def _stop_board(self) -> None:
        """Trip the dead-man. Without one, write the SAFE values when what is under way has ended."""
        with self._orders:
            with self.lock:
                if not (who := self.gate.stopped_by):
                    return  # somebody has armed it meanwhile
            try:
                self._reach_board()
            finally:
                self._remember(who)

    def _reach_board(self) -> None:
        """Trip all dead-men, whatever becomes of one of them. Hold `_orders`."""
        if not (links := self._links):
            raise LinkDown(
                f"the board of {self.gate.name} is away; nobody writes before somebody arms it, and "
                "its outputs are made safe when it is back"
            )
        seen, complete, failed = self._generations(), True, None
        for link in links:
            try:
                complete = _trip(link) and complete
            except UnityLinkError as error:
                failed = failed or error
        if not complete:
            with self.board, suppress(DeadManTripped):
                self._write_safe()
        if failed is not None:
            raise failed
        self._seen, self._due = seen, False

    def _generations(self) -> tuple[int, ...]:
        return tuple(link.generation for link in self._links)

    def _remember(self, who: str) -> None:
        if self._memory is not None and self._memory.read() != who:
            try:
                self._memory.write(who)
            except OSError as error:
                complain(
                    f"{self._memory.path}: {error.strerror or error}; so the stop of {self.gate.name} may "
                    "not outlive this program"
                )

    def _forget(self) -> None:
        if self._memory is not None:
            try:
                self._memory.remove()
            except OSError as error:
                raise UnityLinkError(
                    f"{self._memory.path}: {error.strerror or error}; remove it, and arm again: while it is "
                    "there, the robot is stopped"
                ) from error


def _is_served(link: Link) -> bool:
    """Whether a server or a bridge is between this link and the board. That one has a stop of its own."""
    return scheme_of(link.url).name in ("serve", "zenoh")


def _has_dead_man(link: Link) -> bool:
    description = link.description if link.protocol == "framed" else None
    return description is not None and bool(description.features & CONTROL_VALUE_FEATURE_DEADMAN)


def _tripped(link: Link) -> bool:
    state = link.dead_man() if _has_dead_man(link) else None
    return state is not None and state.tripped


def _trip(link: Link) -> bool:
    """Trip the dead-man behind a link. Return False if it has none, or this program may not."""
    if not (_is_served(link) or _has_dead_man(link)):
        return False
    try:
        link.trip()
    except (AccessRefused, DeviceMismatch):
        return False
    return True
