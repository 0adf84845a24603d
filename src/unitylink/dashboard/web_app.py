# SPDX-License-Identifier: BSD-3-Clause
"""The web application: the page, the log-in, the stop, and the socket of each viewer."""

from __future__ import annotations

import asyncio
import json
import time
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from unitylink.errors import AccessRefused, UnityLinkError
from unitylink.server.metrics import metrics
from unitylink.server.rate_limit import RateLimit
from unitylink.server.stop_switch import now

from .downloads import NO_SESSION, Downloads
from .page_files import page_files
from .sessions import IDLE_S, Session, Sessions
from .status_page import status_page
from .viewer import Viewer

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection

    from .station import Station

BODY_BYTES, BODY_S = 4096, 4.0  # of the only requests that have a body
LOGINS_HZ, LOGIN_BURST = 5.0, 20
NO_SERVER = "this page has no server behind it; `unitylink serve` has one"
NO_TOKEN = "/metrics wants a token: credentials_file in Prometheus' scrape_configs, under authorization"
BUSY = 1013  # the WebSocket code for "try again later"


class WebApp:
    """Answers all requests to one station. `most` is how many viewers there may be at the same time."""

    def __init__(self, station: Station, *, port: int, secure: bool, most: int) -> None:
        self.station = station
        self._sessions = Sessions()
        self.logins = RateLimit(LOGINS_HZ, LOGIN_BURST)
        self._cookie = f"unitylink_{port}"  # browsers send the cookies of one host to all its ports
        self._secure = secure
        self.most = most

    def routes(self) -> Starlette:
        """Return the application."""
        names = list(page_files())
        return Starlette(
            routes=[
                Route("/", self._file),
                *(Route(f"/{name}", self._file) for name in names if name != "index.html"),
                Route("/login", self._log_in, methods=["POST"]),
                Route("/logout", self._log_out, methods=["POST"]),
                Route("/stop", self._stop, methods=["POST"]),
                Route("/status", self._status),
                Route("/metrics", self._metrics),
                *Downloads(self.station, self._session).routes(),
                WebSocketRoute("/socket", self._socket),
            ]
        )

    async def _file(self, request: Request) -> Response:
        return page_files()[request.url.path.lstrip("/") or "index.html"].response(request)

    async def _status(self, request: Request) -> Response:
        session = self._session(request)
        if session is None:
            return PlainTextResponse(NO_SESSION, 401)
        if self.station.report is None:
            return PlainTextResponse(NO_SERVER, 404)
        report = await run_in_threadpool(self.station.report)  # it waits for the board's lock
        return HTMLResponse(status_page(report, session.client.name))

    async def _metrics(self, request: Request) -> Response:
        """Answer Prometheus, which shows a token with each request. It keeps no cookies."""
        if not self.logins.allow(time.monotonic()):
            return PlainTextResponse("too many log-ins; wait a second", 429)
        kind, _, token = request.headers.get("authorization", "").partition(" ")
        if kind.lower() != "bearer":
            return PlainTextResponse(NO_TOKEN, 401, {"www-authenticate": "Bearer"})
        try:
            with self.station.desk.gate() as gate:
                gate.user(token.strip(), _where(request), now())
        except AccessRefused as error:
            return PlainTextResponse(str(error), 403)
        if self.station.report is None:
            return PlainTextResponse(NO_SERVER, 404)
        report = await run_in_threadpool(self.station.report)
        return PlainTextResponse(metrics(report), media_type="text/plain; version=0.0.4; charset=utf-8")

    def _session(self, request: HTTPConnection) -> Session | None:
        return self._sessions.find(request.cookies.get(self._cookie, ""), time.monotonic())

    async def _log_in(self, request: Request) -> Response:
        if not self.logins.allow(time.monotonic()):
            return PlainTextResponse("too many log-ins; wait a second", 429)
        try:
            token = json.loads(await _body(request))["token"]
        except (ValueError, KeyError, TypeError, RecursionError):
            return PlainTextResponse('expected the JSON {"token": "..."}', 400)
        if not isinstance(token, str):
            return PlainTextResponse("the token is no text", 400)
        try:
            with self.station.desk.gate() as gate:
                client = gate.login(token, _where(request), now())
        except AccessRefused as error:
            return PlainTextResponse(str(error), 403)
        secret, ended = self._sessions.open(client, token, time.monotonic())
        self._end(*ended)
        answer = Response(status_code=204)
        answer.set_cookie(
            self._cookie,
            secret,
            max_age=round(IDLE_S),
            httponly=True,
            samesite="strict",
            secure=self._secure,
        )
        return answer

    async def _log_out(self, request: Request) -> Response:
        ended = self._sessions.close(request.cookies.get(self._cookie, ""))
        if ended is not None:
            self._end(ended)
            for viewer in list(self.station.viewers):
                if viewer.session is ended:
                    viewer.dismiss("you have logged out")
        answer = Response(status_code=204)
        answer.delete_cookie(self._cookie, httponly=True, samesite="strict", secure=self._secure)
        return answer

    def _end(self, *sessions: Session) -> None:
        with self.station.desk.gate() as gate:
            for session in sessions:
                gate.logout(session.client, now())

    async def _stop(self, request: Request) -> Response:
        """Stop the robot. This path shares nothing with the socket, and waits for no other request."""
        session = self._session(request)
        if session is None:
            return PlainTextResponse(NO_SESSION, 401)
        begun_s = time.monotonic()
        try:
            wrote = await self.station.at_once(self.station.desk.stop, session.client)
        except UnityLinkError as error:
            self.station.note("error", f"stop by {session.client.name}: {error}")
            return JSONResponse({"error": str(error)}, 502)
        finally:
            self.station.changed()
        self.station.note("stop", f"{session.client.name} has stopped the robot")
        return JSONResponse({"wrote": wrote, "seconds": round(time.monotonic() - begun_s, 4)})

    async def _socket(self, socket: WebSocket) -> None:
        session = self._session(socket)
        await socket.accept()  # a browser does not tell its page why a socket was not accepted
        if session is None:
            await _refuse(socket, 1008, NO_SESSION)
            return
        if len(self.station.viewers) >= self.most:
            await _refuse(socket, BUSY, f"there are {self.most} viewers; more are not served")
            return
        try:
            with self.station.desk.gate() as gate:
                client = gate.login(session.token, _where(socket), now())
        except AccessRefused as error:
            await _refuse(socket, 1008, str(error))
            return
        viewer = Viewer(socket, self.station, client, session)
        self.station.viewers.add(viewer)
        try:
            await viewer.run()
            await socket.close(1000)
        except (WebSocketDisconnect, RuntimeError, OSError):
            pass  # it has gone already
        finally:
            self.station.viewers.discard(viewer)
            with self.station.desk.gate() as gate:
                gate.gone(client, now())
            self.station.changed()


async def _refuse(socket: WebSocket, code: int, reason: str) -> None:
    try:
        await socket.send_json({"bye": reason})
        await socket.close(code)
    except (WebSocketDisconnect, RuntimeError, OSError):
        pass


async def _body(request: Request) -> bytes:
    """Return the body of a request. Raises ValueError if it is too long, or comes too slowly."""
    body = b""

    async def take() -> None:
        nonlocal body
        async for part in request.stream():
            body += part
            if len(body) > BODY_BYTES:
                raise ValueError("the body is too long")

    try:
        await asyncio.wait_for(take(), BODY_S)
    except asyncio.TimeoutError:
        raise ValueError("the body came too slowly") from None
    return body


def _where(request: HTTPConnection) -> str:
    return f"{request.client.host}:{request.client.port}" if request.client else "unknown"
