# SPDX-License-Identifier: BSD-3-Clause
"""Recordings as people at the page make, list, replay and delete them, and who may do so."""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.errors import AccessRefused, UnityLinkError, ValueRangeError, shown
from unitylink.recording import ENDINGS, Origin
from unitylink.server.stop_switch import now
from unitylink.server.subtree import WHOLE

from .recorder import Recorder
from .replay import Replays

if TYPE_CHECKING:
    from unitylink.server.gate import Client
    from unitylink.spec.model import Instance

    from .desk import Desk
    from .feed import Feed
    from .replay import Replay
    from .shelf import Shelf


class Records:
    """The recordings of a robot. One at a time is being made. Any thread may ask.

    Who reads the whole robot may list, save and replay them. Who also writes something of it may record. An
    administrator deletes. Each beginning, end and deletion is a line of the audit log.
    """

    def __init__(
        self,
        shelf: Shelf,
        feed: Feed,
        root: Instance,
        desk: Desk,
        *,
        origin: Origin,
        note: Callable[[str, str], object],
    ) -> None:
        """`note` tells all viewers of an event, by its kind and text."""
        self.shelf, self.origin = shelf, origin
        self.replays = Replays([track.value for track in feed.tracks])
        self._feed, self._root, self._desk, self._note = feed, root, desk, note
        self._lock = threading.Lock()
        self._running: Recorder | None = None

    def state(self) -> dict[str, Any] | None:
        """Return what is being recorded, or None."""
        running = self._running
        return running.told() if running is not None else None

    def check_see(self, client: Client) -> None:
        """Raises AccessRefused if this user may not see recordings, which have all items of the robot."""
        with self._desk.gate() as gate:
            gate.check_read(client, WHOLE, now())

    def begin(self, client: Client, ending: str) -> None:
        """Begin a recording. Raises AccessRefused, ValueRangeError, or UnityLinkError if there is no room."""
        if ending not in ENDINGS:
            raise ValueRangeError(
                f"{shown(ending)} is no format of recordings; there are {' and '.join(ENDINGS)}"
            )
        self.check_see(client)
        if not client.user.rights.parts("write"):
            raise AccessRefused(
                f"{client.name} may only look; a recording needs the right to write something"
            )
        with self._lock:
            if self._running is not None:
                raise UnityLinkError(f"{self._running.by} is recording already; end that recording first")
            self._running = Recorder(
                self.shelf,
                self._feed,
                self._root,
                self.origin,
                ending=ending,
                by=client.name,
                done=self._ended,
            )
            name = self._running.path.name
        self._audit(client, name, "began")
        self._note("record", f"{client.name} records to {name}")

    def end(self, client: Client) -> None:
        """End the recording. Raises AccessRefused, or UnityLinkError if there is none."""
        self.check_see(client)
        if not client.user.rights.parts("write"):
            raise AccessRefused(f"{client.name} may only look")
        with self._lock:
            running, self._running = self._running, None
        if running is None:
            raise UnityLinkError("nothing is being recorded")
        running.end()
        if running.ended:  # it failed at its very end, and has said so
            return
        told = running.told()
        self._audit(client, told["name"], "ended")
        lost = f", {told['lost']} lost" if told["lost"] else ""
        self._note("record", f"{told['name']} is complete: {told['samples']} samples{lost}")

    def _ended(self, recorder: Recorder) -> None:
        """A recording has ended by itself."""
        if self._running is recorder:
            self._running = None
        self._note("error", f"the recording {recorder.path.name} has ended: {recorder.ended}")

    def close(self) -> None:
        """End the recording, if there is one."""
        with self._lock:
            running, self._running = self._running, None
        if running is not None:
            running.end()

    def whole(self, name: str) -> Path:
        """Return the path of a recording. Raises UnityLinkError if it is still being written."""
        path = self.shelf.find(name)
        running = self._running
        if running is not None and running.path.name == name:
            raise UnityLinkError(f"{name} is still being written; end the recording first")
        return path

    def replay(self, client: Client, name: str) -> Replay:
        """Return a recording as histories, which takes a while. Raises what `whole` and Replay raise."""
        self.check_see(client)
        return self.replays.load(self.whole(name))

    def remove(self, client: Client, name: str) -> None:
        """Delete a recording. Raises AccessRefused, UnknownName or UnityLinkError."""
        with self._desk.gate() as gate:
            gate.check_admin(client, now())
        self.whole(name)
        self.shelf.remove(name)
        self._audit(client, name, "deleted")
        self._note("record", f"{client.name} has deleted {name}")

    def _audit(self, client: Client, name: str, what: str) -> None:
        with suppress(AccessRefused), self._desk.gate() as gate:
            gate.note("record", client, now(), file=name, what=what)
