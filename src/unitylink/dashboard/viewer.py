# SPDX-License-Identifier: BSD-3-Clause
"""One browser that looks: its requests, and what it is sent.

Nothing waits for a viewer who is slow. Its next frame is made when the last one has gone, and holds what has
come since. So it gets fewer frames, and each chart still has every peak.
"""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from starlette.websockets import WebSocketDisconnect

from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.server.gate import LEASE_S, Client
from unitylink.server.leases import DURATION_MAX_S, DURATION_MIN_S
from unitylink.server.rate_limit import RateLimit
from unitylink.server.stop_switch import now
from unitylink.server.subtree import contains

from .frames import RANGE, VALUES, floats, latest
from .requests import BURST, REQUESTS_HZ, Request, read

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from .replay import Replay
    from .station import Station

WAITING = 500  # texts that may wait for a viewer; one that lets more wait does not read any more


class Viewer:
    """One browser, logged in as `client`. `run` serves it until it goes.

    Its requests are done one after the other. `sees[item]` tells whether its user may read the item.
    """

    def __init__(self, socket: WebSocket, station: Station, client: Client, session: object) -> None:
        self.client = client
        self.session = session  # of the browser, which may log out
        self._socket = socket
        self._station = station
        self._limit = RateLimit(REQUESTS_HZ, BURST)
        self._shared = station.limits.of(client.name)  # with the other pages of this user
        self._waiting: deque[str | bytes] = deque()
        self._wake = asyncio.Event()
        self._ended = asyncio.Event()
        self._round = 0
        self._replay: Replay | None = None
        self._series: dict[tuple[int, float], int] = {}  # item and step: the first bucket of the next frame
        rights = client.user.rights
        self.sees = [rights.allow("read", track.value.path) for track in station.feed.tracks]
        self._whole = all(self.sees)
        self._do: dict[str, Callable[[Request], Any]] = {
            "view": self._view,
            "range": self._range,
            "write": self._write,
            "pulse": self._pulse,
            "clear": self._clear,
            "take": self._take,
            "release": self._release,
            "ask": self._ask,
            "break": self._break,
            "alive": self._alive,
            "arm": self._arm,
            "acknowledge": self._acknowledge,
            "record": self._record,
            "end_recording": self._end_recording,
            "delete_recording": self._delete_recording,
            "replay": self._replay_begin,
        }

    async def run(self) -> None:
        """Serve the viewer until it goes, or the station ends."""
        self.tell({"hello": self._station.hello(self)})
        ended = asyncio.create_task(self._ended.wait())
        jobs = [asyncio.create_task(self._listen()), asyncio.create_task(self._send()), ended]
        try:
            await asyncio.wait(jobs, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for job in jobs:
                job.cancel()
            for job in jobs:
                with suppress(asyncio.CancelledError, WebSocketDisconnect, RuntimeError, OSError):
                    await job

    def tell(self, message: dict[str, Any]) -> None:
        """Send a message soon."""
        self._put(json.dumps(message, allow_nan=False, separators=(",", ":")))

    def dismiss(self, reason: str) -> None:
        """End the service of this viewer, who is told why."""
        self.tell({"bye": reason})
        asyncio.get_running_loop().call_later(0.1, self._ended.set)

    def wake(self) -> None:
        """A round has begun: there are new values."""
        self._wake.set()

    def _put(self, message: str | bytes) -> None:
        if len(self._waiting) < WAITING:
            self._waiting.append(message)
        self._wake.set()

    async def _send(self) -> None:
        while len(self._waiting) < WAITING:
            await self._wake.wait()
            self._wake.clear()
            while self._waiting:
                message = self._waiting.popleft()
                if isinstance(message, str):
                    await self._socket.send_text(message)
                else:
                    await self._socket.send_bytes(message)
            if self._station.feed.round > self._round:
                await self._socket.send_bytes(self._frame())

    def _frame(self) -> bytes:
        frames = self._station.frames
        same = self._whole
        head = frames.latest(self._round) if same else latest(frames.feed.tracks, self._round, self.sees)
        self._round = frames.feed.round
        parts = []
        for (item, step_s), first in self._series.items():
            part, self._series[item, step_s] = frames.series(item, step_s, first)
            parts.append(part)
        return b"".join((floats((VALUES, frames.now_s)), head, floats((len(parts),)), *parts))

    # -- requests

    async def _listen(self) -> None:
        while True:
            text = await self._socket.receive_text()
            number = 0
            try:
                moment_s = now().steady_s
                for limit in (self._limit, self._shared):
                    if not limit.allow(moment_s):
                        raise ValueRangeError(f"more than {limit.rate_hz:g} requests a second; wait a moment")
                request = read(text)
                number = request.number
                if request.do not in self._do:
                    raise ValueRangeError(f"there is no request {request.do!r}")
                done = self._do[request.do](request)
                if done is not None:
                    await done
                if number:
                    self.tell({"answer": number})
            except UnityLinkError as error:
                self.tell({"answer": number, "error": str(error), "kind": type(error).__name__})

    def _wanted(self, request: Request) -> list[tuple[int, float, float]]:
        wanted = request.series(len(self.sees))
        paths = {self._station.feed.tracks[item].value.path for item, _, _ in wanted if not self.sees[item]}
        with self._station.desk.gate() as gate:
            for path in sorted(paths):
                gate.check_read(self.client, path, now())
        return wanted

    def _view(self, request: Request) -> None:
        """Send these series from now on, each from its begin. It replaces the last such request."""
        self._series = {
            (item, step_s): int(begin_s // step_s) for item, step_s, begin_s in self._wanted(request)
        }

    def _range(self, request: Request) -> None:
        """Send these series once, each from its begin to the same end: live ones, or of the replay."""
        end_s = request.seconds("end_s", -1e9, 1e9)
        frames, histories = self._station.frames, None
        if request.facts.get("replay"):
            if self._replay is None:
                raise ValueRangeError("range: there is no replay; begin one first")
            histories = self._replay.histories
        parts = [
            frames.range(item, step, begin, end_s, histories[item] if histories else None)
            for item, step, begin in self._wanted(request)
        ]
        self._put(floats((RANGE, request.number, len(parts))) + b"".join(parts))

    def _write(self, request: Request) -> Any:
        values = request.facts.get("values")
        if not isinstance(values, dict):
            raise ValueRangeError("write: values is no object of paths and values")
        return self._station.at_board(self._station.desk.write, self.client, values)

    def _pulse(self, request: Request) -> Any:
        path, value = request.text("path"), request.facts.get("value", 1)
        return self._station.at_board(self._station.desk.pulse, self.client, path, value)

    def _clear(self, request: Request) -> Any:
        path = request.text("path")
        seen = self._station.feed.latest(path)
        return self._station.at_board(self._station.desk.clear, self.client, path, seen)

    def _arm(self, request: Request) -> Any:
        return self._station.at_board(self._station.desk.arm, self.client, request.count("stops"))

    def _take(self, request: Request) -> None:
        given = request.facts.get("seconds", LEASE_S)
        duration_s = Request("take", 0, {"seconds": given}).seconds("seconds", DURATION_MIN_S, DURATION_MAX_S)
        with self._station.desk.gate() as gate:
            gate.take(self.client, request.text("part"), duration_s, now())
        self._station.changed()

    def _release(self, request: Request) -> None:
        part = request.text("part")
        with self._station.desk.gate() as gate:
            for lease in gate.leases.of(self.client.number):
                if contains(part, lease.part):
                    gate.release(self.client, lease.part, now())
                    gate.wishes.keep(lease.part, "", now().steady_s)  # for who has asked first
        self._station.changed()

    def _ask(self, request: Request) -> None:
        """Tell who holds a part that this user wants it."""
        with self._station.desk.gate() as gate:
            gate.ask(self.client, request.text("part"), now())
        self._station.changed()

    def _break(self, request: Request) -> None:
        with self._station.desk.gate() as gate:
            gate.break_up(self.client, request.text("part"), now())
        self._station.changed()

    def _alive(self, _: Request) -> None:
        """A sign of life, which keeps the leases."""
        with self._station.desk.gate() as gate:
            gate.renew(self.client, now())

    # -- alarms and recordings

    def _acknowledge(self, request: Request) -> None:
        path = request.text("path")
        with self._station.desk.gate() as gate:
            gate.check_acknowledge(self.client, path, now())
            self._station.alarms.acknowledge(path, self.client.name)
            gate.note("acknowledge", self.client, now(), path=path)
        self._station.changed()

    async def _record(self, request: Request) -> None:
        await self._station.in_files(self._station.records.begin, self.client, request.text("format"))
        self._station.changed()

    async def _end_recording(self, _: Request) -> None:
        await self._station.in_files(self._station.records.end, self.client)
        self._station.changed()

    async def _delete_recording(self, request: Request) -> None:
        await self._station.in_files(self._station.records.remove, self.client, request.text("name"))

    async def _replay_begin(self, request: Request) -> None:
        """Read a recording, and tell what it has. Ranges with `replay` are of it from now on."""
        records, name = self._station.records, request.text("name")
        self._replay = await self._station.in_files(records.replay, self.client, name)
        self.tell({"replay": self._replay.told()})
