# SPDX-License-Identifier: BSD-3-Clause
"""A network that is cut for a while: is a set-point executed that is older than its time to live?

    python bench/partition.py
    python bench/partition.py --robots 4 --cut 10

Set-points go to each robot all the time, each with a time to live. What is sent while the way is cut waits in
it, and comes when it is whole again. On each board, an oracle notes each set-point that it sees, and when.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import select
import socket
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path

from processes import end_on_signals, free_port
from writers import APART, Writers

from unitylink.commands.fleet_bridges import start_bridge
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.supervisor import Supervisor

SPEC = "public arm() { @stamp = 0x10: u32 WRITE(SAFE=0); @count = 0x11: READ(PUBLISH(100 Hz)); }\n"
_ORACLE = '''
"""Notes each value of `stamp`, when it saw it first, and when it was not there yet: one line each, in a file
of this board."""
import json
import os
import time


class Plant:
    period_s = PERIOD_S

    def attach(self, spec, registers):
        self._registers, self._last, self._looked_s = registers, 0, time.monotonic()
        self._file = open(f"{os.getpid()}.log", "w", buffering=1)

    def step(self, time_s):
        value = int(self._registers[ADDRESS])
        now_s = time.monotonic()
        if value != self._last:
            self._last = value
            self._file.write(json.dumps([now_s, value, self._looked_s]) + chr(10))
        self._looked_s = now_s
'''
UP_S = 60.0
BEFORE_S = 3.0  # how long all is well, before the cut and after it
SILENT_S = 0.2  # what was on its way when it was cut


def oracle(address: int = 0x10, period_s: float = 0.001) -> str:
    """Return the text of the oracle. It looks at a word every `period_s`."""
    return _ORACLE.replace("ADDRESS", hex(address)).replace("PERIOD_S", str(period_s))


class Way:
    """A TCP way to a port, which can be cut. What is under way meanwhile comes later."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._door = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._door.getsockname()[1]
        self.whole = threading.Event()
        self.whole.set()
        threading.Thread(target=self._accept, daemon=True).start()

    def let(self, through: bool) -> None:
        """Cut the way, or mend it."""
        (self.whole.set if through else self.whole.clear)()

    def _accept(self) -> None:
        while True:
            near, _ = self._door.accept()
            far = socket.create_connection(("127.0.0.1", self._to))
            for source, target in ((near, far), (far, near)):
                threading.Thread(target=self._carry, args=(source, target), daemon=True).start()

    def _carry(self, source: socket.socket, target: socket.socket) -> None:
        # A socket that the other direction has closed has no number any more.
        with contextlib.suppress(OSError, ValueError):
            while select.select([source], [], []) and (data := source.recv(65536)):
                self.whole.wait()
                target.sendall(data)
        for end in (source, target):
            end.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--robots", type=int, default=4)
    parser.add_argument("--cut", type=float, default=10.0, metavar="S", help="how long the way is cut")
    parser.add_argument("--ttl", type=float, default=0.1, metavar="S", help="time to live of a set-point")
    options = parser.parse_args()
    end_on_signals()
    port = free_port()
    with tempfile.TemporaryDirectory() as name, contextlib.ExitStack() as stack:
        folder = Path(name)
        (folder / "arm.ul").write_text(SPEC)
        (folder / "oracle.py").write_text(oracle())
        robots = "".join(
            f'[[robot]]\nname = "r{n}"\nlink = "sim:arm.ul?plant=oracle.py"\n' for n in range(options.robots)
        )
        file = folder / "fleet.toml"
        file.write_text(f'[fleet]\nname = "bench"\nrouter = "tcp/127.0.0.1:{port}"\n{robots}')
        with Supervisor(read_fleet(file), lambda robot, text: None, start_bridge) as fleet:
            if not fleet.wait_up(UP_S):
                raise SystemExit(f"not all robots came: {[one.state for one in fleet.reports()]}")
            way = Way(port)
            keys = [robot.key for robot in fleet.robots.values()]
            writers = Writers(stack, keys, f"tcp/127.0.0.1:{way.port}", options.ttl)
            cut(writers, way.let, options.cut)
        judge(folder, writers, options.ttl)


def cut(writers: Writers, let: Callable[[bool], None], cut_s: float) -> float:
    """Cut the way to robots, and mend it, while `writers` send to them. `let` does both. Then end them.

    Return when it was mended.
    """
    time.sleep(BEFORE_S)
    let(False)
    began_s = time.monotonic()
    time.sleep(cut_s)
    whole_s = time.monotonic()
    let(True)
    fresh_s = writers.fresh_after_s(whole_s)
    time.sleep(BEFORE_S)
    writers.end()
    cut_off = [
        not any(began_s + SILENT_S < came_s < whole_s for came_s, _ in heard)
        for heard in writers.heard.values()
    ]
    print(
        f"the way to {len(cut_off)} robots was cut for {cut_s:g} s; nothing came from {sum(cut_off)} of them"
    )
    print(f"all who send have fresh values {fresh_s:.2f} s later")
    return whole_s


def executed(folder: Path) -> list[tuple[float, int, float]]:
    """Return what the oracles saw: when, which value, and when it was not there yet."""
    lines = [line for file in folder.glob("*.log") for line in file.read_text().splitlines()]
    return [(float(at_s), int(value), float(before_s)) for at_s, value, before_s in map(json.loads, lines)]


def judge(folder: Path, writers: Writers, ttl_s: float) -> None:
    """Compare what the oracles saw with when it was sent."""
    sent_s = writers.sent_s
    seen = executed(folder)
    ages_s = sorted(
        (at_s - sent_s[value][0], before_s - sent_s[value][1])
        for at_s, value, before_s in seen
        if value >= APART
    )
    safe = sum(not value for _, value, _ in seen)
    print(
        f"sent {len(sent_s):,} set-points; the boards executed {len(ages_s):,}, and became safe {safe} times"
    )
    old = [(seen_s, least_s) for seen_s, least_s in ages_s if seen_s > ttl_s]
    sure = sum(least_s > ttl_s for _, least_s in old)
    print(f"ages: median {1e3 * ages_s[len(ages_s) // 2][0]:.1f} ms, oldest {1e3 * ages_s[-1][0]:.1f} ms")
    print(
        f"older than their {1e3 * ttl_s:.0f} ms: {sure}; "
        f"{len(old) - sure} more were seen later, by an oracle that had not looked in time"
    )


if __name__ == "__main__":
    main()
