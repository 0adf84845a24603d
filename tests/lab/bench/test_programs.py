# SPDX-License-Identifier: BSD-3-Clause
"""The bench's own programs do what the figures rely on."""

from __future__ import annotations

import os
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from unitylink_lab.bench.figure import BenchError, Run
from unitylink_lab.bench.programs import Process, Silence, made, native

Program = Callable[[str], Path]


def crc8(data: bytes) -> int:
    """Return the CRC-8 of the classic protocol, computed bit by bit."""
    remainder = 0
    for byte in data:
        remainder ^= byte
        for _ in range(8):
            remainder = (remainder << 1 ^ 0x07) & 0xFF if remainder & 0x80 else remainder << 1
    return remainder


class Client:
    """A raw client of the publish source."""

    def __init__(self, endpoint: str, place: str) -> None:
        if endpoint == "tcp":
            host, port = place.split(":")
            self.socket: socket.socket | None = socket.create_connection((host, int(port)), timeout=10)
            self.descriptor = self.socket.fileno()
            os.set_blocking(self.descriptor, True)
        else:
            self.socket = None
            self.descriptor = os.open(place, os.O_RDWR | os.O_NOCTTY)
        self.rest = b""

    def line(self) -> bytes:
        """Return the next line."""
        while b"\n" not in self.rest:
            chunk = os.read(self.descriptor, 65536)
            assert chunk, "the source is gone"
            self.rest += chunk
        line, _, self.rest = self.rest.partition(b"\n")
        return line

    def ask(self, request: bytes) -> bytes:
        """Send a request and return the reply. Publishes in between are skipped."""
        os.write(self.descriptor, request + b"\n")
        while (line := self.line()).startswith((b"&", b"%")):
            pass
        return line

    def close(self) -> None:
        """Leave."""
        if self.socket is not None:
            self.socket.close()
        else:
            os.close(self.descriptor)


@contextmanager
def source(program: Program, endpoint: str, bits_per_second: int) -> Iterator[tuple[Process, str]]:
    """Run a publish source."""
    options = ["--endpoint", endpoint, "--bits-per-second", str(bits_per_second)]
    with Process([program("bench_publish_source"), *options]) as process:
        yield process, process.line()


@pytest.mark.parametrize("endpoint", ["tcp", "pty"])
def test_source_is_a_classic_device(program: Program, endpoint: str) -> None:
    with source(program, endpoint, 64_000_000) as (_, place):
        client = Client(endpoint, place)
        assert client.ask(b"!$RLC*9B") == b"$CNF:02,04,00,02,05d018,10,20,02*62"
        assert client.ask(b"#R:0088") == b"#S_R:00000000"
        assert client.ask(b"#R:00") == b"#?E_MAB"
        assert client.ask(b"#W:0088") == b"#?E_ICC"
        assert client.ask(b"$R:0088*00") == b"?f4"
        assert client.ask(b"#R:008") == b"?f2"
        assert client.ask(b"#R:0x88") == b"?f3"
        assert client.ask(b"#WSA:FF010088") == b"#?E_ISG"
        assert client.ask(b"#WSA:0301") == b"#?E_MAB"
        assert client.ask(b"#WSA:03010088") == b"#S_WSA"
        assert client.ask(b"#WSR:030001") == b"#S_WSR"
        assert client.ask(b"#RSI:03") == b"#S_RSI:0001010088"
        assert client.ask(b"#RSI:04") == b"#S_RSI:000000"
        assert client.ask(b"$EPC*84") == b"$S_EPC*f6"
        lines = [client.line() for _ in range(2000)]
        assert client.ask(b"$DPS*9F") == b"$S_DPS*ed"
        client.close()
    for number, line in enumerate(lines):
        data = bytes.fromhex(line[5:17].decode())
        assert data == bytes([3, 1]) + number.to_bytes(4, "big")
        assert line == b"&PUB:" + data.hex().encode() + b"*%02x" % crc8(b"PUB" + data)


def test_source_forgets_a_client_that_left(program: Program) -> None:
    with source(program, "tcp", 0) as (_, place):
        first = Client("tcp", place)
        for request in (b"#WSA:00010088", b"#WSR:000001", b"#EPS"):
            first.ask(request)
        assert first.line().startswith(b"%PUB:0001")
        first.close()
        second = Client("tcp", place)
        assert second.ask(b"#RSI:00") == b"#S_RSI:000000"
        second.close()


