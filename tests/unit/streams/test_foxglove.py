# SPDX-License-Identifier: BSD-3-Clause
"""Foxglove's side of the WebSocket protocol, over real sockets to a served board."""

from __future__ import annotations

import itertools
import json
import random
import socket
import struct
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from unit.server.held_wire import HeldWire, held
from unit.streams.streamed import Served, still, streaming, until
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from unitylink.dashboard.desk import Desk
from unitylink.dashboard.place import Place
from unitylink.errors import DeadManTripped, LeaseHeld, UnityLinkError
from unitylink.server.rate_limit import RateLimit
from unitylink.server.stop_switch import now
from unitylink.streams.foxglove.server import Foxglove
from unitylink.streams.hand import Hand

SDK = Subprotocol("foxglove.sdk.v1")


class Robot:
    """A served board with a server for Foxglove."""

    def __init__(self, one: Served, foxglove: Foxglove) -> None:
        self.one, self.foxglove = one, foxglove

    def client(self, token: str = "all", url: str | None = None) -> Client:
        return Client(f"{url or self.foxglove.url}/?token={token}")

    def register(self, address: int) -> int:
        return self.one.board.registers[address]


class Client:
    """What Foxglove does: it keeps what it is told. `samples` are (subscription, time in s, message)."""

    socket: ClientConnection

    def __init__(self, url: str) -> None:
        self._connection = connect(url, subprotocols=[SDK], compression=None)
        self.told: dict[str, dict[str, Any]] = {}
        self.channels: dict[str, dict[str, Any]] = {}
        self.samples: list[tuple[int, float, dict[str, Any]]] = []
        self.answers: dict[int, Any] = {}
        self.news: list[list[dict[str, Any]]] = []  # of parameters, for which nobody asked

    def __enter__(self) -> Client:
        self.socket = self._connection.__enter__()
        try:
            self.until(lambda: "advertiseServices" in self.told)
        except BaseException:
            self._connection.__exit__(None, None, None)
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._connection.__exit__(None, None, None)

    def until(self, done: Any, limit_s: float = 15.0) -> Any:
        end_s = time.monotonic() + limit_s
        while not (found := done()):
            left_s = end_s - time.monotonic()
            assert left_s > 0, f"it did not come: {self.told}"
            self._take(self.socket.recv(timeout=left_s))
        return found

    def _take(self, message: str | bytes) -> None:
        if isinstance(message, str):
            told = json.loads(message)
            self.told[told["op"]] = told
            if told["op"] == "parameterValues" and "id" not in told:
                self.news.append(told["parameters"])
            if told["op"] == "advertise":
                self.channels |= {one["topic"]: one for one in told["channels"]}
            if told["op"] == "serviceCallFailure":
                self.answers[told["callId"]] = told["message"]
        elif message[0] == 1:
            _, subscription, time_ns = struct.unpack_from("<BIQ", message)
            self.samples.append((subscription, time_ns / 1e9, json.loads(message[13:])))
        else:
            _, _, call, length = struct.unpack_from("<BIII", message)
            self.answers[call] = json.loads(message[13 + length :])

    def say(self, op: str, **facts: Any) -> None:
        self.told.pop("status", None)
        self.socket.send(json.dumps({"op": op, **facts}))

    def subscribe(self, topic: str, subscription: int = 7) -> None:
        self.until(lambda: topic in self.channels)
        one = {"id": subscription, "channelId": self.channels[topic]["id"]}
        self.say("subscribe", subscriptions=[one])

    def send(self, what: str, request: Any, number: int = 5) -> None:
        services = self.told["advertiseServices"]["services"]
        (service,) = (one["id"] for one in services if one["name"] == f"/arm/{what}")
        self.answers.pop(number, None)
        self.socket.send(struct.pack("<BIII", 2, service, number, 4) + b"json" + json.dumps(request).encode())

    def call(self, what: str, request: Any, number: int = 5) -> Any:
        """Call a service, and return its answer, or the text of the failure."""
        self.send(what, request, number)
        self.until(lambda: number in self.answers)
        return self.answers[number]

    def status(self) -> str:
        return str(self.until(lambda: self.told.get("status"))["message"])


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    with still() as one:
        foxglove = Foxglove(Hand(one.robot), Place())
        foxglove._logins = RateLimit(1000, 1000)
        with streaming(one, foxglove):
            yield Robot(one, foxglove)


