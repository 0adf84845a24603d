# SPDX-License-Identifier: BSD-3-Clause
"""What all viewers of one robot share: the feed, the desk, the rounds, the state that everybody sees."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from unitylink.errors import LinkError
from unitylink.layer4_data import Node
from unitylink.recording import Origin
from unitylink.server.rate_limit import SharedLimit

from .alarms import Alarms
from .description import describe
from .desk import Desk
from .extras import Extras
from .feed import Feed
from .frames import Frames
from .promise import Promise
from .records import Records
from .requests import BURST, REQUESTS_HZ, plain

if TYPE_CHECKING:
    from unitylink.layer2_message import Link, LinkEvent
    from unitylink.server.gate import Client
    from unitylink.spec.model import Instance, Spec

ROUND_S = 1 / 30
STATE_S = 0.5
KEPT = 200  # events that a new viewer is told
BOARD_THREADS = 4

T = TypeVar("T")


class Audience(Protocol):
    """What the station wants of a viewer."""

    client: Client
    session: object
    sees: list[bool]

    def tell(self, message: dict[str, Any]) -> None: ...
    def wake(self) -> None: ...
    def dismiss(self, reason: str) -> None: ...


class Station:
    """The robot as the web server sees it. `run` makes the rounds, in the event loop of the web server."""

    def __init__(
        self, link: Link, root: Instance, robot: Node, desk: Desk, feed: Feed, *, spec: Spec, extras: Extras
    ) -> None:
        self.link, self.robot, self.desk, self.feed, self.body = link, robot, desk, feed, extras.body
        self.report = extras.report
        self.frames = Frames(feed)
        self.description = describe(root, robot)
        values = [track.value for track in feed.tracks]
        units = {value.path: value.unit for value in values if value.unit}
        origin = Origin(spec.source, extras.text, spec.hash, units)
        self.records = Records(extras.shelf, feed, root, desk, origin=origin, note=self.note)
        self.alarms = Alarms(values, self.note)
        self.promise = Promise(spec, root, link)
        self.promise.begin(feed.publications())
        feed.takers += [self.alarms.take, self.promise.take]
        self.viewers: set[Audience] = set()
        self.limits = SharedLimit(REQUESTS_HZ, BURST)
        self.events: deque[dict[str, Any]] = deque(maxlen=KEPT)
        self.round_trip_s: float | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._pool = ThreadPoolExecutor(BOARD_THREADS, "unitylink-desk")
        self._apart = ThreadPoolExecutor(2, "unitylink-stop")  # for nothing but stops
        self._keeper = ThreadPoolExecutor(1, "unitylink-keep")
        self._files = ThreadPoolExecutor(2, "unitylink-files")
        self._texts: dict[int, str] = {}
        self._changed = True

    def at_board(self, call: Callable[..., Any], *arguments: Any) -> Awaitable[Any]:
        """Do a call that waits for the board, beside the event loop."""
        return asyncio.get_running_loop().run_in_executor(self._pool, call, *arguments)

    def at_once(self, call: Callable[..., Any], *arguments: Any) -> Awaitable[Any]:
        """Do the same for a stop, whatever other calls wait."""
        return asyncio.get_running_loop().run_in_executor(self._apart, call, *arguments)

    def in_files(self, call: Callable[..., T], *arguments: Any) -> Awaitable[T]:
        """Do a call that reads or writes files."""
        return asyncio.get_running_loop().run_in_executor(self._files, call, *arguments)

    def since_1970_s(self) -> float:
        """Return the difference of the time since 1970 and that of the link, in s."""
        return time.time() - self.link.now_s()

    async def run(self, stop: asyncio.Event) -> None:
        """Make rounds until `stop`."""
        self._loop = asyncio.get_running_loop()
        self.link.on_event(self._heard)
        handler = _Tell(self)
        logging.getLogger("unitylink").addHandler(handler)
        keeper = asyncio.create_task(self._keep(stop))
        try:
            due_s, state_s = time.monotonic(), 0.0
            while not stop.is_set():
                self.frames.refresh(self.link.now_s())
                if self._changed or time.monotonic() - state_s >= STATE_S:
                    self._changed, state_s = False, time.monotonic()
                    self._tell_state()
                for viewer in self.viewers:
                    viewer.wake()
                due_s = max(due_s + ROUND_S, time.monotonic())
                with suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(stop.wait(), max(0.0, due_s - time.monotonic()) or ROUND_S / 10)
        finally:
            logging.getLogger("unitylink").removeHandler(handler)
            keeper.cancel()
            with suppress(asyncio.CancelledError):
                await keeper
            for pool in (self._pool, self._apart, self._keeper, self._files):
                pool.shutdown(wait=False, cancel_futures=True)
            await asyncio.to_thread(self.records.close)

    async def _keep(self, stop: asyncio.Event) -> None:
        """Look after the leases ten times a second, and measure the round trip once."""
        loop, asked_s, failed = asyncio.get_running_loop(), 0.0, ""
        while not stop.is_set():
            await asyncio.sleep(0.1)
            try:
                await loop.run_in_executor(self._keeper, self.desk.keep_safe)
                failed = ""
                with self.desk.gate() as gate:
                    present = set(gate.clients())
                for viewer in list(self.viewers):
                    if viewer.client not in present:
                        viewer.dismiss("your token has expired")
                if time.monotonic() - asked_s >= 1.0:
                    asked_s = time.monotonic()
                    self.round_trip_s = await loop.run_in_executor(self._keeper, self.feed.round_trip_s)
            except LinkError as error:
                if str(error) != failed:
                    failed = str(error)
                    self.note("error", failed)

    def _heard(self, event: LinkEvent) -> None:
        self.note(event.kind, event.text)

    def note(self, kind: str, text: str) -> None:
        """Tell all viewers of an event, and those who come later. Any thread may call it."""
        if self._loop is not None and not self._loop.is_closed():
            with suppress(RuntimeError):  # the loop ends at this moment
                self._loop.call_soon_threadsafe(self._note, kind, text)

    def _note(self, kind: str, text: str) -> None:
        event = {"time_s": self.link.now_s(), "wall_s": time.time(), "kind": kind, "text": text}
        self.events.append(event)
        for viewer in self.viewers:
            viewer.tell({"event": event})

    def changed(self) -> None:
        """The state has changed, and the next round tells it."""
        self._changed = True

    def hello(self, viewer: Audience) -> dict[str, Any]:
        """Return what a new viewer is told first."""
        rights = viewer.client.user.rights
        self._changed = True
        return {
            **self.description,
            "link": self.link.url.partition("?")[0],
            "protocol": self.link.protocol,
            "user": viewer.client.name,
            "client": viewer.client.number,
            "writes": list(rights.parts("write")),
            "may_arm": rights.allow("arm"),
            "may_break": rights.allow("admin"),
            "may_see_recordings": rights.allow("read"),
            "has_status": self.report is not None,
            "has_body": self.body is not None,
            "sees": [number for number, seen in enumerate(viewer.sees) if seen],
            "rates": [track.rate_hz for track in self.feed.tracks],
            "texts": {number: track.text for number, track in enumerate(self.feed.tracks) if track.text},
            "events": list(self.events),
            "now_s": self.link.now_s(),
            "wall_s": time.time(),
        }

    def _tell_state(self) -> None:
        texts = {number: track.text for number, track in enumerate(self.feed.tracks) if track.text}
        fresh = {number: text for number, text in texts.items() if self._texts.get(number) != text}
        self._texts = texts
        state, alarms = self.state(), self.alarms.all()
        for viewer in self.viewers:
            shown = [alarm.told() for alarm in alarms if viewer.sees[alarm.item]]
            message: dict[str, Any] = {"state": {**state, "alarms": shown}}
            if seen := {number: text for number, text in fresh.items() if viewer.sees[number]}:
                message["texts"] = seen
            viewer.tell(message)

    def state(self) -> dict[str, Any]:
        """Return what changes now and then: leases, the link, the publishes."""
        moment_s = time.monotonic()
        with self.desk.gate() as gate:
            leases = [
                {
                    "part": lease.part,
                    "holder": lease.holder,
                    "client": lease.client,
                    "left_s": plain(round(max(0.0, lease.until_s - moment_s), 2)),
                    "ending": lease.ending,
                }
                for lease in gate.leases.all()
            ]
            wishes = [
                {"part": wish.part, "user": wish.user} for wish in gate.wishes.all(moment_s) if not wish.kept
            ]
            stopped_by, stops = gate.stopped_by, self.desk.switch.stops
            users = [client.name for client in gate.clients()]
        return {
            "up": self.link.up,
            "trouble": self.link.trouble,
            "stopped_by": stopped_by,
            "stops": stops,
            "leases": leases,
            "wishes": wishes,
            "users": sorted(set(users)),
            "viewers": len(self.viewers),
            "round_trip_s": self.round_trip_s,
            "statistics": asdict(self.link.statistics()),
            "publishes": [{**one, **self.promise.told(one["paths"])} for one in self.feed.reports()],
            "line": self.promise.line(),
            "recording": self.records.state(),
        }


class _Tell(logging.Handler):
    """Shows what the library logs, such as a failed poll, on the page."""

    def __init__(self, station: Station) -> None:
        super().__init__(logging.WARNING)
        self._station = station

    def emit(self, record: logging.LogRecord) -> None:
        self._station.note("log", record.getMessage())
