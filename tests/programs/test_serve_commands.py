# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve` and `unitylink dashboard` as programs: their pages and their streams."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from unit.dashboard.robot import TEXT, Log
from unit.dashboard.robot import Robot as Page
from unit.streams.test_foxglove import Client
from unit.streams.test_mqtt import Mosquitto, person
from unit.streams.test_plotjuggler import packet


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[Mosquitto]:
    one = Mosquitto(tmp_path)
    one.start()
    yield one
    one.end()


@pytest.fixture
def receiver() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("127.0.0.1", 0))
        yield there


def test_they_serve_the_page(tmp_path: Path) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text(TEXT)
    places = ["--listen", "127.0.0.1:0"]
    serving = ["serve", f"sim:{spec}", str(spec), *places, "--page", "0"]
    for arguments in serving, ["dashboard", f"sim:{spec}", *places]:
        command = [sys.executable, "-m", "unitylink", *arguments, "--json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            assert running.stdout is not None and running.stderr is not None
            told = json.loads(running.stdout.readline())
            page = Page(None, None, None, Log())  # type: ignore[arg-type]
            page.host = (told.get("page") or told["url"]).partition("//")[2]
            assert page.request("POST", "/login", {"token": told["token"]})[0] == 204
            assert page.request("GET", "/")[0] == 200
            running.send_signal(signal.SIGTERM)
            assert running.wait(20) == 0, running.stderr.read()
            assert "Traceback" not in running.stderr.read()


def test_plotjuggler_gets_what_it_may_read(tmp_path: Path, receiver: socket.socket) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text(
        "public arm() { @a = 0x10: u16 READ(PUBLISH(50 Hz)); @b = 0x11: u16 READ(PUBLISH(50 Hz)); }"
    )
    to = f"127.0.0.1:{receiver.getsockname()[1]}"
    places = ["--listen", "127.0.0.1:0", "--plotjuggler", to, "--may", "plotjuggler", "read a"]
    command = [sys.executable, "-m", "unitylink", "serve", f"sim:{spec}", str(spec), *places]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            receiver.settimeout(60)
            assert packet(receiver)["arm"].keys() == {"a"}
        finally:
            running.terminate()
        said, errors = running.communicate(timeout=20)
    assert f"to PlotJuggler:  udp {to}" in said and running.returncode == 0
    assert "Traceback" not in errors


def test_the_url_for_foxglove_reads_only(tmp_path: Path) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text("public arm() { @a = 0x10: u16 READ(PUBLISH(50 Hz)); @b = 0x11: u16 READWRITE(); }")
    places = ["--listen", "127.0.0.1:0", "--foxglove", "0", "--plotjuggler", "127.0.0.1:9"]
    command = [sys.executable, "-m", "unitylink", "serve", f"sim:{spec}", str(spec), *places]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        url = next(line.split()[-1] for line in running.stdout if line.startswith("for Foxglove:"))
        with Client(url) as client:
            client.subscribe("/arm/50_hz")
            client.until(lambda: client.samples)
            assert "the token needs the scope `write b.*`" in client.call("set", {"b": 1})
        running.terminate()
        _, errors = running.communicate(timeout=20)
    assert running.returncode == 0 and "Traceback" not in errors
    assert url.partition("token=")[2] not in errors, "the audit log has no tokens"


def test_the_will_of_a_server_that_is_killed(broker: Mosquitto, tmp_path: Path) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text("public arm() { @a = 0x10: u16 READ(PUBLISH(50 Hz)); @b = 0x11: u16 READWRITE(); }")
    (tmp_path / "password").write_text("secret\n")
    url = f"mqtt://ana@127.0.0.1:{broker.port}"
    options = ["--mqtt", url, "--mqtt-password-file", str(tmp_path / "password"), "--may", "mqtt", "write b"]
    command = [sys.executable, "-m", "unitylink", "serve", f"sim:{spec}", str(spec), *options]
    command += ["--listen", "127.0.0.1:0"]
    with person(broker) as ana:
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            ana.until("status", "online")
            ana.say("b/set", "17")
            ana.until("b", "17")
            running.send_signal(signal.SIGKILL)
            said, errors = running.communicate(timeout=20)
            assert "at a broker:  mqtt://127.0.0.1" in said and "Traceback" not in errors
        ana.until("status", "offline")
