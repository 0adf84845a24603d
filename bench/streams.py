# SPDX-License-Identifier: BSD-3-Clause
"""What streams cost a program: its read through the server, without and with the tools.

    python bench/streams.py [--seconds 4]

The robot has 18 values at 1 kHz, on a virtual board in a process of its own. The server is in this process.
The runs take turns, so that a change of the machine's load meets all of them.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from unitylink import Link, connect
from unitylink.dashboard.place import Place
from unitylink.server.audit import Audit
from unitylink.server.robot import Robot
from unitylink.server.scopes import Rights
from unitylink.server.serving import Server
from unitylink.server.tokens import Tokens, User, digest
from unitylink.spec import load
from unitylink.streams.foxglove.server import Foxglove
from unitylink.streams.hand import Hand
from unitylink.streams.plotjuggler import PlotJuggler
from unitylink.streams.source import Source

VALUES, TURNS = 18, 5
SPEC = (
    "public fast() {\n"
    + "\n".join(f"   @v{n} = {0x10 + n:#x}: i32 READ(PUBLISH(1000 Hz));" for n in range(VALUES))
    + "\n   @goal = 0x80: i32 WRITE(SAFE=0);\n}\n"
)
ASK = (
    b"GET /?token=bench HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
    b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
)


def reads(link: Link, seconds: float) -> list[float]:
    """Return the times of reads, in us."""
    times, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end:
        began = time.perf_counter()
        link.read(0x80)
        times.append((time.perf_counter() - began) * 1e6)
        time.sleep(0.001)
    return times


@contextmanager
def plotjuggler(robot: Robot, url: str) -> Iterator[None]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sink:  # it takes packets, and reads none
        sink.bind(("127.0.0.1", 0))
        stream = PlotJuggler("fast", "127.0.0.1", sink.getsockname()[1], Rights.of(["read"]))
        with Source(url, robot.spec, [stream]):
            time.sleep(0.5)
            yield
        stream.close()


@contextmanager
def foxglove(robot: Robot, url: str, stalled: bool = False) -> Iterator[None]:
    server = Foxglove(Hand(robot), Place())
    port = int(server.url.rpartition(":")[2])
    with Source(url, robot.spec, [server]), socket.create_connection(("127.0.0.1", port)) as client:
        client.sendall(ASK)
        while not server.conversations or not server.channels.topics:
            time.sleep(0.02)
        (one,) = server.conversations
        for channel in server.channels.all(one.rights):
            one._subscriptions[channel.number] = channel.number
        if not stalled:
            reader = f"import socket\ns = socket.socket(fileno={client.fileno()})\nwhile s.recv(65536): pass"
            with subprocess.Popen([sys.executable, "-c", reader], pass_fds=[client.fileno()]) as running:
                time.sleep(0.5)
                yield
                running.kill()
        else:
            yield
    server.close()


@contextmanager
def nothing(*_: object) -> Iterator[None]:
    yield


KINDS: dict[str, Callable[..., object]] = {
    "no stream": nothing,
    "PlotJuggler": plotjuggler,
    "Foxglove": foxglove,
    "Foxglove, a reader that has stopped": lambda robot, url: foxglove(robot, url, stalled=True),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=4.0)
    seconds = parser.parse_args().seconds / TURNS
    times: dict[str, list[float]] = {kind: [] for kind in KINDS}
    used: dict[str, float] = dict.fromkeys(KINDS, 0.0)
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file, token = Path(folder) / "fast.ul", Path(folder) / "token"
        file.write_text(SPEC)
        token.write_text("bench")
        command = [sys.executable, "-m", "unitylink", "simulate", str(file), "--tcp", "0", "--json"]
        board = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        stack.callback(board.terminate)
        assert board.stdout is not None
        tokens = Tokens([(digest("bench"), User("bench", Rights.of(["admin"])))])
        audit = Audit(lambda line: None)
        robot = Robot("fast", json.loads(board.stdout.readline())["url"], load(file), tokens, audit)
        server = stack.enter_context(Server([robot], tokens, audit, "127.0.0.1", 0))
        robot.opened.wait(10)
        url = f"serve://{server.place}/fast?token_file={token}"
        link = stack.enter_context(connect(f"{url}&wait=5", reconnect=True))
        for _ in range(TURNS):
            for kind, opened in KINDS.items():
                with opened(robot, url):  # type: ignore[attr-defined]
                    before, began = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
                    times[kind] += reads(link, seconds)
                    after = resource.getrusage(resource.RUSAGE_SELF)
                    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                    used[kind] += spent / (time.perf_counter() - began) / TURNS
    for kind, some in times.items():
        late = statistics.quantiles(some, n=100)[98]
        print(
            f"{kind:<36} median {statistics.median(some):6.0f} us, p99 {late:6.0f} us, core {used[kind]:5.0%}"
        )
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
