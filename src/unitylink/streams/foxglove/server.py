# SPDX-License-Identifier: BSD-3-Clause
"""The server for Foxglove, in a thread of its own: who is let in, and who gets which samples."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, urlsplit

from unitylink.dashboard.place import Place
from unitylink.errors import UnityLinkError
from unitylink.optional import absent
from unitylink.server.listening import HANDSHAKE_S, listen
from unitylink.server.rate_limit import RateLimit, SharedLimit

from ..hand import Hand
from .channels import Channel, Channels
from .conversation import BURST, REQUESTS_HZ, Conversation
from .wire import SUBPROTOCOLS

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.typing import Subprotocol

    from ..topic import Batches, Topic

MOST_HZ = 100.0  # messages a second of each channel
CLIENTS = 100
MESSAGE_BYTES = 64 * 1024  # of what a client sends
LOGINS_HZ, LOGIN_BURST = 5.0, 20
REFUSED, BUSY = 1008, 1013  # codes of WebSocket
_LOOK_S = 1.0  # between two looks whether tokens have expired
_HANDSHAKE_S, _PING_S, _SILENT_S, _CLOSING_S = 4.0, 5.0, 10.0, 1.0
_ROUNDS = 50  # that may wait for this thread


class Foxglove:
    """Serves the samples of a robot at `place` until `close`. `url` is where, without the token.

    A client shows its token in the URL: `ws://127.0.0.1:8765/?token=...`. Raises ToolError if the package
    `websockets` is absent, and UnityLinkError if nothing can listen there.
    """

    def __init__(self, hand: Hand, place: Place) -> None:
        try:
            import websockets.asyncio.server  # noqa: F401
        except ImportError:
            raise absent("websockets", "a server for Foxglove") from None
        self.hand = hand
        self.name = hand.robot.name
        self.channels = Channels()
        self.limits = SharedLimit(REQUESTS_HZ, BURST)
        self.session = str(time.time_ns() // 1_000_000)
        self.conversations: set[Conversation] = set()
        self._logins = RateLimit(LOGINS_HZ, LOGIN_BURST)
        self._tls: dict[str, Any] = {}
        if place.tls:
            self._tls = {"ssl": place.tls.context(), "ssl_handshake_timeout": HANDSHAKE_S}
        self._socket = listen(place.host, place.port, "--foxglove")
        self.url = place.url(self._socket.getsockname()[1]).replace("http", "ws", 1)
        self._waiting: deque[Batches] = deque(maxlen=_ROUNDS)
        self._told = False  # the thread has been told that something waits
        self._board = ThreadPoolExecutor(4, "unitylink-foxglove")
        self._apart = ThreadPoolExecutor(2, "unitylink-foxglove-stop")  # for nothing but stops
        self._loop = asyncio.new_event_loop()
        self._stop = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink foxglove", daemon=True)
        self._thread.start()

    # -- the samples, from the thread of the source

    def begin(self, topics: Sequence[Topic], _: object) -> None:
        self._soon(self._begin, list(topics))

    def take(self, batches: Batches) -> None:
        if batches:
            self._waiting.append(batches)
            if not self._told:
                self._told = True
                self._soon(self._take)

    def away(self, why: str) -> None:
        self._soon(self._away, why)

    def close(self) -> None:
        """End the server. Clients are told."""
        self._soon(self._stop.set)
        self._thread.join()
        for pool in (self._board, self._apart):
            pool.shutdown(wait=False, cancel_futures=True)

    def _soon(self, call: Callable[..., Any], *arguments: Any) -> None:
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(call, *arguments)

    # -- in the thread of the server

    async def at_board(self, call: Callable[..., Any], *arguments: Any) -> Any:
        """Do a call that waits for the board, beside the event loop."""
        return await asyncio.get_running_loop().run_in_executor(self._board, call, *arguments)

    async def at_once(self, call: Callable[..., Any], *arguments: Any) -> Any:
        """Do the same for a stop, whatever other calls wait."""
        return await asyncio.get_running_loop().run_in_executor(self._apart, call, *arguments)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        from websockets.asyncio.server import serve

        quiet = logging.getLogger("unitylink.foxglove.websockets")
        quiet.setLevel(logging.CRITICAL)  # what strangers send is no news
        offered = [_named(name) for name in SUBPROTOCOLS]
        async with serve(
            self._meet,
            sock=self._socket,
            subprotocols=offered,
            max_size=MESSAGE_BYTES,
            max_queue=16,
            compression=None,
            open_timeout=_HANDSHAKE_S,
            ping_interval=_PING_S,
            ping_timeout=_SILENT_S,
            close_timeout=_CLOSING_S,
            server_header=None,
            logger=quiet,
            **self._tls,
        ):
            while not self._stop.is_set():
                with suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(self._stop.wait(), _LOOK_S)
                for one in list(self.conversations):
                    if not self.hand.present(one.client):
                        one.end("your token has expired")

    async def _meet(self, connection: ServerConnection) -> None:
        """Serve one client until it goes."""
        assert connection.request is not None
        stops = self.hand.robot.switch.stops
        host, port = connection.remote_address[:2]
        token = parse_qs(urlsplit(connection.request.path).query).get("token", [""])[0]
        if len(self.conversations) >= CLIENTS:
            return await connection.close(BUSY, f"there are {CLIENTS} clients; more are not served")
        if not self._logins.allow(time.monotonic()):
            return await connection.close(BUSY, "too many log-ins; wait a second")
        try:
            client = await self.at_board(self.hand.login, token, f"{host}:{port}")
        except UnityLinkError as error:
            return await connection.close(REFUSED, str(error)[:120])
        conversation = Conversation(connection, self, client, stops)
        self.conversations.add(conversation)
        try:
            await conversation.run()
        finally:
            self.conversations.discard(conversation)
            await self.at_board(self.hand.logout, client)
        return None

    def _begin(self, topics: list[Topic]) -> None:
        self.channels.replace(topics)
        for one in self.conversations:
            one.advertise()

    def _away(self, why: str) -> None:
        for one in self.conversations:
            one.warn(f"{self.name} is away: {why}")

    def _take(self) -> None:
        self._told = False
        while self._waiting:
            for topic, batch in self._waiting.popleft().items():
                made: dict[Channel, list[tuple[float, bytes]]] = {}
                rows = list(batch.thinned(MOST_HZ))
                self.channels.newest[topic] = rows[-1]
                for one in self.conversations:
                    if (channel := self.channels.find(topic, one.rights)) is not None and one.listens(
                        channel
                    ):
                        if channel not in made:
                            made[channel] = [(time_s, channel.message(row)) for time_s, row in rows]
                        one.offer(channel, made[channel])
        for one in self.conversations:
            one.tell_parameters()


def _named(name: str) -> Subprotocol:
    from websockets.typing import Subprotocol

    return Subprotocol(name)
