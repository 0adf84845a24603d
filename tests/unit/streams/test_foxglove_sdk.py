# SPDX-License-Identifier: BSD-3-Clause
"""The same conversation with our server and that of Foxglove's own SDK: the messages have one form."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import foxglove
from foxglove.websocket import (
    Capability,
    MessageSchema,
    Parameter,
    ServerListener,
    Service,
    ServiceRequest,
    ServiceSchema,
)
from unit.streams.streamed import still, streaming
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from unitylink.dashboard.place import Place
from unitylink.streams.foxglove.server import Foxglove
from unitylink.streams.hand import Hand

TOPIC = "/arm/100_hz"
SCHEMA = {"type": "object", "title": "unitylink.arm.100_hz", "properties": {"position": {"type": "number"}}}


class _Listener(ServerListener):
    def on_get_parameters(self, *_: Any) -> list[Parameter]:
        return [Parameter("power", value=3)]

    def on_set_parameters(self, _: Any, parameters: list[Parameter], *__: Any) -> list[Parameter]:
        return parameters


@contextmanager
def theirs() -> Iterator[tuple[str, Callable[[], None]]]:
    """Serve one channel and one service by the SDK. Yield its URL, and a function that sends a sample."""

    def write(request: ServiceRequest) -> bytes:
        if b"target" not in request.payload:
            raise ValueError("the robot has no such item")
        return b'{"wrote": 1}'

    def schema(name: str) -> MessageSchema:
        data = foxglove.Schema(name=name, encoding="jsonschema", data=b'{"type": "object"}')
        return MessageSchema(encoding="json", schema=data)

    described = ServiceSchema("unitylink.set", request=schema("request"), response=schema("response"))
    context = foxglove.Context()
    server = foxglove.start_server(
        name="arm",
        port=0,
        capabilities=[Capability.Services, Capability.Parameters],
        supported_encodings=["json"],
        services=[Service("/arm/set", schema=described, handler=write)],
        server_listener=_Listener(),
        context=context,
    )
    channel = foxglove.Channel(TOPIC, schema=SCHEMA, context=context)
    try:
        yield f"ws://127.0.0.1:{server.port}", lambda: channel.log({"position": 1}, log_time=10**18)
    finally:
        server.stop()


@contextmanager
def ours() -> Iterator[tuple[str, Callable[[], None]]]:
    with still() as one:
        server = Foxglove(Hand(one.robot), Place())
        with streaming(one, server):
            yield f"{server.url}/?token=all", lambda: None


def form(message: Any) -> Any:
    """Return the names and types of a message, without its values. A list has the form of its first entry."""
    if isinstance(message, dict):
        return {name: form(value) for name, value in message.items()}
    if isinstance(message, list):
        return [form(message[0])] if message and isinstance(message[0], dict) else []
    return type(message).__name__


def converse(url: str, sample: Callable[[], None]) -> dict[str, Any]:
    """Do what Foxglove does, and return what came, by its kind."""
    came: dict[str, Any] = {}

    def until(socket: ClientConnection, kind: str) -> Any:
        while kind not in came:
            message = socket.recv(timeout=15)
            if isinstance(message, str):
                told = json.loads(message)
                came[told["op"]] = told
            else:
                came[f"binary {message[0]}"] = message
        return came[kind]

    def ask(socket: ClientConnection, op: str, **facts: Any) -> None:
        socket.send(json.dumps({"op": op, **facts}))

    with connect(url, subprotocols=[Subprotocol("foxglove.sdk.v1")], compression=None) as socket:
        came["subprotocol"] = socket.subprotocol
        services = until(socket, "advertiseServices")["services"]
        (service,) = (one["id"] for one in services if one["name"] == "/arm/set")
        while TOPIC not in {one["topic"] for one in until(socket, "advertise")["channels"]}:
            came.pop("advertise")
        (channel,) = (one["id"] for one in came["advertise"]["channels"] if one["topic"] == TOPIC)
        ask(socket, "subscribe", subscriptions=[{"id": 7, "channelId": channel}])
        ask(socket, "getParameters", parameterNames=["power"], id="one")
        came["got"] = until(socket, "parameterValues")
        sample()
        until(socket, "binary 1")
        for number, request in ((5, b'{"target": 1}'), (6, b'{"none": 1}')):
            socket.send(struct.pack("<BIII", 2, service, number, 4) + b"json" + request)
        until(socket, "binary 3")
        until(socket, "serviceCallFailure")
        del came["parameterValues"]
        ask(socket, "setParameters", parameters=[{"name": "power", "value": 4}], id="two")
        until(socket, "parameterValues")
        ask(socket, "advertise", channels=[{"id": 1, "topic": "/x", "encoding": "json", "schemaName": ""}])
        until(socket, "status")
    return came


def test_the_messages_are_those_of_the_sdk() -> None:
    with theirs() as (url, sample):
        expected = converse(url, sample)
    with ours() as (url, sample):
        found = converse(url, sample)
    assert found["subprotocol"] == expected["subprotocol"] == "foxglove.sdk.v1"
    assert found["serverInfo"]["capabilities"] == expected["serverInfo"]["capabilities"]
    assert found["serverInfo"]["supportedEncodings"] == expected["serverInfo"]["supportedEncodings"]
    for kind in ("advertise", "advertiseServices", "parameterValues", "serviceCallFailure", "status"):
        assert form(found[kind]) == form(expected[kind]), kind
    assert {**form(found["serverInfo"]), "metadata": 0} == {**form(expected["serverInfo"]), "metadata": 0}
    for told in (found, expected):
        opcode, subscription, time_ns = struct.unpack_from("<BIQ", told["binary 1"])
        assert (opcode, subscription) == (1, 7) and 9 * 10**17 < time_ns < 9 * 10**18
        assert json.loads(told["binary 1"][13:]).keys() == {"position"}
        _, _, call, length = struct.unpack_from("<BIII", told["binary 3"])
        assert (call, told["binary 3"][13 : 13 + length]) == (5, b"json")
        assert json.loads(told["binary 3"][13 + length :]) == {"wrote": 1}
        assert told["serviceCallFailure"]["callId"] == 6
        assert told["parameterValues"]["parameters"] == [{"name": "power", "value": 4}]
        assert (told["parameterValues"]["id"], told["status"]["level"]) == ("two", 2)
