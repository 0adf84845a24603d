# SPDX-License-Identifier: BSD-3-Clause
"""Robots, routers and readers in network namespaces, as on machines of their own. Needs root.

    python bench/namespaces.py
    python bench/namespaces.py --robots 16 --routers 2

Virtual cables join them to a switch, which can drop what goes to one of them, or slow it down. One after the
other: all is well; a reader is slow; a board dies; a router is killed, and comes back; the robots are cut off
while set-points go to them, and an oracle on each board notes what is executed.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import zenoh
from fleet import UP_S, WORDS, Reader, measure, until
from partition import ORACLE, cut, executed, judge

from unitylink.errors import UnityLinkError
from unitylink.fleet.description import Fleet
from unitylink.fleet.look import look_at
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.robots import Robots
from unitylink.zenoh.session import Network

RATE_HZ, TTL_S, DOWN_S, PORT = 100, 0.1, 2.0, 7447
STAMP, STARTS = 0x40, 100
ITEMS = "".join(f"@v{n} = 0x{0x10 + n:X}: READ(PUBLISH({RATE_HZ} Hz)); " for n in range(WORDS - 1))
SPEC = (
    f"public arm() {{ {ITEMS}@count = 0x30: READ(PUBLISH({RATE_HZ} Hz)); "
    f"@stamp = {STAMP:#x}: u32 WRITE(SAFE=0); }}\n"
)
ROUTER = """
import sys, time
from unitylink.zenoh.session import Network
with Network(listen=sys.argv[1], connect=sys.argv[2]).opened():
    print("there", flush=True)
    time.sleep(3600)
"""
SLOW = """
import sys, time
from unitylink.zenoh.session import Network
with Network(connect=sys.argv[1]).opened() as session:
    kept = session.declare_subscriber("bench/*/publish/**", lambda sample: None)
    print("there", flush=True)
    time.sleep(3600)
