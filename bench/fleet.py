# SPDX-License-Identifier: BSD-3-Clause
"""Many virtual robots on one router: what is lost, how late it is, and what each robot costs.

    python bench/fleet.py
    python bench/fleet.py --robots 64 --rate 10 --kill-router

The router, the fleet with its bridges, and the reader of all publishes are processes of this machine.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import signal
import statistics
import struct
import tempfile
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from processes import Processes, end_on_signals, free_port, router_program

from unitylink.commands.fleet_bridges import start_bridge
from unitylink.fleet.description import Fleet
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.supervisor import Supervisor
from unitylink.zenoh.session import Network

WORDS = 18
HEAD = struct.Struct("<Iq")  # of a publication: sequence, time by the bridge's clock
UP_S = 120.0
TICKS_HZ = os.sysconf("SC_CLK_TCK")


class Reader:
    """Counts what comes of one robot, and what is missing by its sequence."""

    def __init__(self) -> None:
        self.came = self.missing = self.begun_again = 0
        self.newest_s = 0.0  # when its newest publish was sampled
        self.since_s, self.fresh_s = (
            math.inf,
            math.nan,
        )  # when the first came that was sampled after `since_s`
        self.delays_ms: list[float] = []
        self._next: int | None = None
        self._lock = threading.Lock()

    def take(self, data: bytes) -> None:
        sequence, time_ns = HEAD.unpack_from(data)
        now_ns = time.monotonic_ns()
        with self._lock:
            gap = 0 if self._next is None else (sequence - self._next) & 0xFFFFFFFF
            if gap < 1 << 31:
                self.missing += gap
            else:  # another bridge counts from 0
                self.begun_again += 1
            self._next = sequence + 1
            self.came += 1
            self.newest_s = time_ns / 1e9
            if self.newest_s > self.since_s:
                self.since_s, self.fresh_s = math.inf, now_ns / 1e9
            self.delays_ms.append((now_ns - time_ns) / 1e6)

    def expect(self, since_s: float) -> None:
        """Note in `fresh_s` when something comes that was sampled after `since_s`."""
        with self._lock:
            self.since_s, self.fresh_s = since_s, math.nan

    def restart(self) -> None:
        """Count from here."""
        with self._lock:
            self.came = self.missing = self.begun_again = 0
            self.delays_ms = []


def cpu_s(pid: int) -> float:
    """Return the processor time of a process. NaN: it has ended."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except FileNotFoundError:
        return math.nan
    return (int(fields[11]) + int(fields[12])) / TICKS_HZ


def memory_mb(pid: int) -> float:
    """Return the memory of a process that it shares with no other, and its part of what is shared."""
    rows = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return next(int(row.split()[1]) for row in rows if row.startswith("Pss:")) / 1024


def described(folder: Path, count: int, rate_hz: int, router: str) -> Fleet:
    """Write and read the description of a fleet."""
    items = "".join(f"@v{n} = 0x{0x10 + n:X}: READ(PUBLISH({rate_hz} Hz)); " for n in range(WORDS))
    (folder / "arm.ul").write_text(f"public arm() {{ {items}}}\n")
    robots = "".join(f'[[robot]]\nname = "r{n}"\nlink = "sim:arm.ul?plant=ramp"\n' for n in range(count))
    file = folder / "fleet.toml"
    file.write_text(f'[fleet]\nname = "bench"\nconnect = "{router}"\n{robots}')
    return read_fleet(file)


def until(true: object, within_s: float) -> float:
    """Wait until something is true. Return how long it took."""
    began_s = time.monotonic()
    while not true():  # type: ignore[operator]
        if time.monotonic() - began_s > within_s:
            raise SystemExit(f"not within {within_s:.0f} s")
        time.sleep(0.01)
    return time.monotonic() - began_s


