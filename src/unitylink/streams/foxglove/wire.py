# SPDX-License-Identifier: BSD-3-Clause
"""The messages of Foxglove's WebSocket protocol: texts in JSON with the member `op`, and binary ones."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

from unitylink.errors import ValueRangeError, shown

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")  # the newer name, and that of older programs
INFO, WARNING, ERROR = 0, 1, 2  # levels of a status
_MESSAGE, _SERVICE_RESPONSE = 1, 3
_SERVICE_REQUEST = 2
_MOST_NUMBER = 0xFFFFFFFF
_MOST_LIST = 10_000


def text(op: str, **facts: Any) -> str:
    """Return a text message."""
    return json.dumps({"op": op, **facts}, allow_nan=False, separators=(",", ":"))


def status(level: int, message: str) -> str:
    """Return a message for the person at the tool."""
    return text("status", level=level, message=message)


def message_head(subscription: int, time_s: float) -> bytes:
    """Return what stands before the JSON of a sample."""
    return struct.pack("<BIQ", _MESSAGE, subscription, round(time_s * 1e9))


def service_response(service: int, call: int, answer: Any) -> bytes:
    """Return the answer of a service."""
    return struct.pack("<BIII", _SERVICE_RESPONSE, service, call, 4) + b"json" + json.dumps(answer).encode()


@dataclass(frozen=True)
class ServiceCall:
    """A call of a service. `request` is its JSON object."""

    service: int
    call: int
    request: Any


def read_text(message: str) -> dict[str, Any]:
    """Return the members of a text message. Raises ValueRangeError if it is none.

    >>> read_text('{"op": "subscribe", "subscriptions": []}')
    {'op': 'subscribe', 'subscriptions': []}
    """
    told = _json(message)
    if not isinstance(told, dict) or not isinstance(told.get("op"), str):
        raise ValueRangeError("the message is no JSON object with the text op")
    return told


def read_call(message: bytes) -> ServiceCall:
    """Return a call of a service. Its request is None if it is no JSON.

    Raises ValueRangeError if the message is no such call.
    """
    if message[:1] != bytes((_SERVICE_REQUEST,)) or len(message) < 13:
        raise ValueRangeError("this binary message is no service call")
    service, call, length = struct.unpack_from("<III", message, 1)
    encoding, payload = message[13 : 13 + length], message[13 + length :]
    try:
        request = _json(payload.decode()) if encoding == b"json" else None
    except ValueError:
        request = None
    return ServiceCall(service, call, request)


def number(told: dict[str, Any], name: str) -> int:
    """Return a member that is an id. Raises ValueRangeError if it is none."""
    given = told.get(name)
    if not isinstance(given, int) or isinstance(given, bool) or not 0 <= given <= _MOST_NUMBER:
        raise ValueRangeError(f"{name} is {shown(given)}; expected a whole number from 0 to {_MOST_NUMBER}")
    return given


def entries(told: dict[str, Any], name: str, kind: type) -> list[Any]:
    """Return a member that is a list of `kind`. Raises ValueRangeError if it is none."""
    given = told.get(name)
    if (
        not isinstance(given, list)
        or len(given) > _MOST_LIST
        or not all(isinstance(one, kind) for one in given)
    ):
        raise ValueRangeError(f"{told['op']}: {name} is no list of up to {_MOST_LIST} of the right type")
    return list(given)


def _json(data: str) -> Any:
    try:
        return json.loads(data, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise ValueRangeError("the message is no JSON") from None


def _refuse(_: str) -> float:
    raise ValueError("NaN and Infinity are no JSON")