"""
SLOW_RATE = "100kbit"


def ip(*words: str) -> None:
    """Run `ip`. Raises CalledProcessError."""
    subprocess.run(["ip", *words], check=True)


class Lab:
    """Namespaces around a switch. All ends with the `with` block."""

    def __init__(self, stack: contextlib.ExitStack) -> None:
        self._stack = stack
        self._mark = f"ul{os.getpid()}"
        self._names: list[str] = []
        self._switch = self._namespace("switch")
        ip("-n", self._switch, "link", "add", "switch", "type", "bridge")
        ip("-n", self._switch, "link", "set", "switch", "up")

    def _namespace(self, name: str) -> str:
        whole = f"{self._mark}{name}"
        ip("netns", "add", whole)
        self._stack.callback(subprocess.run, ["ip", "netns", "del", whole], check=False)
        ip("-n", whole, "link", "set", "lo", "up")
        return whole

    def join(self, name: str) -> str:
        """Make a namespace, with a cable to the switch. Return its address."""
        space = self._namespace(name)
        self._names.append(name)
        address = f"10.77.0.{len(self._names)}"
        ip("link", "add", name, "netns", self._switch, "type", "veth", "peer", "name", "net", "netns", space)
        ip("-n", self._switch, "link", "set", name, "master", "switch", "up")
        ip("-n", space, "address", "add", f"{address}/24", "dev", "net")
        ip("-n", space, "link", "set", "net", "up")
        return address

    def start(self, name: str, *words: str) -> subprocess.Popen[str]:
        """Start a program there, and wait for its first line."""
        space = f"{self._mark}{name}"
        one = subprocess.Popen(
            ["ip", "netns", "exec", space, sys.executable, *words], stdout=subprocess.PIPE, text=True
        )
        self._stack.callback(one.wait)
        self._stack.callback(one.terminate)
        assert one.stdout is not None
        one.stdout.readline()
        return one

    def let(self, name: str, through: bool) -> None:
        """Pull a cable out of the switch, or put it back. Its end in the namespace does not notice."""
        ip("-n", self._switch, "link", "set", name, *(("master", "switch") if through else ("nomaster",)))

    def slow_down(self, name: str, rate: str) -> None:
        """Let the switch give so many bits a second at most to a namespace."""
        limit = ("tbf", "rate", rate, "burst", "10kb", "latency", "100ms")
        subprocess.run(
            ["tc", "-n", self._switch, "qdisc", "add", "dev", name, "root", *limit],
            check=True,
        )

    def enter(self, name: str) -> None:
        """Let this thread, and all that it starts, be there."""
        with open(f"/run/netns/{self._mark}{name}", "rb") as space:
            if ctypes.CDLL(None, use_errno=True).setns(space.fileno(), 0):
                raise OSError(ctypes.get_errno(), "setns")


def described(folder: Path, robots: int, router: str) -> Fleet:
    """Write and read the description of a fleet whose router is elsewhere."""
    (folder / "arm.ul").write_text(SPEC)
    (folder / "oracle.py").write_text(ORACLE.replace("0x10", hex(STAMP)))
    rows = "".join(f'[[robot]]\nname = "r{n}"\nlink = "sim:arm.ul?plant=oracle.py"\n' for n in range(robots))
    file = folder / "fleet.toml"
    file.write_text(f'[fleet]\nname = "bench"\nconnect = "{router}"\n{rows}')
    return read_fleet(file)


def pids(fleet: Fleet) -> list[int]:
    """Return the processes of the bridges, or none if not all robots are reachable."""
    with contextlib.suppress(UnityLinkError):
        _, robots = look_at(fleet)
        found = [one.pid for one in robots if one.reachable and one.pid is not None]
        return found if len(found) == len(robots) else []
    return []


@contextlib.contextmanager
def reading(session: zenoh.Session, fleet: Fleet) -> Iterator[dict[str, Reader]]:
    """Read all publishes."""
    readers = {robot.key: Reader() for robot in fleet.robots}
    subscribers = [
        session.declare_subscriber(
            f"{key}/publish/{RATE_HZ}_hz", lambda sample, take=one.take: take(sample.payload.to_bytes())
        )
        for key, one in readers.items()
    ]
    until(lambda: all(one.came for one in readers.values()), UP_S)
    yield readers
    for one in subscribers:
        one.undeclare()


def gone_after_s(session: zenoh.Session, pid: int) -> float:
    """Kill a bridge with its board. Return how long the network shows the token of the board."""
    gone: list[float] = []

    def heard(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            gone.append(time.monotonic())

    with session.liveliness().declare_subscriber("bench/*/board/*", heard):
        killed_s = time.monotonic()
        os.kill(pid, signal.SIGKILL)
        until(lambda: gone, UP_S)
    return gone[0] - killed_s


def spreads_ms(fleet: Fleet, folder: Path) -> list[float]:
    """Write an item of all robots together, again and again. Return within what times the boards saw it."""
    with Robots(fleet.file) as robots:
        group = robots.group("stamp")
        for number in range(STARTS + 1):  # the first takes the leases
            group.write(dict.fromkeys(robots, 1 + number))
            time.sleep(0.01)
    times_s: dict[int, list[float]] = {}
    for at_s, value, _ in executed(folder):
        times_s.setdefault(value, []).append(at_s)
    whole = [times_s.get(2 + number, []) for number in range(STARTS)]
    return sorted(1e3 * (max(some) - min(some)) for some in whole if len(some) == len(fleet.robots))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--robots", type=int, default=4)
    parser.add_argument(
        "--routers", type=int, choices=(1, 2), default=1, help="2: the reader is at the second"
    )
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument(
        "--cut", type=float, default=10.0, metavar="S", help="how long the robots are cut off"
    )
    options = parser.parse_args()
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lab = Lab(stack)
        first, last = (f"tcp/{lab.join(name)}:{PORT}" for name in ("router1", "router2"))
        if options.routers == 1:
            last = first
        for name in ("robots", "reader", "slow"):
            lab.join(name)
        router = lab.start("router1", "-c", ROUTER, first, "")
        if options.routers == 2:
            lab.start("router2", "-c", ROUTER, last, first)
        fleet = described(folder, options.robots, first)
        lab.start("robots", "-m", "unitylink", "fleet", str(fleet.file))
        lab.enter("reader")
        there_s = until(lambda: pids(fleet), UP_S)
        print(f"{options.robots} robots are up after {there_s:.1f} s; {options.routers} router(s)")
        session = stack.enter_context(Network(connect=last).opened())
        with reading(session, fleet) as readers:
            bridges = pids(fleet)
            measure(readers, RATE_HZ, router.pid, bridges, options.seconds)
            print(f"-- a reader beside it gets {SLOW_RATE}/s at most")
            lab.slow_down("slow", SLOW_RATE)
            slow = lab.start("slow", "-c", SLOW, last)
            measure(readers, RATE_HZ, router.pid, bridges, options.seconds)
            slow.kill()
            print(f"-- a board dies: its token is gone after {gone_after_s(session, bridges[0]):.3f} s")
            until(lambda: pids(fleet), UP_S)
            router.kill()
            time.sleep(DOWN_S)
            router = lab.start("router1", "-c", ROUTER, first, "")
            back_s = time.monotonic()
            fresh_s = until(lambda: all(one.last_s > back_s for one in readers.values()), UP_S)
            print(f"-- a router is away for {DOWN_S:g} s: all values are fresh {fresh_s:.2f} s later")
        until(lambda: pids(fleet), UP_S)
        apart_ms = spreads_ms(fleet, folder)
        print(
            f"-- {len(apart_ms)} of {STARTS} writes to all robots together came to the boards within "
            f"{apart_ms[len(apart_ms) // 2]:.1f} ms (median), {apart_ms[-1]:.1f} ms at most"
        )
        keys = [robot.key for robot in fleet.robots]
        senders = cut(keys, last, lambda through: lab.let("robots", through), options.cut, TTL_S)
        judge(folder, senders, TTL_S)


if __name__ == "__main__":
    main()