def test_uartbone_reads_back_what_was_written(program: Program) -> None:
    with Process([program("bench_uartbone")]) as emulator:
        descriptor = os.open(emulator.line(), os.O_RDWR | os.O_NOCTTY)

        def read(count: int) -> bytes:
            data = b""
            while len(data) < count:
                data += os.read(descriptor, count - len(data))
            return data

        os.write(descriptor, bytes([2, 3]) + (0x88).to_bytes(4, "big"))
        assert read(12) == b"".join((0x40DE0088 + i).to_bytes(4, "big") for i in range(3))
        write = bytes([1, 2]) + (0x89).to_bytes(4, "big") + bytes(range(8))
        for byte in write:  # cut into any chunks
            os.write(descriptor, bytes([byte]))
        os.write(descriptor, bytes([4, 2]) + (0x8A).to_bytes(4, "big"))
        assert read(8) == bytes([4, 5, 6, 7]) * 2
        os.close(descriptor)


@contextmanager
def answering(answers: list[bytes]) -> Iterator[int]:
    """Serve one TCP client with one answer for each request line. Return the port."""
    listener = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        client, _ = listener.accept()
        with client, client.makefile("rb") as requests:
            for answer in answers:
                assert requests.readline() == b"#R:0088\n"
                client.sendall(answer)

    thread = threading.Thread(target=serve)
    thread.start()
    try:
        yield listener.getsockname()[1]
    finally:
        thread.join(10)
        listener.close()


def test_round_trip_times_every_call(program: Program) -> None:
    with answering([b"#S_R:40de0088\n"] * 7) as port:
        options = ["--request", "#R:0088", "--tcp", str(port)]
        with Process([program("bench_round_trip"), *options]) as bare:
            assert len(bare.series("4")) == 4
            assert all(time > 0 for time in bare.series("3"))


def test_round_trip_refuses_a_changed_reply(program: Program) -> None:
    with answering([b"#S_R:40de0088\n", b"#?E_BAT\n"]) as port:
        options = ["--request", "#R:0088", "--tcp", str(port)]
        with (
            Process([program("bench_round_trip"), *options]) as bare,
            pytest.raises(BenchError, match="the reply changed"),
        ):
            bare.series("2")


def test_a_process_that_dies_says_why() -> None:
    command = [sys.executable, "-c", "import sys; sys.exit('no such thing')"]
    with Process(command) as process, pytest.raises(BenchError, match="no such thing"):
        process.line()


def test_a_process_that_writes_much_on_stderr_goes_on_and_its_last_lines_are_reported() -> None:
    script = (
        "import sys\n"
        "for number in range(30_000): print('warning', number, file=sys.stderr)\n"
        "print(input(), flush=True)\n"
        "print('e' * 100_000, file=sys.stderr)\n"
        "sys.exit('beyond repair')"
    )
    with Process([sys.executable, "-c", script]) as process:
        assert process.ask("still there") == "still there"  # 500 kB are more than a pipe holds
        with pytest.raises(BenchError, match=r"ended early: e{300}\n(?s:.*)e\nbeyond repair$") as told:
            process.line()
    assert len(str(told.value)) < 2000


def test_silence_tells_what_stood_on_stderr() -> None:
    script = "import os; os.write(2, b'waiting for the port\\n'); os.close(2); input()"
    with Process([sys.executable, "-c", script]) as process:
        process._listener.join(30)  # wait for the end of its stderr
        with pytest.raises(Silence, match="said nothing for 0 s; on stderr: waiting for the port"):
            process.line(patience_s=0.01)


def test_what_is_not_built_is_named(tmp_path: Path) -> None:
    run = Run(True, tmp_path, lambda message: None)
    with pytest.raises(BenchError, match="bench_nothing is not built; `make bench`"):
        native(run.checkout, "bench_nothing")
    with pytest.raises(BenchError, match="did not start"):
        Process([tmp_path / "bench_nothing"])


def test_what_is_made_once_fails_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    assert made(["sh", "-c", "echo $WORD"], {"WORD": "here"}) == "here\n"
    with pytest.raises(BenchError, match=r"`sh -c .*` failed: no room"):
        made(["sh", "-c", "echo no room >&2; exit 3"])
    monkeypatch.setattr("unitylink_lab.bench.programs._MADE_S", 0.1)
    with pytest.raises(BenchError, match="`sleep 60` does not end"):
        made(["sleep", "60"])
