# SPDX-License-Identifier: BSD-3-Clause
"""The web server of a dashboard, in a thread of its own."""

from __future__ import annotations

import asyncio
import functools
import threading
from typing import TYPE_CHECKING

import uvicorn

from unitylink.server.listening import HANDSHAKE_S, listen

from .guard import Guard
from .listening import Protocol
from .place import Place
from .web_app import WebApp

if TYPE_CHECKING:
    from .station import Station

VIEWERS = 1000
MESSAGE_BYTES = 64 * 1024  # of what a viewer sends
CLOSING_S, ENDED_S = 1, 5.0


class Dashboard:
    """Serves the page of a station while the `with` block runs. `url` is where.

    Raises UnityLinkError if nothing can listen there.
    """

    def __init__(self, station: Station, place: Place | None = None, *, viewers: int = VIEWERS) -> None:
        self.station = station
        place = place if place is not None else Place()
        context = place.tls.context() if place.tls else None
        self._socket = listen(place.host, place.port, place.option)
        port = self._socket.getsockname()[1]
        self.url = place.url(port)
        self.app = WebApp(station, port=port, secure=place.scheme == "https", most=viewers)
        config = uvicorn.Config(
            Guard(self.app.routes(), place.hosts(port), place.scheme),
            http=Protocol,
            ws="websockets-sansio",
            ws_max_size=MESSAGE_BYTES,
            ws_per_message_deflate=False,
            ws_ping_interval=5.0,
            ws_ping_timeout=10.0,
            loop="asyncio",
            lifespan="off",
            log_config=None,
            log_level="error",
            access_log=False,
            proxy_headers=False,
            server_header=False,
            timeout_graceful_shutdown=CLOSING_S,
        )
        config.load()
        config.ssl = context
        self._server = uvicorn.Server(config)
        self._loop: asyncio.AbstractEventLoop | None = None
        self._stop: asyncio.Event | None = None
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink-dashboard", daemon=True)

    def __enter__(self) -> Dashboard:
        self._thread.start()
        self._started.wait()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the server. Viewers are told. It takes at most two seconds."""
        if self._loop is not None and self._stop is not None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._stop.set)
            self._thread.join(ENDED_S)
        self._socket.close()

    def _run(self) -> None:
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        if self._server.config.ssl is not None:  # uvicorn has no option for how long a handshake may take
            create = functools.partial(self._loop.create_server, ssl_handshake_timeout=HANDSHAKE_S)
            self._loop.create_server = create  # type: ignore[method-assign]
        rounds = asyncio.create_task(self.station.run(self._stop))
        serving = asyncio.create_task(self._server.serve(sockets=[self._socket]))
        self._started.set()
        await self._stop.wait()
        for viewer in list(self.station.viewers):
            viewer.dismiss("the server ends")
        await asyncio.sleep(0.15)
        self._server.should_exit = True
        await serving
        await rounds
