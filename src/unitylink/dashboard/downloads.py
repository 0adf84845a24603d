# SPDX-License-Identifier: BSD-3-Clause
"""The files that a browser may save: what charts show, recordings, and the shape of the robot."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Route

from unitylink.errors import AccessRefused, UnityLinkError, UnknownName
from unitylink.server.stop_switch import now

from .csv_text import csv_lines
from .mcap_export import mcap_bytes
from .requests import MOST_SERIES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .sessions import Session
    from .station import Station

NO_SESSION = "log in with the token that the server has printed"
KINDS = {".csv": "text/csv; charset=utf-8", ".mcap": "application/octet-stream"}


class Downloads:
    """Answers the requests for files. `session` finds who asks. The work is done beside the event loop."""

    def __init__(self, station: Station, session: Callable[[Request], Session | None]) -> None:
        self._station = station
        self._session = session

    def routes(self) -> Iterator[Route]:
        """Yield the routes."""
        yield Route("/csv", self._with_session(self._csv))
        yield Route("/mcap", self._with_session(self._mcap))
        yield Route("/recordings", self._with_session(self._list))
        yield Route("/recordings/{name}", self._with_session(self._recording))
        yield Route("/body", self._with_session(self._body))
        yield Route("/body/{number:int}", self._with_session(self._mesh))

    def _with_session(
        self, answer: Callable[[Request, Session], Awaitable[Response]]
    ) -> Callable[[Request], Awaitable[Response]]:
        async def guarded(request: Request) -> Response:
            session = self._session(request)
            if session is None:
                return PlainTextResponse(NO_SESSION, 401)
            try:
                return await answer(request, session)
            except AccessRefused as error:
                return PlainTextResponse(str(error), 403)
            except UnknownName as error:
                return PlainTextResponse(str(error), 404)
            except UnityLinkError as error:
                return PlainTextResponse(str(error), 409)

        return guarded

    def _chosen(self, request: Request, session: Session) -> list[Any] | Response:
        """Return the wanted items with their samples, copied now, before more of them come."""
        asked = request.query_params
        tracks = self._station.feed.by_path
        try:
            begin_s, end_s = float(asked["begin_s"]), float(asked["end_s"])
            chosen = [tracks[path] for path in asked.getlist("item")[:MOST_SERIES]]
        except (ValueError, KeyError) as error:
            return PlainTextResponse(f"expected item=NAME, begin_s and end_s: {error}", 400)
        with self._station.desk.gate() as gate:
            for track in chosen:
                gate.check_read(session.client, track.value.path, now())
        return [(track.value, track.history.samples(begin_s, end_s)) for track in chosen]

    async def _csv(self, request: Request, session: Session) -> Response:
        found = self._chosen(request, session)
        if isinstance(found, Response):
            return found
        text = await self._station.in_files(lambda: "".join(csv_lines(found)))
        return _saved(text.encode(), "values.csv")

    async def _mcap(self, request: Request, session: Session) -> Response:
        found = self._chosen(request, session)
        if isinstance(found, Response):
            return found
        origin, since_1970_s = self._station.records.origin, self._station.since_1970_s()
        data = await self._station.in_files(mcap_bytes, found, origin, since_1970_s)
        return _saved(data, "values.mcap")

    async def _list(self, _: Request, session: Session) -> Response:
        records = self._station.records
        records.check_see(session.client)
        found = await self._station.in_files(records.shelf.all)
        return JSONResponse([one.told() for one in found], headers={"cache-control": "no-store"})

    async def _recording(self, request: Request, session: Session) -> Response:
        records = self._station.records
        records.check_see(session.client)
        path = await self._station.in_files(records.whole, request.path_params["name"])
        kind = KINDS[path.suffix.lower()]
        return FileResponse(path, media_type=kind, filename=path.name, headers={"cache-control": "no-store"})

    async def _body(self, _: Request, __: Session) -> Response:
        body = self._station.body
        if body is None:
            raise UnknownName("the server knows no shape of this robot; start it with --urdf FILE")
        return JSONResponse(body.told())

    async def _mesh(self, request: Request, _: Session) -> Response:
        body, number = self._station.body, request.path_params["number"]
        if body is None or number >= len(body.meshes):
            raise UnknownName("there is no such mesh")
        return Response(body.meshes[number].triangles, media_type="application/octet-stream")


def _saved(data: bytes, name: str) -> Response:
    return Response(
        data,
        media_type=KINDS["." + name.rpartition(".")[2]],
        headers={"content-disposition": f'attachment; filename="{name}"', "cache-control": "no-store"},
    )
