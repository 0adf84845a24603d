# SPDX-License-Identifier: BSD-3-Clause
"""Items by name, for strangers: a query without a payload reads, one with a request writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.errors import ProtocolError, UnityLinkError, UnknownName, ValueRangeError

from ..messages import WRITE_VALUE, Answer, Request
from .queries import Refused, payload_of

if TYPE_CHECKING:
    import zenoh

    from unitylink.server.gate import Client

    from ..schema import Field
    from .executor import Executor
    from .requests import Requests


class Values:
    """Answers queries of items. `fields` has the field of each item by its key."""

    def __init__(
        self, fields: dict[str, Field], executor: Executor, requests: Requests, reader: Client
    ) -> None:
        self._fields, self._executor, self._requests, self._reader = fields, executor, requests, reader
        self._pollable = {path for path, element in executor.robot.spec.walk() if element.pollable}

    def answer(self, query: zenoh.Query) -> object:
        """Answer one query, which may ask for many items by a wildcard."""
        key, data = str(query.key_expr), payload_of(query)
        if data:
            return self._write(query, key, data)
        if "*" in key:
            for one in matching(query, self._fields):
                if self._fields[one].path in self._pollable:
                    self._read(query, one)
            return None
        if key not in self._fields:
            raise UnknownName(f"{key}: there is no item of this name; the key `schema` has them all")
        self._read(query, key, alone=True)
        return None

    def _read(self, query: zenoh.Query, key: str, *, alone: bool = False) -> None:
        field = self._fields[key]
        try:
            query.reply(key, field.pack(self._executor.raw(self._reader, field.path)))
        except UnityLinkError:
            if alone:
                raise

    def _write(self, query: zenoh.Query, key: str, data: bytes) -> object:
        if "*" in key:
            raise Refused("wildcard", ValueRangeError(f"{key}: a write is for one item"))
        field = self._fields.get(key)
        if field is None:
            raise UnknownName(f"{key}: there is no item of this name; the key `schema` has them all")
        visit, request = self._requests.taken(data)
        if request.kind != WRITE_VALUE or len(request.body) != field.bytes:
            raise ProtocolError(f"{key}: expected a request to write {field.bytes} bytes, a {field.type}")
        return self._requests.answer_once(
            query, visit, request, lambda: self._written(visit.client, field, request)
        )

    def _written(self, client: Client, field: Field, request: Request) -> bytes:
        value = field.unpack(request.body)
        self._executor.write_value(client, field.path, value, request.deadline_ns)
        return Answer(request.id, 0).encode()


def matching(query: zenoh.Query, keys: dict[str, Field]) -> list[str]:
    """Return the keys for which a query asks."""
    import zenoh  # it is there, because a query has come

    return [key for key in keys if query.key_expr.intersects(zenoh.KeyExpr(key))]