def measure(
    readers: dict[str, Reader], rate_hz: int, seconds: float, programs: Mapping[str, Sequence[int]]
) -> None:
    """Print what comes in some seconds, and what that costs. `programs` are processes by what they do."""
    for reader in readers.values():
        reader.restart()
    all_pids = [pid for pids in programs.values() for pid in pids]
    before, idle_s, began_s = {pid: cpu_s(pid) for pid in all_pids}, machine_idle_s(), time.monotonic()
    time.sleep(seconds)
    took_s = time.monotonic() - began_s
    used = {pid: (cpu_s(pid) - before[pid]) / took_s for pid in all_pids}
    idle = (machine_idle_s() - idle_s) / took_s
    came, missing, again = (
        sum(getattr(one, what) for one in readers.values()) for what in ("came", "missing", "begun_again")
    )
    delays = sorted(delay for one in readers.values() for delay in one.delays_ms)
    asked = len(readers) * rate_hz * took_s
    print(f"came {came:,} publishes of {WORDS} words in {took_s:.1f} s ({came / asked:.2f} of what is asked)")
    print(f"lost by sequence {missing}" + (f"; {again} bridges have begun again" if again else ""))
    late_ms = delays[len(delays) * 99 // 100]
    print(f"from bridge to reader: median {statistics.median(delays):.2f} ms, 99 % {late_ms:.1f} ms")
    for name, pids in programs.items():
        there = [pid for pid in pids if not math.isnan(used[pid])]
        shares = [100 * used[pid] for pid in there]
        print(f"{name}: {statistics.mean(shares):.2f} % of a core, {memory_mb(there[0]):.1f} MB", end="")
        print(f"; {len(shares)} of them {sum(shares):.0f} %" if len(pids) > 1 else "")
    print(f"of {os.cpu_count()} cores, {100 * idle:.0f} % of one is free", flush=True)


def machine_idle_s() -> float:
    """Return how long all processors of the machine had nothing to do."""
    return int(Path("/proc/stat").read_text().split(maxsplit=5)[4]) / TICKS_HZ


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--robots", type=int, default=8)
    parser.add_argument("--rate", type=int, default=100, metavar="HZ", help="of publishes (%(default)d)")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--kill-router", action="store_true", help="kill it, and start it again after 2 s")
    options = parser.parse_args()
    end_on_signals()
    locator = f"tcp/127.0.0.1:{free_port()}"
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        programs = Processes(stack)
        router, _ = programs.start(*router_program(locator))
        fleet = described(Path(folder), options.robots, options.rate, locator)
        began_s = time.monotonic()
        supervisor = stack.enter_context(Supervisor(fleet, lambda name, text: None, start_bridge))
        if not supervisor.wait_up(UP_S):
            raise SystemExit("not all robots came")
        print(f"{options.robots} robots are up after {time.monotonic() - began_s:.1f} s")
        session = stack.enter_context(Network(connect=locator).opened())
        readers = {robot.key: Reader() for robot in fleet.robots}
        for key, reader in readers.items():
            session.declare_subscriber(
                f"{key}/publish/{options.rate}_hz",
                lambda sample, take=reader.take: take(sample.payload.to_bytes()),
            )
        until(lambda: all(one.came for one in readers.values()), UP_S)
        pids = [one.pid for one in supervisor.reports() if one.pid is not None]
        measured = {"router": [router.pid], "a bridge with its board": pids, "this reader": [os.getpid()]}
        measure(readers, options.rate, options.seconds, measured)
        gone = until_gone(supervisor, pids[0])
        print(f"a bridge is killed: its token is gone after {gone:.3f} s")
        if options.kill_router:
            router.kill()
            router.wait()
            time.sleep(2.0)
            back_s = float(programs.start(*router_program(locator))[1])
            until(lambda: all(one.newest_s > back_s for one in readers.values()), UP_S)
            fresh = time.monotonic() - back_s
            print(f"the router is killed, and back after 2 s: all values are fresh {fresh:.2f} s later")


def until_gone(supervisor: Supervisor, pid: int) -> float:
    """Kill a bridge, and return how long the network shows it."""
    name = next(one.name for one in supervisor.reports() if one.pid == pid)
    os.kill(pid, signal.SIGKILL)
    return until(lambda: not next(one for one in supervisor.reports() if one.name == name).reachable, UP_S)


if __name__ == "__main__":
    main()
