# SPDX-License-Identifier: BSD-3-Clause
"""One client of the server for Foxglove: what it asks for, and what it is sent.

Nothing waits for a client that is slow. Beyond a limit its samples are left out, and it is told how many.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections import deque
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

from unitylink.errors import UnityLinkError, ValueRangeError, shown
from unitylink.recording.json_messages import schema_of
from unitylink.server.rate_limit import RateLimit, SharedLimit
from unitylink.values import Quantity

from ..hand import pulses, set_points
from ..topic import like
from .wire import (
    ERROR,
    WARNING,
    ServiceCall,
    entries,
    message_head,
    number,
    read_call,
    read_text,
    service_response,
    status,
    text,
)

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

    from unitylink.server.gate import Client

    from ..hand import Hand
    from .channels import Channel, Channels

REQUESTS_HZ, BURST = 100.0, 200
_LOOK_S = 0.1  # between two looks whether somebody has stopped the robot
WAITING = 50  # requests that wait for the board
SAMPLES_WAITING, TEXTS_WAITING = 2000, 500
_CAPABILITIES = ["services", "parameters", "parametersSubscribe"]
_SET, _PULSE, _STOP, _ARM = 1, 2, 3, 4  # numbers of the services


class Host(Protocol):
    """What a conversation needs of the server."""

    hand: Hand
    name: str  # of the robot
    channels: Channels
    limits: SharedLimit  # of users
    session: str  # another one means that all that was known of the server is void

    async def at_board(self, call: Callable[..., Any], *arguments: Any) -> Any: ...
    async def at_once(self, call: Callable[..., Any], *arguments: Any) -> Any: ...


class Conversation:
    """Serves a client that is logged in. `run` ends when it goes. All runs in the thread of the server."""

    def __init__(self, connection: ServerConnection, server: Host, client: Client, stops: int) -> None:
        """`stops` is `StopSwitch.stops` from before the client could ask for anything."""
        self.client, self.rights = client, client.user.rights
        self.left_out = 0  # samples, since the last time that the client was told
        self._connection, self._server = connection, server
        self._limits = (RateLimit(REQUESTS_HZ, BURST), server.limits.of(client.name))
        self._waiting: deque[str | bytes] = deque()
        self._wake = asyncio.Event()
        self._ended = ""
        self._channels: dict[int, Channel] = {}  # those that were advertised
        self._subscriptions: dict[int, int] = {}  # channel: the number that the client gave
        settings = [path for path, one in server.hand.elements.items() if one.access == "READWRITE"]
        self._parameters = [path for path in settings if self.rights.allow("read", path)]
        self._requests: asyncio.Queue[tuple[Callable[[Any], Awaitable[None]], Any]] = asyncio.Queue(WAITING)
        self._known_stops = self._told_stops = stops  # what the client knew when it sent what comes now
        self._stops: set[asyncio.Task[None]] = set()
        self._watched: dict[str, Any] = {}  # parameters, with what the client was last told
        self._do: dict[str, Callable[[dict[str, Any]], None]] = {
            "subscribe": self._subscribe,
            "unsubscribe": self._unsubscribe,
            "getParameters": self._get_parameters,
            "setParameters": lambda told: self._later(self._set_parameters, told),
            "subscribeParameterUpdates": self._watch,
            "unsubscribeParameterUpdates": self._unwatch,
        }

    async def run(self) -> None:
        self._tell(
            text(
                "serverInfo",
                name=self._server.name,
                capabilities=_CAPABILITIES,
                supportedEncodings=["json"],
                metadata={"unitylink": self.client.name},
                sessionId=self._server.session,
            )
        )
        self.advertise()
        self._tell(text("advertiseServices", services=self._services()))
        jobs = [
            asyncio.create_task(job()) for job in (self._listen, self._send, self._work, self._follow_stops)
        ]
        try:
            await asyncio.wait(jobs, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for job in jobs:
                job.cancel()
            await asyncio.gather(*jobs, return_exceptions=True)
            with suppress(Exception):  # it has gone already
                await self._connection.close(1008 if self._ended else 1000, self._ended)

    # -- what it is sent

    def advertise(self) -> None:
        """Tell the client which channels there are now."""
        channels = {channel.number: channel for channel in self._server.channels.all(self.rights)}
        if gone := sorted(self._channels.keys() - channels.keys()):
            self._tell(text("unadvertise", channelIds=gone))
            for one in gone:
                self._subscriptions.pop(one, None)
        fresh = [channel.description() for one, channel in channels.items() if one not in self._channels]
        if fresh:
            self._tell(text("advertise", channels=fresh))
        self._channels = channels

    def listens(self, channel: Channel) -> bool:
        """Tell whether the client wants the samples of a channel."""
        return channel.number in self._subscriptions

    def offer(self, channel: Channel, samples: list[tuple[float, bytes]]) -> None:
        """Send samples, if the client has taken enough of those before."""
        if len(self._waiting) + len(samples) > SAMPLES_WAITING:
            self.left_out += len(samples)
            return
        if self.left_out:
            self.warn(f"{self.left_out} samples were left out, because this client takes them too slowly")
            self.left_out = 0
        subscription = self._subscriptions[channel.number]
        self._waiting.extend(message_head(subscription, time_s) + data for time_s, data in samples)
        self._wake.set()

    def tell_parameters(self) -> None:
        """Tell the client which of its parameters have changed."""
        if not self._watched:
            return
        values = self._server.channels.values(self.rights)
        changed = {
            path: values[path]
            for path, old in self._watched.items()
            if path in values and values[path] != old
        }
        if changed:
            self._watched |= changed
            self._tell(text("parameterValues", parameters=_parameters(changed)))

    def warn(self, message: str) -> None:
        self._tell(status(WARNING, message))

    def end(self, reason: str) -> None:
        """End the conversation. The client is told why."""
        self._ended = reason
        self._wake.set()

    def _tell(self, message: str) -> None:
        if len(self._waiting) < SAMPLES_WAITING + TEXTS_WAITING:
            self._waiting.append(message)
        self._wake.set()

    async def _send(self) -> None:
        while not self._ended:
            await self._wake.wait()
            self._wake.clear()
            while self._waiting and not self._ended:
                await self._connection.send(self._waiting.popleft())

    def _services(self) -> list[dict[str, Any]]:
        """Return the services: what a client may do, if its token lets it."""
        hand, name = self._server.hand, self._server.name
        writable = set_points(hand.elements)
        values = {path: like(Quantity.of(one)) for path, one in writable.items()}
        units = {path: one.unit for path, one in writable.items()}
        nothing: dict[str, Any] = {"type": "object"}
        made = [(_STOP, "stop", nothing), (_ARM, "arm", nothing)]
        if writable:
            made.append((_SET, "set", schema_of(values, units)))
        if strobes := pulses(hand.elements):
            chosen: dict[str, Any] = {"path": {"type": "string", "enum": strobes}}
            made.append((_PULSE, "pulse", {"type": "object", "properties": chosen}))
        return [
            {
                "id": one,
                "name": f"/{name}/{what}",
                "type": f"unitylink.{what}",
                "request": _schema(f"unitylink.{what}.request", schema),
                "response": _schema(f"unitylink.{what}.response", {"type": "object"}),
            }
            for one, what, schema in made
        ]

    # -- what it asks for

    async def _listen(self) -> None:
        async for message in self._connection:
            try:
                for limit in self._limits:
                    if not limit.allow(time.monotonic()):
                        raise ValueRangeError(f"more than {limit.rate_hz:g} requests a second; wait a moment")
                if isinstance(message, bytes):
                    call = read_call(message)
                    if call.service == _ARM:
                        self._later(self._arm, (call, self._known_stops))
                    elif call.service == _STOP:  # waits for no other request
                        self._stops.add(task := asyncio.create_task(self._serve(call)))
                        task.add_done_callback(self._stops.discard)
                    else:
                        self._later(self._serve, call)
                    continue
                told = read_text(message)
                if told["op"] not in self._do:
                    raise ValueRangeError(f"this server does not do {shown(told['op'])}")
                self._do[told["op"]](told)
            except UnityLinkError as error:
                self._tell(status(ERROR, str(error)))

    def _later(self, do: Callable[[Any], Awaitable[None]], request: Any) -> None:
        """Do a request that waits for the board after those that came before it."""
        try:
            self._requests.put_nowait((do, request))
        except asyncio.QueueFull:
            raise ValueRangeError("too many requests wait for the board") from None

    async def _work(self) -> None:
        while True:
            do, request = await self._requests.get()
            try:
                await do(request)
            except UnityLinkError as error:
                self._tell(status(ERROR, str(error)))

    def _subscribe(self, told: dict[str, Any]) -> None:
        for one in entries(told, "subscriptions", dict):
            subscription, channel = number(one, "id"), number(one, "channelId")
            if channel not in self._channels:
                raise ValueRangeError(f"there is no channel {channel}")
            if subscription in self._subscriptions.values() or channel in self._subscriptions:
                raise ValueRangeError(f"subscription {subscription} or channel {channel} is in use")
            self._subscriptions[channel] = subscription
            known = self._channels[channel]
            if (newest := self._server.channels.newest.get(known.view.topic)) is not None:
                self.offer(known, [(newest[0], known.message(newest[1]))])

    def _unsubscribe(self, told: dict[str, Any]) -> None:
        ended = set(entries(told, "subscriptionIds", int))
        self._subscriptions = {
            channel: one for channel, one in self._subscriptions.items() if one not in ended
        }

    def _named(self, told: dict[str, Any]) -> list[str]:
        """Return the parameters that a message names. No name means all."""
        names = entries(told, "parameterNames", str)
        return [path for path in self._parameters if not names or path in names]

    def _get_parameters(self, told: dict[str, Any]) -> None:
        self._answer(told, self._named(told))

    async def _set_parameters(self, told: dict[str, Any]) -> None:
        values = {}
        for one in entries(told, "parameters", dict):
            name = one.get("name")
            if name not in self._parameters:
                raise ValueRangeError(f"there is no parameter {shown(name)}")
            values[str(name)] = one.get("value")
        try:
            await self._server.at_board(self._server.hand.write, self.client, values)
        except UnityLinkError:
            self._answer(told, list(values))  # as they are
            raise
        if "id" in told:
            self._tell(text("parameterValues", parameters=_parameters(values), id=str(told["id"])))

    def _answer(self, told: dict[str, Any], paths: list[str]) -> None:
        values = self._server.channels.values(self.rights)
        known = {path: values[path] for path in paths if path in values}
        id_ = {"id": str(told["id"])} if "id" in told else {}
        self._tell(text("parameterValues", parameters=_parameters(known), **id_))

    def _watch(self, told: dict[str, Any]) -> None:
        self._watched = dict.fromkeys(self._named(told)) | self._watched

    def _unwatch(self, told: dict[str, Any]) -> None:
        ended = self._named(told)
        self._watched = {path: old for path, old in self._watched.items() if path not in ended}

    async def _follow_stops(self) -> None:
        while True:
            await self._tell_stops()
            await asyncio.sleep(_LOOK_S)

    async def _tell_stops(self) -> None:
        """Find out whether the client knows of the last stop: what follows its pong was sent after that.

        So an `arm` that the network holds up does not end a stop that has come meanwhile.
        """
        if (stops := self._server.hand.robot.switch.stops) == self._told_stops:
            return
        self._told_stops = stops

        def known(pong: asyncio.Future[Any]) -> None:
            if not pong.cancelled() and pong.exception() is None:
                self._known_stops = stops

        waiter = await self._connection.ping()
        asyncio.ensure_future(waiter).add_done_callback(known)

    async def _arm(self, asked: tuple[ServiceCall, int]) -> None:
        call, stops = asked
        await self._serve(call, stops)

    async def _serve(self, call: ServiceCall, stops: int = 0) -> None:
        """Do what a service call asks for, and answer it."""
        server, request = self._server, call.request
        try:
            if not isinstance(request, dict):
                raise ValueRangeError("the request is no JSON object")
            answer: dict[str, Any] = {}
            if call.service == _SET:
                answer = {"wrote": await server.at_board(server.hand.write, self.client, request)}
            elif call.service == _PULSE:
                await server.at_board(server.hand.pulse, self.client, str(request.get("path")))
            elif call.service == _STOP:
                answer = {"wrote": await server.at_once(server.hand.stop, self.client)}
                with suppress(Exception):  # it has gone
                    await self._tell_stops()
            elif call.service == _ARM:
                await server.at_board(server.hand.arm, self.client, stops)
            else:
                raise ValueRangeError(f"there is no service {call.service}")
        except UnityLinkError as error:
            failed = {"serviceId": call.service, "callId": call.call, "message": str(error)}
            self._tell(text("serviceCallFailure", **failed))
            return
        self._waiting.append(service_response(call.service, call.call, answer))
        self._wake.set()


def _schema(name: str, schema: dict[str, Any]) -> dict[str, Any]:
    return {
        "encoding": "json",
        "schemaName": name,
        "schemaEncoding": "jsonschema",
        "schema": json.dumps(schema, separators=(",", ":")),
    }


def _parameters(values: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {"name": path, "value": value, **({"type": "float64"} if isinstance(value, float) else {})}
        for path, value in values.items()
    ]
