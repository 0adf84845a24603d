# SPDX-License-Identifier: BSD-3-Clause
"""A server in front of a board: `python -m unitylink_lab.bench.server URL`. It ends when standard input does.

It prints the URL for clients. The token is TOKEN. The figure compares a read through it with one through a
relay that only passes bytes.
"""

from __future__ import annotations

import os
import sys
from urllib.parse import urlsplit

from .figure import BenchError, Figure, Run
from .programs import Process, native, twin
from .timing import in_turns

TOKEN = "bench"


def measure(run: Run) -> Figure:
    """Measure a read through layer 4: through the server, and through the relay."""
    from .board import reads_of

    os.environ["UNITYLINK_TOKEN"] = TOKEN
    with twin("tcp") as behind_server, twin("tcp") as behind_relay:
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