def test_channels_with_units_and_their_samples(robot: Robot) -> None:
    robot.one.board.registers[0x12] = 0xFFFFFFFF - 41
    with robot.client("looks") as client:
        info = client.told["serverInfo"]
        assert info["name"] == "arm" and "clientPublish" not in info["capabilities"]
        client.subscribe("/arm/100_hz")
        client.until(lambda: len(client.samples) >= 30)
        channel = client.channels["/arm/100_hz"]
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        position = json.loads(channel["schema"])["properties"]["position"]
        assert position == {"type": "number", "description": "in deg"}
        assert {sample[0] for sample in client.samples} == {7}
        assert all(message == {"position": -42} for _, _, message in client.samples)
        times_s = [time_s for _, time_s, _ in client.samples]
        assert times_s == sorted(set(times_s)) and abs(times_s[-1] - time.time()) < 60
        client.say("unsubscribe", subscriptionIds=[7])
        client.subscribe("/arm/read_5_hz", 8)
        client.until(lambda: client.samples[-1][0] == 8)
        assert client.samples[-1][2].keys() >= {"power", "other", "mode"}


def test_who_comes_late_gets_the_newest_sample(robot: Robot) -> None:
    with robot.client("looks") as early:
        early.subscribe("/arm/on_change")
        robot.one.board.registers[0x14] = 55
        early.until(lambda: early.samples and early.samples[-1][2] == {"alarm": 55})
        with robot.client("looks") as late:  # nothing changes any more
            late.subscribe("/arm/on_change")
            assert late.until(lambda: late.samples)[0][2] == {"alarm": 55}
    left = until(lambda: [line for line in robot.one.lines if '"logout"' in line and '"looks"' in line])
    assert left, "the gate knows that they have gone"


