# SPDX-License-Identifier: BSD-3-Clause
"""A robot at a broker: values go out when they change, and commands come in if they are allowed."""

from __future__ import annotations

import logging
import queue
import socket
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnityLinkError, UnknownName, ValueRangeError
from unitylink.optional import absent
from unitylink.server.rate_limit import RateLimit

from .broker import Broker
from .discovery import COMMANDED, PRESS, Topics, command, discovery, payload

if TYPE_CHECKING:
    from paho.mqtt.client import Client as Paho
    from paho.mqtt.client import MQTTMessage

    from unitylink.layer4_data import Value
    from unitylink.server.gate import Client
    from unitylink.server.scopes import Rights

    from ..hand import Hand
    from ..topic import Batches, Topic, View

ROUND_S = 1.0  # between two messages of an item
UNSENT = 2000  # messages that may wait for the broker
COMMANDS_HZ, COMMANDS_BURST, COMMAND_BYTES = 20.0, 40, 1000
WAITING = 50  # commands
OLD_S = 1.0  # a command that has waited for so long is not executed
_KEEPALIVE_S, _RETRY_S, _END_S = 15, (1, 30), 1.0
_log = logging.getLogger("unitylink.streams")


class Mqtt:
    """Publishes what `rights` let it read, and takes commands for what they let it write.

    `token` is that of a user with these rights, as whom the commands pass the gate. While the broker is away,
    the library tries to reach it, and nothing else waits for it. Raises ToolError if paho-mqtt is absent.
    """

    def __init__(self, hand: Hand, broker: Broker, rights: Rights, token: str) -> None:
        try:
            from paho.mqtt.client import Client as Paho
            from paho.mqtt.enums import CallbackAPIVersion
        except ImportError:
            raise absent("paho-mqtt", "MQTT") from None
        self.broker = broker
        self._hand, self._rights, self._token = hand, rights, token
        self._topics = Topics(hand.robot.name)
        self._writes = {
            path
            for path, one in hand.elements.items()
            if one.access in COMMANDED and rights.allow("write", path)
        }
        self._lock = threading.Lock()  # guards what follows, up to the limit
        self._values: Mapping[str, Value[Any]] = {}
        self._views: dict[Topic, View] = {}
        self._newest: dict[str, Any] = {}
        self._sent: dict[str, str] = {}  # by path, what the broker has
        self._unsent = 0
        self._up = False
        self._limit = RateLimit(COMMANDS_HZ, COMMANDS_BURST)
        self._due_s = 0.0
        self._client: Client | None = None
        self._login = threading.Lock()
        self._commands: queue.Queue[tuple[float, str, str] | None] = queue.Queue(WAITING)
        self._said = ""
        paho = self._paho = Paho(CallbackAPIVersion.VERSION2, client_id="", clean_session=True)
        paho.on_connect, paho.on_disconnect = self._met, self._parted
        paho.on_message, paho.on_publish = self._heard, self._left
        paho.will_set(self._topics.status, "offline", qos=1, retain=True)
        paho.reconnect_delay_set(*_RETRY_S)
        if broker.user is not None:
            paho.username_pw_set(broker.user, broker.password)
        if broker.secure:
            paho.tls_set()
        self._stops: queue.Queue[str | None] = queue.Queue(1)  # a stop waits for no other command
        self._workers = [
            threading.Thread(target=work, name="unitylink mqtt", daemon=True)
            for work in (self._work, self._work_stops)
        ]
        for worker in self._workers:
            worker.start()
        paho.connect_async(broker.host, broker.port, _KEEPALIVE_S)
        paho.loop_start()

    # -- the samples, from the thread of the source

    def begin(self, topics: Sequence[Topic], values: Mapping[str, Value[Any]]) -> None:
        with self._lock:
            self._values = values
            self._views = {one: view for one in topics if (view := one.view(self._rights)) is not None}
            self._newest.clear()
            self._up = True
        self._introduce()

    def take(self, batches: Batches) -> None:
        with self._lock:
            for topic, batch in batches.items():
                if (view := self._views.get(topic)) is not None:
                    row = batch.rows[-1]
                    self._newest.update(zip(view.paths, view.plain(row), strict=True))
            if time.monotonic() < self._due_s or not self._paho.is_connected() or self._unsent > UNSENT:
                return
            self._due_s = time.monotonic() + ROUND_S
            for path, value in self._newest.items():
                text = payload(value)
                if self._sent.get(path) != text:
                    self._sent[path] = text
                    self._publish(self._topics.state(path), text, retain=True)

    def away(self, why: str) -> None:
        with self._lock:
            self._up = False
            if self._paho.is_connected():
                self._publish(self._topics.status, "offline", retain=True)

    def close(self) -> None:
        """Say that the robot is offline, and end."""
        taken = False
        if self._paho.is_connected():
            last = self._paho.publish(self._topics.status, "offline", qos=1, retain=True)
            with suppress(RuntimeError, ValueError):  # the connection ends just now
                last.wait_for_publish(_END_S)
                taken = last.is_published()
        self._paho.disconnect()
        port = self._paho.socket()
        if not taken and isinstance(port, socket.socket):  # the broker reads no more, and has the will
            with suppress(OSError):
                port.shutdown(socket.SHUT_RDWR)
        self._paho.loop_stop()
        self._commands.put(None)
        self._stops.put(None)
        for worker in self._workers:
            worker.join()
        if self._client is not None:
            self._hand.logout(self._client)

    # -- the broker, in the thread of the library

    def _publish(self, topic: str, text: str, *, retain: bool) -> None:
        """Publish. Hold the lock."""
        self._unsent += 1
        self._paho.publish(topic, text, qos=0, retain=retain)

    def _left(self, *_: object) -> None:
        with self._lock:
            self._unsent = max(0, self._unsent - 1)

    def _met(self, paho: Paho, _: object, __: object, reason: Any, ___: object) -> None:
        if reason.is_failure:
            self._say(f"{self.broker} refuses the connection: {reason}")
            return
        self._say(f"{self.broker} is there")
        if self._writes:
            paho.subscribe([(self._topics.command(path), 0) for path in sorted(self._writes)])
            paho.subscribe(self._topics.stop, 0)
        self._introduce()

    def _parted(self, _: object, __: object, ___: object, reason: Any, ____: object) -> None:
        with self._lock:
            self._unsent = 0
        if reason.is_failure:
            self._say(f"{self.broker} is gone: {reason}; it is tried again")

    def _introduce(self) -> None:
        """Tell all that a broker does not know of us: the items, and then that we are there."""
        with self._lock:
            self._sent.clear()
            if not self._up or not self._paho.is_connected():
                return
            read = {path for view in self._views.values() for path in view.paths}
            spec, robot = self._hand.robot.spec, self._topics.robot
            for topic, text in discovery(spec, robot, self._values, read, self._writes):
                self._publish(topic, text, retain=True)
            self._publish(self._topics.status, "online", retain=True)

    def _heard(self, _: object, __: object, message: MQTTMessage) -> None:
        """Take a command. Those that the broker has kept are set-points of the past, and are not executed."""
        if message.retain:
            self._refuse(message.topic, "a retained command is not executed; publish it without retain")
        elif len(message.payload) > COMMAND_BYTES:
            self._refuse(message.topic, f"a command has at most {COMMAND_BYTES} bytes")
        elif message.topic != self._topics.stop and not self._limit.allow(time.monotonic()):
            self._refuse(message.topic, f"more than {COMMANDS_HZ:g} commands a second; wait a moment")
        else:
            text = message.payload.decode("utf-8", "replace")
            if message.topic == self._topics.stop:
                with suppress(queue.Full):  # then another stop is about to begin
                    self._stops.put_nowait(text)
                return
            try:
                self._commands.put_nowait((time.monotonic(), message.topic, text))
            except queue.Full:
                self._refuse(message.topic, "too many commands wait for the board")

    # -- commands, in a thread of their own

    def _work(self) -> None:
        while (waiting := self._commands.get()) is not None:
            came_s, topic, text = waiting
            if time.monotonic() - came_s > OLD_S:
                self._refuse(topic, f"it waited for more than {OLD_S:g} s, and is not executed any more")
            else:
                self._do(topic, text)

    def _work_stops(self) -> None:
        while self._stops.get() is not None:
            try:
                self._hand.stop(self._me())
            except UnityLinkError as error:
                self._refuse(self._topics.stop, str(error))

    def _me(self) -> Client:
        """Return the user as whom commands pass the gate. Raises UnityLinkError if the board is away."""
        with self._login:
            if self._client is None or not self._hand.present(self._client):
                self._client = self._hand.login(self._token, str(self.broker))
            return self._client

    def _do(self, topic: str, text: str) -> None:
        try:
            path = next((one for one in self._writes if self._topics.command(one) == topic), None)
            if path is None:  # a broker may send what nobody has asked for
                raise UnknownName("there is no such command")
            element = self._hand.elements[path]
            if element.access == "PULSE":
                if text.strip() != PRESS:
                    raise ValueRangeError(f"{path}: expected {PRESS}")
                self._hand.pulse(self._me(), path)
            else:
                with self._lock:
                    value = self._values.get(path)
                if value is None:
                    raise UnityLinkError("the board has not come yet")
                self._hand.write(self._me(), {path: command(value, text)})
                with self._lock:
                    self._sent.pop(path, None)  # the next round says what it is now
        except UnityLinkError as error:
            self._refuse(topic, str(error))

    def _refuse(self, topic: str, why: str) -> None:
        with self._lock:
            self._sent.clear()  # so that a tool which shows the command shows the truth again
            if self._unsent <= UNSENT and self._paho.is_connected():
                self._publish(self._topics.error, f"{topic}: {why}", retain=False)

    def _say(self, text: str) -> None:
        """Log what happens at the broker, but not the same again and again."""
        if text != self._said:
            self._said = text
            _log.warning("MQTT: %s", text)
