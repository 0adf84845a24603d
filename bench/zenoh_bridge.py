# SPDX-License-Identifier: BSD-3-Clause
"""What a robot on a Zenoh network costs beside bare Zenoh, with the same payloads, through the same router.

    python bench/zenoh_bridge.py [--seconds 4]

Board, bridge, router and the bare peer are processes of their own. The runs take turns, so that a change of
the machine's load meets all of them. The later rows have a reader beside them that takes 10 ms for each
publish.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from processes import Processes, free_port, router_program
from zenoh_publishes import publishes

from unitylink import connect
from unitylink.zenoh.messages import Answer, Request
from unitylink.zenoh.session import Network

VALUES, TURNS, PAIRS = 18, 5, 21
SPEC = (
    "public fast() {\n"
    + "\n".join(f"   @v{n} = {0x10 + n:#x}: i32 READ(PUBLISH(1000 Hz));" for n in range(VALUES))
    + "\n   @goal = 0x80: i32 WRITE(SAFE=0);\n}\n"
)
PEER = """
import sys, time
from unitylink.zenoh.session import Network
answer = bytes(int(sys.argv[2]))
with Network(connect=sys.argv[1]).opened() as session:
    kept = session.declare_queryable("bare/query", lambda query: query.reply("bare/query", answer))
    print("there", flush=True)
    time.sleep(3600)
"""
SLOW = """
import sys, time
from unitylink.zenoh.session import Network
with Network(connect=sys.argv[1]).opened() as session:
    kept = session.declare_subscriber("lab/fast/publish/**")
    for sample in kept:
        print("there", flush=True)
        time.sleep(0.01)
"""


def times_us(act: Callable[[], Any], seconds: float) -> list[float]:
    """Return how long each call took, one after the other."""
    times, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end:
        began = time.perf_counter()
        act()
        times.append((time.perf_counter() - began) * 1e6)
    return times


def row(name: str, some: list[float], beside: list[float] | None = None) -> None:
    """Print a row, with the ratio of medians to another."""
    late = statistics.quantiles(some, n=100)[98]
    ratio = f"  {statistics.median(some) / statistics.median(beside):.2f} of bare" if beside else ""
    print(f"{name:<44} median {statistics.median(some):6.0f} us  p99 {late:6.0f} us{ratio}")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=4.0)
    seconds = parser.parse_args().seconds
    router = f"tcp/127.0.0.1:{free_port()}"
    request = Request(1, 1, 1, operations=((1, 0x80, 0, 0),)).encode()
    answer = Answer(1, 1, (0,)).encode()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "fast.ul"
        file.write_text(SPEC)
        programs = Processes(stack)
        programs.start(*router_program(router))
        programs.start("-c", PEER, router, str(len(answer)))
        _, told = programs.start("-m", "unitylink", "simulate", str(file), "--tcp", "0", "--json")
        board = json.loads(told)["url"]
        bridge = (
            "-m",
            "unitylink",
            "bridge",
            "zenoh",
            board,
            str(file),
            "--key",
            "lab/fast",
            "--connect",
            router,
        )
        programs.start(*bridge)
        session = stack.enter_context(Network(connect=router).opened())
        link = stack.enter_context(connect(f"zenoh:lab/fast?connect={router}&timeout=5"))

        def bare() -> None:
            for reply in session.get("bare/query", payload=request, timeout=5.0):
                assert reply.ok is not None

        def read() -> None:
            link.read(0x80)

        def write() -> None:
            link.write(0x80, 5)

        def value() -> None:
            for reply in session.get("lab/fast/value/v0", timeout=5.0):
                assert reply.ok is not None

        kinds = {"a bare query": bare, "read": read, "write": write, "a stranger's read": value}
        for suffix in ("", ", a slow reader beside it"):
            if suffix:
                programs.start("-c", SLOW, router)
                time.sleep(1.0)
            times: dict[str, list[float]] = {kind: [] for kind in kinds}
            for _ in range(TURNS):
                for kind, act in kinds.items():
                    times[kind] += times_us(act, seconds / TURNS)
            for kind, some in times.items():
                row(kind + suffix, some, None if kind == "a bare query" else times["a bare query"])
        publishes(router, programs, seconds, PAIRS)
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