def test_a_stop_waits_for_no_write(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    held, go_on = threading.Event(), threading.Event()
    with robot.client() as client:
        assert client.call("set", {"target": 30}) == {"wrote": 1}

        def hangs(*_: Any) -> int:
            held.set()
            go_on.wait(15)
            return 0

        monkeypatch.setattr(robot.foxglove.hand, "write", hangs)
        client.socket.send(struct.pack("<BIII", 2, 1, 40, 4) + b'json{"target": 40}')
        assert held.wait(10)
        assert client.call("stop", {}) == {"wrote": 2}
        assert robot.register(0x1A) == 0 and 40 not in client.answers
        go_on.set()
        client.until(lambda: 40 in client.answers)
        monkeypatch.undo()
        assert client.call("arm", {}) == {}


def test_a_reader_sees_his_part_alone(robot: Robot) -> None:
    with robot.client("part") as client:
        client.subscribe("/arm/read_5_hz")
        client.until(lambda: client.samples)
        (channel,) = client.channels.values()
        assert json.loads(channel["schema"])["properties"].keys() == {"power"} == client.samples[0][2].keys()


def test_services_write_and_leave_no_lease(robot: Robot) -> None:
    with robot.client() as client, robot.one.link() as program:
        assert client.call("set", {"target": -12.5, "power": 7, "mode": "run"}) == {"wrote": 3}
        assert (robot.register(0x1A), robot.register(0x1B), robot.register(0x1C)) == (0xFF83, 7, 3)
        program.write(0x1A, 5)  # the part is free again
        assert "holds the write lease of target" in client.call("set", {"target": 1, "power": 8})
        assert (robot.register(0x1A), robot.register(0x1B)) == (5, 7), "nothing of it is written"
        assert client.call("pulse", {"path": "reset"}) == {}
        services = client.told["advertiseServices"]["services"]
        (schema,) = (json.loads(one["request"]["schema"]) for one in services if one["name"] == "/arm/set")
        assert schema["properties"]["target"] == {"type": "number", "description": "in deg"}
    written = [json.loads(line)["values"] for line in robot.one.lines if '"event": "write"' in line]
    assert {"target": -12.5, "power": 7, "mode": "run"} in written


@pytest.mark.parametrize(
    ("what", "request_", "said"),
    [
        ("set", {"target": 91}, "is not in -90 to 90 deg"),
        ("set", {"targt": 1}, "nothing to write at 'targt'"),
        ("set", {"target": {"x": 1}}, "target"),
        ("set", {"position": 1}, "nothing to write at 'position'"),
        ("set", {}, "1 to 1000"),
        ("set", [1], "no JSON object"),
        ("pulse", {"path": "target"}, "not what can be done"),
        ("pulse", {"path": ["x"]}, "no item"),
    ],
)
def test_what_cannot_be_written(robot: Robot, what: str, request_: Any, said: str) -> None:
    with robot.client() as client:
        assert said in client.call(what, request_)


def test_without_the_scope_nothing_is_written(robot: Robot) -> None:
    robot.one.board.registers[0x1B] = 3
    with robot.client("looks") as client:
        assert "the token needs the scope `write power.*`" in client.call("set", {"power": 9})
        assert "scope `write reset.*`" in client.call("pulse", {"path": "reset"})
        assert "scope `arm`" in client.call("arm", {})
        client.say("setParameters", parameters=[{"name": "power", "value": 9}], id="a")
        assert "scope `write power.*`" in client.status()
    assert robot.register(0x1B) == 3


def test_a_stop_holds_all_until_somebody_arms(robot: Robot) -> None:
    with robot.client("looks") as looks, robot.client() as client:
        assert client.call("set", {"target": 50}) == {"wrote": 1}
        assert looks.call("stop", {}) == {"wrote": 2}, "who may look may stop"
        assert robot.register(0x1A) == 0
        assert "looks has stopped the robot" in client.call("set", {"target": 50})
        until(lambda: client.call("arm", {}) == {})  # when it is sure that this client knows of the stop
        until(lambda: client.call("set", {"target": 50}) == {"wrote": 1})


def test_an_arm_that_its_line_holds_up_does_not_end_a_later_stop(robot: Robot) -> None:
    wire = HeldWire(robot.foxglove.url)
    try:
        with robot.client(url=wire.url.replace("tcp", "ws")) as client, robot.client("looks") as looks:
            with held(wire):
                client.send("arm", {})
                until(lambda: wire.waits)
                assert looks.call("stop", {}) == {"wrote": 2}
            client.until(lambda: client.answers)
            assert "after this was asked for; if it may move, arm it again" in client.answers[5]
            assert robot.one.robot.report()["stopped_by"] == "looks"
            until(lambda: client.call("arm", {}) == {})
            assert client.call("stop", {}) == {"wrote": 2}
            assert client.call("arm", {}) == {}, "it knows of its own stop"
    finally:
        wire.close()


def test_a_write_that_a_stop_overtakes_is_refused_by_the_board(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The write is held up, the stop is done meanwhile, and the write reaches the board after it."""
    hand = robot.foxglove.hand
    person, other = hand.login("all", "test"), hand.login("looks", "test")
    real = Desk.write

    def late(desk: Desk, client: Any, values: Any) -> None:
        with desk.gate() as gate:
            gate.check_write(client, "target", now())
        hand.stop(other)
        until(lambda: not robot.one.robot.report()["leases"])
        desk.robot["target"].write(40)  # type: ignore[union-attr]

    monkeypatch.setattr(Desk, "write", late)
    with pytest.raises(DeadManTripped):
        hand.write(person, {"target": 40})
    assert robot.register(0x1A) == 0
    monkeypatch.setattr(Desk, "write", real)
    hand.arm(person, hand.robot.switch.stops)
    hand.logout(person)
    hand.logout(other)


def test_parameters(robot: Robot) -> None:
    robot.one.board.registers[0x1B], robot.one.board.registers[0x1C] = 11, 3
    with robot.client() as client:

        def values() -> dict[str, Any]:
            client.told.pop("parameterValues", None)
            client.say("getParameters", parameterNames=[], id="all")
            told = client.until(lambda: client.told.get("parameterValues"))
            assert told["id"] == "all"
            return {one["name"]: one["value"] for one in told["parameters"]}

        until(lambda: values() == {"power": 11, "mode": "run"})
        client.say("subscribeParameterUpdates", parameterNames=["power"])
        client.say("setParameters", parameters=[{"name": "power", "value": 12}], id="b")
        client.until(lambda: client.told["parameterValues"].get("id") == "b")
        assert robot.register(0x1B) == 12
        news = [{"name": "power", "value": 12}]
        client.until(lambda: news in client.news)  # before the answer or after it
        client.say("setParameters", parameters=[{"name": "target", "value": 1}])
        assert "no parameter 'target'" in client.status()


@pytest.mark.parametrize("token", ["wrong", ""])
def test_nobody_comes_in_without_a_token(robot: Robot, token: str) -> None:
    with pytest.raises(ConnectionClosed) as closed, robot.client(token):
        pass
    assert closed.value.rcvd is not None and closed.value.rcvd.code == 1008
    assert "does not know this token" in closed.value.rcvd.reason


def test_another_subprotocol_is_refused(robot: Robot) -> None:
    url = f"{robot.foxglove.url}/?token=all"
    with pytest.raises(InvalidStatus), connect(url, subprotocols=[Subprotocol("chat")]):
        pass


def test_garbage_gets_an_answer_or_the_end_and_others_go_on(robot: Robot) -> None:
    rng = random.Random(21)
    texts = [
        "",
        "{",
        "[]",
        '{"op":3}',
        '{"op":"advertise","channels":[]}',
        '{"op":"subscribe"}',
        '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}',
        '{"op":"fetchAsset"}',
        '{"op":"setParameters","parameters":[{"name":["x"],"value":NaN}]}',
        "[" * 5000,
        '{"op":"getParameters","parameterNames":[1]}',
        '{"op":"unsubscribe","subscriptionIds":["a"]}',
    ]
    with robot.client("looks") as calm, robot.client() as wild:
        calm.subscribe("/arm/100_hz")
        for said in texts:
            wild.told.pop("status", None)
            wild.socket.send(said)
            assert wild.status()
        for _ in range(60):
            kind = rng.choice([1, 2, 2, 2, 3, 255])
            wild.socket.send(bytes([kind]) + rng.randbytes(rng.randrange(40)))
        wild.subscribe("/arm/100_hz", 9)
        wild.until(lambda: wild.samples)
        with pytest.raises(ConnectionClosed):
            wild.socket.send("x" * 100_000)
            while True:
                wild.socket.recv(timeout=10)
        before = len(calm.samples)
        calm.until(lambda: len(calm.samples) > before + 10)


@pytest.mark.takes(4)
def test_a_reader_that_stops_is_dropped_and_nobody_waits(robot: Robot) -> None:
    with robot.client("looks") as calm, socket.create_connection(("127.0.0.1", port_of(robot))) as stuck:
        stuck.sendall(
            b"GET /?token=looks HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
            b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
        )
        until(lambda: len(robot.foxglove.conversations) == 2)
        known = {one._connection.remote_address[1]: one for one in robot.foxglove.conversations}
        silent = known[stuck.getsockname()[1]]
        calm.subscribe("/arm/100_hz")
        calm.until(lambda: calm.samples)
        channels = robot.foxglove.channels.all(silent.rights)
        channel = next(one for one in channels if one.view.topic.name == "/arm/100_hz")
        silent._subscriptions[channel.number] = 1
        robot.foxglove._soon(silent.offer, channel, [(0.0, b"x" * 1000)] * 1999)  # more than the kernel keeps
        calm.samples.clear()
        begun_s = time.monotonic()
        calm.until(lambda: silent not in robot.foxglove.conversations, limit_s=20)
        took_s = time.monotonic() - begun_s
        times_s = [time_s for _, time_s, _ in calm.samples]
        gaps_s = [later - time_s for time_s, later in itertools.pairwise(times_s)]
        assert silent.left_out > 0 and len(calm.samples) > 50 * took_s
        assert max(gaps_s) < 1.0, "the other one gets all samples meanwhile"


def port_of(robot: Robot) -> int:
    return int(robot.foxglove.url.rpartition(":")[2])


def test_an_address_that_is_in_use(robot: Robot) -> None:
    with pytest.raises(UnityLinkError, match=r"--foxglove 127\.0\.0\.1:.*choose another port"):
        Foxglove(robot.foxglove.hand, Place(port=port_of(robot)))


def test_a_program_and_foxglove_respect_each_other(robot: Robot) -> None:
    with robot.client() as client, robot.one.link() as program:
        program.write(0x1B, 1)
        assert "holds the write lease" in client.call("set", {"power": 2})
        assert client.call("set", {"mode": "off"}) == {"wrote": 1}
        program.write(0x1C, 3)
        with pytest.raises(LeaseHeld), robot.one.link() as third:
            third.write(0x1C, 1)
