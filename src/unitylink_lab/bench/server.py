# SPDX-License-Identifier: BSD-3-Clause
"""A server in front of a board: `python -m unitylink_lab.bench.server URL`. It ends when standard input does.

It prints the URL for clients. The token is TOKEN. One figure compares a read through it with one through a
relay that only passes bytes. Two compare it with LiteX's server: litex_server and its client, RemoteClient.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import ExitStack
from unittest import mock
from urllib.parse import urlsplit

from .figure import BenchError, Figure, Run
from .programs import Process, native, twin
from .timing import in_turns, times

TOKEN = "bench-of-unity-link"
TOKEN_SHOWN = {"UNITYLINK_TOKEN": TOKEN}
COUNT = 100  # calls in each turn of the comparison with LiteX
WRITES = 8  # confirmed writes in each turn: LiteX needs 44 ms for one


def measure(run: Run) -> Figure:
    """Measure a read through layer 4: through the server, and through the relay."""
    from .board import reads_of

    with mock.patch.dict(os.environ, TOKEN_SHOWN), twin("tcp") as behind_server, twin("tcp") as behind_relay:
        relayed = urlsplit(behind_relay.line()).port
        command = [sys.executable, "-m", "unitylink_lab.bench.server", behind_server.line()]
        with (
            Process(command) as server,
            Process([native(run.checkout, "bench_relay"), "--to", str(relayed)]) as relay,
        ):
            served, passed = server.line(), f"{relay.line()}?protocol=framed"
            result = in_turns(
                lambda count: reads_of(served, count),
                lambda count: reads_of(passed, count),
                rounds=run.rounds(61),
                count=200 if not run.quick else 50,
            )
    return Figure(
        "serve",
        "layer-4 read through `unitylink serve` / through a relay that only passes bytes, TCP",
        1.3,
        True,
        result.ratio,
        "x",
        result.told_us("server", "relay"),
    )


def through_litex(run: Run, operation: str, count: int, title: str, limit: float) -> Figure:
    """Compare `operation` through our server with the same through LiteX's.

    Each board is instant, on a pty.
    """
    from unitylink import connect

    from . import litex
    from .board import WRITTEN, layer4_word

    python = litex.environment(run)
    with ExitStack() as stack:
        stack.enter_context(mock.patch.dict(os.environ, TOKEN_SHOWN))
        board = stack.enter_context(twin("pty", clock_hz=litex.CLOCK_HZ, fifo=litex.FIFO_BYTES))
        command = [sys.executable, "-m", "unitylink_lab.bench.server", board.line()]
        served = stack.enter_context(Process(command)).line()
        link = stack.enter_context(connect(served))
        emulator = stack.enter_context(Process([native(run.checkout, "bench_uartbone")]))
        peer = run.checkout / "bench" / "litex" / "peer.py"
        theirs = stack.enter_context(Process([python, peer, "server", emulator.line()]))
        if theirs.line() != "ready":
            raise BenchError("LiteX's client did not come up")
        number = iter(range(1 << 30))
        calls: dict[str, Callable[[], object]] = {
            "read": layer4_word(link).read,
            "write": lambda: link.write(WRITTEN, next(number)),
        }
        result = in_turns(
            lambda n: times(calls[operation], n),
            lambda n: theirs.series(f"times {operation} {n}"),
            rounds=run.rounds(31),
            count=count,
        )
    return litex.figure(f"serve-litex-{operation}", title, limit, result)


def measure_litex_read(run: Run) -> Figure:
    """Measure reads through a server, ours and LiteX's."""
    return through_litex(run, "read", COUNT, "reads through a server, times litex_server's", 3.0)


def measure_litex_write(run: Run) -> Figure:
    """Measure confirmed writes through a server.

    LiteX acknowledges none, so its client reads the word back.
    """
    title = "confirmed writes through a server, times litex_server's"
    return through_litex(run, "write", WRITES, title, 20.0)


def main() -> None:
    """Serve."""
    from unitylink.server.audit import Audit
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.server.serving import Server
    from unitylink.server.tokens import Tokens, User, digest
    from unitylink.spec import compile_text

    from .board import SPEC

    spec = compile_text(SPEC.encode(), "bench.ul").spec
    assert spec is not None
    tokens = Tokens([(digest(TOKEN), User("bench", Rights.of(["admin"])))])
    audit = Audit(lambda line: None)
    robot = Robot("bench", sys.argv[1], spec, tokens, audit)
    with Server([robot], tokens, audit, "127.0.0.1", 0) as server:
        robot.opened.wait()
        if robot.away:
            raise BenchError(robot.away)
        print(f"serve://{server.place}/bench", flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
