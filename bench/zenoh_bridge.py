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
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import zenoh
from fleet import free_port

from unitylink import connect
from unitylink.zenoh.bridge.groups import Group
from unitylink.zenoh.messages import SAMPLE, Answer, Request
from unitylink.zenoh.session import Network

VALUES, TURNS, BATCH = 18, 5, 20
SPEC = (
    "public fast() {\n"
    + "\n".join(f"   @v{n} = {0x10 + n:#x}: i32 READ(PUBLISH(1000 Hz));" for n in range(VALUES))
    + "\n   @goal = 0x80: i32 WRITE(SAFE=0);\n}\n"
)
ROUTER = """
import sys, time
from unitylink.zenoh.session import Network
with Network(listen=sys.argv[1]).opened():
    print("there", flush=True)
    time.sleep(3600)
"""
PEER = """
import sys, time
from unitylink.zenoh.session import Network
answer = bytes(int(sys.argv[2]))
with Network(connect=sys.argv[1]).opened() as session:
    kept = session.declare_queryable("bare/query", lambda query: query.reply("bare/query", answer))
    taken = session.declare_subscriber("bench/*", lambda sample: None)
    print("there", flush=True)
    time.sleep(3600)
"""
SLOW = """
import sys, time
from unitylink.zenoh.session import Network
with Network(connect=sys.argv[1]).opened() as session:
    for sample in session.declare_subscriber("lab/fast/publish/**"):
        print("there", flush=True)
        time.sleep(0.01)
"""


class Processes:
    """Programs beside this one, each of which says a line when it is ready."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack
        self.pids: list[int] = []

    def start(self, *words: str) -> str:
        """Start one, and return its first line."""
        one = self._stack.enter_context(
            subprocess.Popen(
                [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
            )
        )
        self._stack.callback(one.send_signal, signal.SIGTERM)
        self.pids.append(one.pid)
        assert one.stdout is not None
        return one.stdout.readline()


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


def publish_rates(session: zenoh.Session, seconds: float) -> tuple[float, float]:
    """Return publishes a second: bare puts, and through what the bridge makes of a board's publishes."""

    class Board:
        """A board whose publishes are here already."""

        missing = lost = 0
        now_s = staticmethod(time.monotonic)

    wait = zenoh.CongestionControl.BLOCK  # so that the rate is that of the network, and nothing is dropped
    wanted = (tuple(range(VALUES)), 1, False, None)
    group = Group(wanted, session.declare_publisher("bench/words", congestion_control=wait))
    group._link = group.subscription = Board()  # type: ignore[assignment]
    words = np.arange(BATCH * VALUES, dtype=np.uint32).reshape(BATCH, VALUES)
    times = np.full(BATCH, time.monotonic())
    bare = session.declare_publisher("bench/bare", congestion_control=wait)
    data = bytes(SAMPLE.size + 4 * VALUES)

    def puts() -> None:
        for _ in range(BATCH):
            bare.put(data)

    def ours() -> None:
        group._many(times, words)

    rates: dict[Callable[[], None], list[float]] = {puts: [], ours: []}
    for _ in range(TURNS):
        for act, some in rates.items():
            count, began = 0, time.perf_counter()
            while (spent := time.perf_counter() - began) < seconds / TURNS:
                act()
                count += BATCH
            some.append(count / spent)
    return statistics.median(rates[puts]), statistics.median(rates[ours])


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
        programs.start("-c", ROUTER, router)
        programs.start("-c", PEER, router, str(len(answer)))
        board = json.loads(programs.start("-m", "unitylink", "simulate", str(file), "--tcp", "0", "--json"))[
            "url"
        ]
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
        plain, ours = publish_rates(session, seconds)
        ratio = ours / plain
        print(f"publishes of {VALUES} words: bare {plain:,.0f}/s, ours {ours:,.0f}/s  {ratio:.2f} of bare")
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
