# SPDX-License-Identifier: BSD-3-Clause
"""A served board at a real broker, and a person there."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paho.mqtt.client import Client as Paho
from paho.mqtt.client import MQTTMessage
from paho.mqtt.enums import CallbackAPIVersion
from unit.streams.streamed import EVERYTHING, Served, still, streaming, until

from unitylink.cli import main
from unitylink.errors import UnityLinkError
from unitylink.server.rate_limit import RateLimit
from unitylink.server.scopes import Rights
from unitylink.streams.hand import Hand
from unitylink.streams.mqtt.broker import Broker, read_broker
from unitylink.streams.mqtt.robot import Mqtt

MOVES = Rights.of(["read", "write"])
MOSQUITTO = shutil.which("mosquitto", path=f"{os.environ['PATH']}:/usr/sbin")


class Mosquitto:
    """A broker of our own, at a port that stays while it is ended and started again."""

    def __init__(self, folder: Path) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        assert MOSQUITTO is not None, "mosquitto is absent: tools/setup.sh system"
        passwords = folder / "passwords"
        tool = shutil.which("mosquitto_passwd", path=f"{os.environ['PATH']}:/usr/sbin")
        assert tool is not None
        subprocess.run([tool, "-b", "-c", str(passwords), "ana", "secret"], check=True)
        passwords.chmod(0o644)
        self._file = folder / "mosquitto.conf"
        self._file.write_text(
            f"listener {self.port} 127.0.0.1\nallow_anonymous false\npassword_file {passwords}\nuser root\n"
        )
        self.running: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        assert MOSQUITTO is not None
        self.running = subprocess.Popen(
            [MOSQUITTO, "-c", str(self._file)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        until(self._there)

    def _there(self) -> bool:
        try:
            socket.create_connection(("127.0.0.1", self.port), timeout=1).close()
        except OSError:
            return False
        return True

    def end(self) -> None:
        if self.running is not None:
            self.running.kill()
            self.running.wait()
            self.running = None

    @property
    def address(self) -> Broker:
        return Broker("127.0.0.1", self.port, False, "ana", "secret")


class Person:
    """Somebody at the broker. `kept` has the newest text by topic, `came` all (topic, text, retained)."""

    def __init__(self, paho: Paho) -> None:
        self.paho = paho
        self.kept: dict[str, str] = {}
        self.came: list[tuple[str, str, bool]] = []
        paho.on_message = self._take

    def _take(self, _: object, __: object, message: MQTTMessage) -> None:
        self.came.append((message.topic, message.payload.decode(), message.retain))
        self.kept[message.topic] = message.payload.decode()

    def say(self, topic: str, text: str, *, retain: bool = False) -> None:
        self.paho.publish(f"unitylink/arm/{topic}", text, qos=1, retain=retain).wait_for_publish(5)

    def until(self, topic: str, text: str) -> None:
        until(lambda: self.kept.get(f"unitylink/arm/{topic}") == text)

    def error(self) -> str:
        """Return the next complaint."""
        return str(until(lambda: self.kept.pop("unitylink/arm/error", "")))


@pytest.fixture(scope="module")
def broker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Mosquitto]:
    one = Mosquitto(tmp_path_factory.mktemp("broker"))
    one.start()
    yield one
    one.end()


@pytest.fixture(scope="module")
def one() -> Iterator[Served]:
    with still() as all_of_it:
        yield all_of_it


@contextmanager
def person(broker: Mosquitto) -> Iterator[Person]:
    paho = Paho(CallbackAPIVersion.VERSION2)
    paho.username_pw_set("ana", "secret")
    met = threading.Event()
    paho.on_connect = lambda *_: met.set()
    somebody = Person(paho)
    paho.connect("127.0.0.1", broker.port)
    paho.loop_start()
    try:
        assert met.wait(10)
        paho.subscribe("#", 1)
        yield somebody
    finally:
        paho.disconnect()
        paho.loop_stop()


@contextmanager
def at(broker: Mosquitto, one: Served, rights: Rights = MOVES, token: str = "all") -> Iterator[Mqtt]:
    mqtt = Mqtt(Hand(one.robot), broker.address, rights, token)
    mqtt._limit = RateLimit(1000, 1000)
    with streaming(one, mqtt):
        yield mqtt


def test_values_are_kept_and_the_last_word_is_offline(broker: Mosquitto, one: Served) -> None:
    one.board.registers[0x12], one.board.registers[0x1C] = 0xFFFFFFFF - 41, 3
    with person(broker) as early:
        with at(broker, one, EVERYTHING):
            early.until("status", "online")
            early.until("position", "-42")
            with person(broker) as late:  # the broker has kept them
                late.until("position", "-42")
                late.until("mode", "run")
                assert ("unitylink/arm/mode", "run", True) in late.came
            one.board.registers[0x12] = 7
            early.until("position", "7")
            count = sum(topic.endswith("/position") for topic, _, _ in early.came)
            assert count < 20, "it is not sent a hundred times a second"
            fresh = [topic for topic, _, retained in early.came if topic.endswith("/other") and not retained]
            assert len(fresh) == 1, "what does not change is sent once"
        early.until("status", "offline")


def test_home_assistant_is_told_of_each_item(broker: Mosquitto, one: Served) -> None:
    with person(broker) as ana, at(broker, one):
        ana.until("status", "online")
        said = {topic: text for topic, text in ana.kept.items() if topic.startswith("homeassistant/")}
    configs = {topic: json.loads(text) for topic, text in said.items() if text}
    kinds = {topic.split("/")[1]: told for topic, told in configs.items()}
    by_name = {told["name"]: (topic.split("/")[1], told) for topic, told in configs.items()}
    assert {name: kind for name, (kind, _) in by_name.items()} == {
        "position": "sensor",
        "other": "sensor",
        "alarm": "sensor",
        "target": "number",
        "power": "number",
        "mode": "select",
        "open": "switch",
        "reset": "button",
        "stop": "button",
    }
    target = by_name["target"][1]
    assert (target["min"], target["max"], target["step"]) == (-90, 90, 0.1)
    assert target["unit_of_measurement"] == "°"
    assert target["command_topic"] == "unitylink/arm/target/set"
    assert kinds["select"]["options"] == ["off", "run"]
    assert len({told["unique_id"] for told in configs.values()}) == len(configs)
    with person(broker) as ana, at(broker, one, EVERYTHING, "looks"):  # who may only read sees sensors alone
        ana.until("status", "online")
        until(lambda: not ana.kept["homeassistant/number/unitylink_arm_target/config"])
        kinds_now = {topic.split("/")[1] for topic, text in ana.kept.items() if text and "/config" in topic}
        assert kinds_now == {"sensor", "binary_sensor"}
    for told in configs.values():
        assert told["availability_topic"] == "unitylink/arm/status"
        assert told["device"]["identifiers"] == ["unitylink_arm"]


def test_commands_pass_the_gate_and_leave_no_lease(broker: Mosquitto, one: Served) -> None:
    with person(broker) as ana, at(broker, one), one.link() as program:
        ana.until("status", "online")
        ana.say("target/set", "12.5")
        until(lambda: one.board.registers[0x1A] == 125)
        ana.say("mode/set", "run")
        ana.say("open/set", "ON")
        ana.say("reset/set", "PRESS")
        until(lambda: (one.board.registers[0x1C], one.board.registers[0x1D]) == (3, 1))
        until(lambda: not one.robot.report()["leases"])
        program.write(0x1A, 5)
        ana.say("target/set", "20")
        assert "holds the write lease of target" in ana.error()
        assert one.board.registers[0x1A] == 5
    assert any(json.loads(line).get("values") == {"target": 12.5} for line in one.lines)


@pytest.mark.parametrize(
    ("topic", "text", "said"),
    [
        ("target/set", "91", "is not in -90 to 90 deg"),
        ("target/set", "NaN", "target"),
        ("target/set", "fast", "target"),
        ("power/set", "[" * 900, "power"),
        ("power/set", "9" * 2000, "at most 1000 bytes"),
        ("mode/set", "fly", "mode"),
        ("open/set", "perhaps", "open"),
        ("reset/set", "1", "expected PRESS"),
    ],
)
def test_what_is_wrong_is_said(broker: Mosquitto, one: Served, topic: str, text: str, said: str) -> None:
    before = [one.board.registers[address] for address in (0x1A, 0x1B, 0x1C, 0x1D)]
    with person(broker) as ana, at(broker, one):
        ana.until("status", "online")
        ana.say(topic, text)
        assert said in ana.error()
    assert [one.board.registers[address] for address in (0x1A, 0x1B, 0x1C, 0x1D)] == before


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner, max_size=3),
)
WORDS = st.sampled_from(["on", "OFF", "run", "PRESS", "NaN", "1e400", "-0", "0x12", "9" * 999, "[" * 999])
COMMANDS = (WORDS | st.text(max_size=40) | JSON.map(json.dumps)).map(
    lambda text: text.encode("utf-8", "replace")
)


def test_no_command_is_too_strange(broker: Mosquitto, one: Served) -> None:
    names = ["target", "power", "mode", "open", "reset", "position", "", "+", "#", "\ud800"]

    with at(broker, one) as mqtt:
        until(lambda: mqtt._values and mqtt._paho.is_connected())
        mqtt._client = None
        refused: list[str] = []
        mqtt._refuse = lambda topic, why: refused.append(why)  # type: ignore[method-assign]

        @settings(max_examples=300, deadline=None, derandomize=True, database=None)
        @given(st.sampled_from(names), COMMANDS | st.binary(max_size=40))
        def try_it(name: str, sent: bytes) -> None:
            told = len(refused)
            mqtt._do(mqtt._topics.command(name), sent.decode("utf-8", "replace"))
            if name not in ("target", "power", "mode", "open", "reset"):
                assert len(refused) == told + 1
            word = one.board.registers[0x1A] & 0xFFFF
            assert abs((word ^ 0x8000) - 0x8000) <= 900, "outside of the limits of the spec"
            assert one.board.registers[0x1C] in (0, 3), "no value of the enum"

        try_it()


def test_a_kept_command_is_never_executed(broker: Mosquitto, one: Served) -> None:
    one.board.registers[0x1B] = 1
    with person(broker) as ana:
        ana.say("power/set", "99", retain=True)
        try:
            with at(broker, one):
                assert "a retained command is not executed" in ana.error()
                ana.until("status", "online")  # the board has come
                ana.say("power/set", "3")
                until(lambda: one.board.registers[0x1B] == 3)
        finally:
            ana.say("power/set", "", retain=True)


def test_without_the_scope_nothing_is_taken(broker: Mosquitto, one: Served) -> None:
    one.board.registers[0x1A] = one.board.registers[0x1B] = 1
    with person(broker) as ana:
        with at(broker, one, EVERYTHING, "looks"):
            ana.until("status", "online")
            ana.say("target/set", "5")
            ana.say("stop", "PRESS")
            time.sleep(0.3)
            assert (one.board.registers[0x1A], one.robot.report()["leases"]) == (1, [])
        with at(broker, one, Rights.of(["read", "write target"]), "moves"):
            ana.until("status", "online")
            ana.say("power/set", "5")
            ana.say("target/set", "5")
            until(lambda: one.board.registers[0x1A] == 50)
            assert one.board.registers[0x1B] == 1


def test_the_stop_waits_for_nothing(broker: Mosquitto, one: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    held, go_on = threading.Event(), threading.Event()
    with person(broker) as ana, at(broker, one) as mqtt:
        ana.until("status", "online")
        ana.say("target/set", "5")
        until(lambda: one.board.registers[0x1A] == 50)

        def hangs(*_: Any) -> int:
            held.set()
            go_on.wait(10)
            return 0

        monkeypatch.setattr(mqtt._hand, "write", hangs)
        ana.say("target/set", "6")
        assert held.wait(10)
        ana.say("stop", "PRESS")
        until(lambda: one.board.registers[0x1A] == 0)
        go_on.set()
        monkeypatch.undo()
        ana.say("target/set", "7")
        assert "has stopped the robot" in ana.error()
        until(lambda: one.robot.switch._over == one.robot.switch._begun)  # else the stop wins against the arm
        mqtt._hand.arm(mqtt._me(), mqtt._hand.robot.switch.stops)


def test_a_broker_that_dies_and_comes_back(tmp_path: Path, one: Served) -> None:
    broker = Mosquitto(tmp_path)
    broker.start()
    try:
        one.board.registers[0x13] = 77
        with at(broker, one), one.link() as program:
            with person(broker) as ana:
                ana.until("status", "online")
                ana.until("other", "77")
            broker.end()
            assert program.read(0x50) == 0
            one.board.registers[0x12] = 1234
            broker.start()
            with person(broker) as ana:
                ana.until("position", "1234")
                ana.until("status", "online")
                ana.until("other", "77")  # it has not changed, but the new broker does not know it
    finally:
        broker.end()


def test_a_broker_that_reads_nothing_holds_nobody_up(one: Served) -> None:
    """It accepts, agrees, and never reads again. Messages for it are limited, and a program goes on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(10)
        dead = Mosquitto.__new__(Mosquitto)
        dead.port = server.getsockname()[1]
        with at(dead, one) as mqtt, one.link() as program:
            taken, _ = server.accept()
            with taken:
                taken.recv(1000)
                taken.sendall(b"\x20\x02\x00\x00")
                until(mqtt._paho.is_connected)
                mqtt.begin([], {})
                for number in range(20_000):
                    mqtt._newest["position"] = f"{number}" + "x" * 500
                    mqtt._due_s = 0.0
                    mqtt.take({})
                assert mqtt._unsent <= 2002
                assert program.read(0x50) == 0


