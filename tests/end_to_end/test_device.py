# SPDX-License-Identifier: BSD-3-Clause
"""Commands that talk to a device, over TCP, UDP, a pty and in process."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., "subprocess.CompletedProcess[str]"]
UNITYLINK = Path(sys.executable).with_name("unitylink")
Serve = Callable[..., Any]  # returns the `Server` of conftest.py
# Plain memory: a read of a WRITE word returns what was written.
MEMORY = """
public mem() {
   a: pair() @ (0x10,0x20);
   b: pair() @ (0x11,0x21);
   set = a.set, b.set;
}
pair(): @ (get,set) {
   @get: signed READ(PUBLISH(1,10));
   @set: signed WRITE();
}
"""


@pytest.fixture
def memory(tmp_path: Path) -> Path:
    spec = tmp_path / "mem.ul"
    spec.write_text(MEMORY)
    return spec


def test_any_tcp_client_gets_the_configuration(serve: Serve, scara: Path) -> None:
    server = serve(scara, "--tcp", "127.0.0.1:0")
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as client:
        client.sendall(b"$RLC*9B\n")
        reply = client.makefile("rb").readline()
    assert reply.startswith(b"$CNF:02,04,") and reply.endswith(b"\n")


def test_read_over_tcp_by_name(serve: Serve, run: Run, scara: Path) -> None:
    server = serve(scara, "--tcp", "0")
    done = run("read", server.url, "j1.cpos", "--spec", scara)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("j1.cpos = ")
    int(done.stdout.split("=")[1])
    several = json.loads(run("read", server.url, "--spec", scara, "j*.cpos", "0x80", "--json").stdout)
    assert [entry["name"] for entry in several] == ["j1.cpos", "j2.cpos", "j3.cpos", "j4.cpos", "0x0080"]
    assert [entry["address"] for entry in several] == [0x88, 0x89, 0x8A, 0x8B, 0x80]
    assert all(entry["word"] == entry["value"] % 2**32 for entry in several)


@pytest.mark.parametrize(
    "endpoint", [["--tcp", "0"], ["--udp", "0"], ["--pty", "board.tty"]], ids=lambda e: e[0]
)
def test_write_then_read_back(serve: Serve, run: Run, memory: Path, endpoint: list[str]) -> None:
    server = serve(memory, *endpoint)
    done = run("write", server.url, "--spec", memory, "a.set=-30", "b.set=0x1E")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "a.set = -30\nb.set = 30\n"
    assert run("read", server.url, "--spec", memory, "a.set", "b.set", "--value").stdout == "-30\n30\n"
    assert run("read", server.url, "0x20", "--hex").stdout == "0x0020 = 0xFFFFFFE2\n"
    assert run("write", server.url, "0x20=5", "--json").returncode == 0
    assert run("read", server.url, "--spec", memory, "a.set").stdout == "a.set = 5\n"


def test_a_tosnet_write_takes_effect(serve: Serve, run: Run, scara: Path) -> None:
    server = serve(scara, "--tcp", "0", "--plant", "loopback")
    assert run("write", server.url, "--spec", scara, "j1.pos_sp=-1200", "j2.pos_sp=7").returncode == 0
    assert run("write", server.url, "--spec", scara, "j3.pos_sp=99").returncode == 0
    values = run("read", server.url, "--spec", scara, "j?.pos_sp", "--value").stdout.split()
    assert values == ["-1200", "7", "99", "0"]


def test_a_group_and_a_pattern_are_written_as_one(serve: Serve, run: Run, memory: Path) -> None:
    server = serve(memory, "--tcp", "0")
    assert run("write", server.url, "--spec", memory, "set=7").stdout == "a.set = 7\nb.set = 7\n"
    assert run("write", server.url, "--spec", memory, "*.set=8").returncode == 0
    assert run("read", server.url, "--spec", memory, "set", "--value").stdout == "8\n8\n"


@pytest.mark.parametrize(
    ("assignments", "code", "message"),
    [
        (["a.set=9999999999"], 1, "a.set: 9999999999 is not in -2147483648 to 2147483647"),
        (["a.set=5", "b.set=-2147483649"], 1, "b.set: -2147483649 is not in"),
        (["a.set=5", "0x20=-1"], 1, "0x0020: -1 is not in 0 to 4294967295"),
        (["a.set=5", "0x12345678=1"], 1, "beyond the 8 bits"),
        (["a.set=5", "a.get=1"], 1, "a.get is a READ item"),
        (["a.set=5", "a.sett=1"], 1, "did you mean 'a.set'?"),
        (["a.set=5", "a.set=6"], 2, "a.set is given two values"),
        (["a.set=5", "b.set=fast"], 2, "b.set: 'fast' is not an integer"),
        (["a.set=5", "b.set"], 2, "'b.set' is not NAME=VALUE"),
    ],
)
def test_a_wrong_write_sends_nothing(
    serve: Serve, run: Run, memory: Path, *, assignments: list[str], code: int, message: str
) -> None:
    server = serve(memory, "--tcp", "0")
    done = run("write", server.url, "--spec", memory, *assignments)
    assert done.returncode == code
    assert message in done.stderr and done.stdout == ""
    assert run("read", server.url, "--spec", memory, "a.set", "--value").stdout == "0\n"


def test_info(serve: Serve, run: Run, scara: Path) -> None:
    server = serve(scara, "--tcp", "0", "--groups", "8", "--group-size", "16", "--read-many", "20")
    shown = run("info", server.url, "--spec", scara).stdout
    assert "binding  verified" in shown and "8 of 16 addresses" in shown and "online" in shown
    report = json.loads(run("info", server.url, "--json").stdout)
    assert report["configuration"]["groups"] == 8 and report["protocol"] == "framed"
    assert report["binding"]["verified"] is False and report["health"]["frames"] > 0
    classic = json.loads(run("info", f"{server.url}?protocol=classic", "--json").stdout)
    assert classic["configuration"]["read_many"] == 20 and classic["health"] is None
    assert "classic" in classic["binding"]["reason"]
    assert report["statistics"]["bytes_received"] > 0 and report["statistics"]["timeouts"] == 0


def test_in_process(run: Run, memory: Path) -> None:
    assert run("read", "sim:mem.ul", "a.set").stdout == "a.set = 0\n"
    assert run("write", "sim:mem.ul", "set=3").returncode == 0
    assert "a.get" in run("list", "sim:mem.ul").stdout
    done = run("read", "sim:mem.ul", "a.set", "--spec", "other.ul")
    assert done.returncode == 2 and "brings its own spec" in done.stderr


def test_watch_prints_lines_and_json(run: Run, memory: Path) -> None:
    done = run("watch", "sim:mem.ul?plant=ramp", "--count", "5", "--json")
    assert done.returncode == 0, done.stderr
    samples = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(samples) == 5
    assert all(set(sample["values"]) == {"a.get", "b.get"} for sample in samples)
    times = [sample["time_s"] for sample in samples]
    assert times == sorted(times)
    polled = run("watch", "sim:mem.ul", "a.set", "0x21", "--rate", "200", "--count", "3")
    assert [line.split()[1:] for line in polled.stdout.splitlines()] == [["a.set=0", "0x0021=0"]] * 3
    assert (
        run("watch", "sim:mem.ul", "a.set", "--rate", "100", "--duration", "0.3", "--changes").stdout.count(
            "\n"
        )
        == 1
    )


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["read", "sim:mem.ul", "a.gett"], 1, "did you mean 'a.get'?"),
        (["read", "sim:mem.ul", "z*"], 1, "matches no item"),
        (["read", "sim:mem.ul", "0x10000"], 1, "beyond"),
        (["read", "sim:gone.ul", "a.get"], 1, "gone.ul"),
        (["read", "sim:mem.ul"], 2, "NAME..."),
        (["read", "mem.ul", "a.get"], 2, "sim:mem.ul"),
        (["read", "/dev/ttyUSB9", "0x1"], 2, "serial:/dev/ttyUSB9"),
        (["read", "a.get", "sim:mem.ul"], 2, "LINK comes first"),
        (["read", "serial:/dev/unitylink-none", "0x1"], 1, "no such port"),
        (["read", "http://example.org", "0x1"], 2, "http"),
        (["read", "tcp://127.0.0.1:99999", "0x1"], 2, "99999"),
        (["read", "sim:mem.ul?plant=gone", "a.get"], 1, "gone"),
        (["watch", "sim:mem.ul", "a.set", "--rate", "0"], 2, "--rate"),
        (["watch", "sim:mem.ul", "--count", "0"], 2, "--count"),
        (["info", "tcp://127.0.0.1:1"], 1, "nothing listens there"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_mistakes_are_told_clearly(
    run: Run, memory: Path, arguments: list[str], code: int, message: str
) -> None:
    done = run(*arguments)
    assert done.returncode == code, done.stderr
    assert message in done.stderr and done.stdout == ""


def test_a_name_without_a_spec(serve: Serve, run: Run, memory: Path) -> None:
    server = serve(memory)
    done = run("read", server.url, "a.get")
    assert done.returncode == 1
    assert "--spec" in done.stderr
    done = run("watch", server.url)
    assert done.returncode == 1 and "nothing to watch" in done.stderr


def test_a_silent_device_is_a_timeout(run: Run) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        done = run("read", f"tcp://127.0.0.1:{silent.getsockname()[1]}?timeout=0.05&attempts=2", "0x10")
    assert done.returncode == 1
    assert "unanswered after 2 attempts" in done.stderr


def test_a_second_opener_hears_busy(serve: Serve, run: Run, memory: Path) -> None:
    server = serve(memory)
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as first:
        first.sendall(b"#RLC\n")
        assert first.recv(100)
        done = run("read", server.url, "0x10")
    assert done.returncode == 1
    assert "busy" in done.stderr.lower() or "another" in done.stderr.lower()
    assert run("read", server.url, "0x10").returncode == 0


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_simulate_ends_cleanly(serve: Serve, scara: Path, how: signal.Signals) -> None:
    assert serve(scara, "--tcp", "0").stop(how) == (0, "")


def test_simulate_removes_its_pty(serve: Serve, memory: Path, tmp_path: Path) -> None:
    server = serve(memory, "--pty", "board.tty")
    assert (tmp_path / "board.tty").is_symlink()
    server.stop()
    assert not (tmp_path / "board.tty").is_symlink()


def test_simulate_a_port_in_use(serve: Serve, run: Run, memory: Path) -> None:
    server = serve(memory)
    done = run("simulate", memory, "--tcp", server.port)
    assert done.returncode == 1
    assert str(server.port) in done.stderr and "in use" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--tcp", "0.0.0.0:0"], 2, "--bind 0.0.0.0 --anyone"),
        (["--tcp", "0", "--bind", "0.0.0.0"], 2, "add --anyone"),
        (["--tcp", "127.0.0.1:0", "--bind", "0.0.0.0"], 2, "--bind says"),
        (["--tcp", "five"], 2, "[HOST:]PORT"),
        (["--tcp", "99999"], 2, "65535"),
        (["--tcp", "0", "--udp", "0"], 2, "exclude each other"),
        (["--pty", "no/such/folder/tty"], 1, "no/such/folder"),
        (["--plant", "gone.py"], 1, "gone.py"),
        (["--plant", "wobble"], 1, "wobble"),
        (["--fifo", "2"], 1, "at least 4 bytes"),
        (["--groups", "1000"], 2, "1<=x<=256"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_simulate_refuses(run: Run, memory: Path, arguments: list[str], code: int, message: str) -> None:
    done = run("simulate", memory, *arguments)
    assert done.returncode == code, done.stderr
    assert message in done.stderr


def test_simulate_does_not_overwrite_a_file(run: Run, memory: Path, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    done = run("simulate", memory, "--pty", "notes.txt")
    assert done.returncode == 1
    assert "notes.txt" in done.stderr
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_plant_of_the_user(serve: Serve, run: Run, memory: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "class Plant:\n"
        "    period_s = 0.001\n"
        "    def attach(self, spec, registers):\n"
        "        self.registers = registers\n"
        "        registers[0x10] = 4711\n"
        "    def step(self, time_s):\n"
        "        self.registers[0x11] = self.registers[0x21]\n"
    )
    server = serve(memory, "--plant", "mine.py")
    assert run("read", server.url, "--spec", memory, "a.get", "--value").stdout == "4711\n"


def test_a_plant_that_fails_ends_the_board(serve: Serve, memory: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        "class Plant:\n"
        "    period_s = 0.001\n"
        "    def attach(self, spec, registers):\n"
        "        pass\n"
        "    def step(self, time_s):\n"
        "        if time_s > 0.05:\n"
        "            raise ValueError('a joint fell off')\n"
    )
    server = serve(memory, "--plant", "mine.py")
    _, err = server.process.communicate(timeout=60)
    assert server.process.returncode == 1
    assert "a joint fell off" in err.splitlines()[-1]


def test_watch_ends_cleanly_on_signals(serve: Serve, memory: Path, tmp_path: Path) -> None:
    server = serve(memory)
    for how in (signal.SIGINT, signal.SIGTERM):
        command = [UNITYLINK, "watch", server.url, "--spec", memory, "--json"]
        watching = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert watching.stdout is not None
        json.loads(watching.stdout.readline())
        watching.send_signal(how)
        _, err = watching.communicate(timeout=60)
        assert (watching.returncode, err) == (0, "")


def test_watch_notices_that_the_device_goes_away(serve: Serve, memory: Path) -> None:
    server = serve(memory)
    command = [UNITYLINK, "watch", server.url, "--spec", memory, "--json"]
    watching = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert watching.stdout is not None
    json.loads(watching.stdout.readline())
    server.stop()
    _, err = watching.communicate(timeout=60)
    assert watching.returncode == 1
    assert "went away" in err and "Traceback" not in err


def test_two_public_constructors_and_names_that_are_keywords(run: Run, tmp_path: Path) -> None:
    (tmp_path / "two.ul").write_text(
        "public left() { @class = 0x10: READ(); @import = 0x11: signed WRITE(); }\n"
        "public right() { @class = 0x20: READ(PUBLISH(2,5)); all = lambda; @lambda = 0x21: WRITE(); }\n"
    )
    assert run("check", "two.ul").stdout == "two.ul: no mistakes; 4 items in left, right\n"
    done = run("write", "sim:two.ul", "left.import=-1", "right.all=7")
    assert done.stdout == "left.import = -1\nright.lambda = 7\n", done.stderr
    assert run("read", "sim:two.ul", "right", "--value").stdout.count("\n") == 2
    sample = json.loads(run("watch", "sim:two.ul", "*.class", "--count", "1", "--json").stdout)
    assert set(sample["values"]) < {"left.class", "right.class"}


def test_a_device_without_publishing_is_watched_by_polling(run: Run, memory: Path) -> None:
    done = run("watch", "sim:mem.ul?publish_mode=0", "--count", "2", "--json")
    assert done.returncode == 0, done.stderr
    shown = [json.loads(line)["values"] for line in done.stdout.splitlines()]
    assert set().union(*shown) == {"a.get", "b.get"}


def test_watch_on_a_terminal_is_a_live_table(on_terminal: Callable[..., str], memory: Path) -> None:
    shown = on_terminal("watch", "sim:mem.ul", "a.get", "a.set", "--duration", "0.5")
    assert "gateware" in shown and "polled" in shown and "trend" in shown
    assert "\x1b[?25h" in shown  # the cursor is visible again


def test_list_asks_the_device(serve: Serve, run: Run, memory: Path) -> None:
    server = serve(memory, "--base-hz", "2000")
    report = json.loads(run("list", server.url, "--spec", memory, "a.get", "--json").stdout)
    publish = report["items"][0]["publish"]
    assert publish == {"by": "hardware", "divisor": 10, "rate_hz": 200.0, "on": None, "group": ""}
    assert report["items"][0]["reachable"] is True
    wide = memory.with_name("wide.ul")
    wide.write_text("public wide() { @far = 0x1234: READ(); }\n")
    assert "another spec than wide.ul" in run("list", server.url, "--spec", wide).stderr
    other = f"{server.url}?spec_hash=any"
    assert "beyond the address bus" in run("list", other, "--spec", wide).stdout
    done = run("read", other, "--spec", wide, "far")
    assert done.returncode == 1 and "far" in done.stderr


def test_watch_notices_that_the_device_falls_silent(serve: Serve, memory: Path) -> None:
    server = serve(memory)
    command = [UNITYLINK, "watch", server.url, "--spec", memory, "--json"]
    watching = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert watching.stdout is not None
    json.loads(watching.stdout.readline())
    server.process.send_signal(signal.SIGSTOP)
    _, err = watching.communicate(timeout=60)
    server.process.send_signal(signal.SIGCONT)
    assert watching.returncode == 1
    assert "no sample for 2.0 s" in err and "Traceback" not in err
