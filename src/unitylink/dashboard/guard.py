# SPDX-License-Identifier: BSD-3-Clause
"""What every request passes first: the lists of allowed hosts and origins, and the headers of every answer.

The name under which a browser has found the server must be on the list. So a foreign page cannot reach it by
a name that it lets point here (DNS rebinding). The origin of a request is that of the page that made it.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.websockets import WebSocketClose

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

HEADERS = {
    "content-security-policy": "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'self'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}


class Guard:
    """Wraps an application. `hosts` are the allowed values of the header Host, `scheme` http or https."""

    def __init__(self, app: ASGIApp, hosts: Iterable[str], scheme: str) -> None:
        self._app = app
        self._hosts = frozenset(host.lower() for host in hosts)
        self._origins = frozenset(f"{scheme}://{host}" for host in self._hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if reason := self.refusal(Headers(scope=scope)):
            if scope["type"] == "websocket":
                await WebSocketClose(code=1008, reason=reason)(scope, receive, send)
            else:
                await PlainTextResponse(reason, 403, headers=HEADERS)(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, with_headers)

    def refusal(self, headers: Headers) -> str:
        """Return why a request with these headers is refused, or "". A program sends no origin."""
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or hosts[0].lower() not in self._hosts:
            return "this server does not go by this name; start it with --name NAME"
        if any(origin.lower() not in self._origins for origin in origins):
            return "a page of another server made this request"
        return ""