@pytest.mark.parametrize(
    ("url", "said"),
    [
        ("http://home", "expected mqtt://[USER@]HOST[:PORT]"),
        ("mqtt://", "expected mqtt://"),
        ("mqtt://home:99999", "--mqtt"),
        ("mqtt://ana:secret@home", "leave the password out of the URL"),
        ("mqtt://home/topic", "expected mqtt://"),
    ],
)
def test_what_is_no_broker(url: str, said: str) -> None:
    with pytest.raises(UnityLinkError) as refused:
        read_broker(url)
    assert said in str(refused.value) and "secret" not in str(refused.value)


def test_the_password(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "password"
    file.write_text("from file\n")
    monkeypatch.setenv("UNITYLINK_MQTT_PASSWORD", "from environment")
    assert read_broker("mqtt://ana@home").password == "from environment"
    assert read_broker("mqtt://ana@home", str(file)).password == "from file"
    assert "from" not in repr(read_broker("mqtt://ana@home"))
    wrong = (("mqtt://home", str(file), "names no user"), ("mqtt://a@b", "/absent", "/absent"))
    for url, path, said in wrong:
        with pytest.raises(UnityLinkError, match=said):
            read_broker(url, path)


def test_the_command_says_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text("public arm() { @a = 0x10: u16 READ(); }")
    assert main(["serve", f"sim:{spec}", str(spec), "--mqtt-password-file", "x", "--check-config"]) != 0
    assert "add --mqtt, too" in capsys.readouterr().err
    assert main(["serve", f"sim:{spec}", str(spec), "--mqtt", "home", "--check-config"]) != 0
    assert "expected mqtt://" in capsys.readouterr().err
