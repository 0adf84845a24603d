# SPDX-License-Identifier: BSD-3-Clause
"""Robots, routers and readers in network namespaces, as on machines of their own. Needs root.

    python bench/namespaces.py
    python bench/namespaces.py --robots 64 --machines 8 --set-points 0

Virtual cables join them to a switch, which can drop what goes to one of them, or slow it down. One after the
other: all is well; a reader is slow; a board dies; a router is killed, and comes back; the robots are cut off
while set-points go to them, and an oracle on each board notes what is executed. All publishes are read all
the time.
"""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import signal
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import zenoh
from fleet import UP_S, WORDS, Reader, measure, until
from lab import PORT, Lab
from partition import cut, executed, judge, oracle
from processes import end_on_signals, router_program
from writers import Writers

from unitylink.fleet.description import Fleet
from unitylink.fleet.look import look_at
from unitylink.fleet.reader import read_fleet
from unitylink.fleet.report import RobotReport
from unitylink.fleet.robots import Robots
from unitylink.zenoh.session import Network

TTL_S, DOWN_S, HEARD_HZ = 0.1, 2.0, 10.0
STAMP, STARTS = 0x40, 100
SLOW = """
import sys, time
from unitylink.zenoh.session import Network
with Network(connect=sys.argv[1]).opened() as session:
    kept = session.declare_subscriber("*/*/publish/**", lambda sample: None)
    print("there", flush=True)
    time.sleep(3600)
"""
SLOW_RATE = "100kbit"


def described(
    folder: Path, robots: int, router: str, *, machines: int = 1, rate_hz: int = 100, look_s: float = 0.001
) -> tuple[Fleet, list[Fleet]]:
    """Write and read the description of all robots, and that of each machine. The router is elsewhere.

    An oracle on each board looks every `look_s`. 0: there is none.
    """
    items = "".join(f"@v{n} = 0x{0x10 + n:X}: READ(PUBLISH({rate_hz} Hz)); " for n in range(WORDS - 1))
    count = f"@count = 0x30: READ(PUBLISH({rate_hz} Hz)); "
    (folder / "arm.ul").write_text(
        f"public arm() {{ {items}{count}@stamp = {STAMP:#x}: u32 WRITE(SAFE=0); }}\n"
    )
    (folder / "oracle.py").write_text(oracle(STAMP, look_s))
    link = "sim:arm.ul?plant=oracle.py" if look_s else "sim:arm.ul"

    def fleet(name: str, numbers: Sequence[int]) -> Fleet:
        rows = "".join(f'[[robot]]\nname = "r{n}"\nkey = "bench/r{n}"\nlink = "{link}"\n' for n in numbers)
        file = folder / f"{name}.toml"
        file.write_text(f'[fleet]\nname = "{name}"\nconnect = "{router}"\n{rows}')
        return read_fleet(file)

    all_of_them = range(robots)
    return fleet("all", all_of_them), [fleet(f"m{n}", all_of_them[n::machines]) for n in range(machines)]


def up(fleets: Sequence[Fleet]) -> list[RobotReport]:
    """Wait until all robots are reachable, and their fleets tell of them. Return their reports."""
    limit_s = time.monotonic() + UP_S
    while True:
        reports = [one for fleet in fleets for one in look_at(fleet, UP_S)[1]]
        away = [one.key for one in reports if not one.reachable or one.pid is None]
        if not away:
            return reports
        if time.monotonic() > limit_s:
            raise SystemExit(f"not reachable within {UP_S:.0f} s: {', '.join(away)}")


@contextlib.contextmanager
def reading(session: zenoh.Session, fleet: Fleet, rate_hz: int) -> Iterator[dict[str, Reader]]:
    """Read all publishes."""
    readers = {robot.key: Reader() for robot in fleet.robots}
    subscribers = [
        session.declare_subscriber(
            f"{key}/publish/{rate_hz}_hz", lambda sample, take=one.take: take(sample.payload.to_bytes())
        )
        for key, one in readers.items()
    ]
    try:
        until(lambda: all(one.came for one in readers.values()), UP_S)
    except SystemExit as late:
        silent = ", ".join(key for key, one in readers.items() if not one.came)
        raise SystemExit(f"{late}: {silent}") from None
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
        "--machines",
        type=int,
        default=1,
        help="that the robots are spread over, each with a fleet of its own",
    )
    parser.add_argument(
        "--routers", type=int, choices=(1, 2), default=1, help="2: the reader is at the second"
    )
    parser.add_argument("--rate", type=int, default=100, metavar="HZ", help="of publishes (%(default)d)")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument(
        "--cut", type=float, default=10.0, metavar="S", help="how long the robots are cut off"
    )
    parser.add_argument(
        "--set-points",
        type=float,
        default=50.0,
        metavar="HZ",
        help="to each robot (%(default)g); 0: nothing is written, and no oracle looks",
    )
    parser.add_argument(
        "--look", type=float, default=0.001, metavar="S", help="how often an oracle looks (%(default)g)"
    )
    options = parser.parse_args()
    end_on_signals()
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lab = Lab(stack)
        first, last = (f"tcp/{lab.join(name)}:{PORT}" for name in ("router1", "router2"))
        if options.routers == 1:
            last = first
        machines = [f"m{n}" for n in range(options.machines)]
        for name in (*machines, "reader", "slow"):
            lab.join(name)
        router, _ = lab.start("router1", *router_program(first))
        routers = [router.pid]
        if options.routers == 2:
            routers.append(lab.start("router2", *router_program(last, first))[0].pid)
        whole, fleets = described(
            folder,
            options.robots,
            first,
            machines=options.machines,
            rate_hz=options.rate,
            look_s=options.look if options.set_points else 0.0,
        )
        started_s = time.monotonic()
        supervisors = [
            lab.start(name, "-m", "unitylink", "fleet", str(fleet.file))[0].pid
            for name, fleet in zip(machines, fleets, strict=True)
        ]
        lab.enter("reader")
        bridges = [one.pid for one in up(fleets) if one.pid is not None]
        print(f"{options.robots} robots on {options.machines} machine(s) are up", end=" ")
        print(f"after {time.monotonic() - started_s:.1f} s; {options.routers} router(s)", flush=True)
        session = stack.enter_context(Network(connect=last).opened())
        readers = stack.enter_context(reading(session, whole, options.rate))
        programs = {
            "router": routers,
            "a bridge with its board": bridges,
            "a fleet": supervisors,
            "this reader": [os.getpid()],
        }
        measure(readers, options.rate, options.seconds, programs)
        print(f"-- a reader beside it gets {SLOW_RATE}/s at most")
        lab.slow_down("slow", SLOW_RATE)
        slow, _ = lab.start("slow", "-c", SLOW, last)
        measure(readers, options.rate, options.seconds, programs)
        slow.kill()
        print(
            f"-- a board dies: its token is gone after {gone_after_s(session, bridges[0]):.3f} s", flush=True
        )
        up(fleets)
        router.kill()
        time.sleep(DOWN_S)
        router, began_s = lab.start("router1", *router_program(first))
        routers[0], back_s = router.pid, float(began_s)
        until(lambda: all(one.newest_s > back_s for one in readers.values()), UP_S)
        fresh_s = time.monotonic() - back_s
        print(f"-- a router is away for {DOWN_S:g} s: all values are fresh {fresh_s:.2f} s later", flush=True)
        up(fleets)

        def let(through: bool) -> None:
            for one in readers.values() if through else ():
                one.expect(time.monotonic())
            for name in machines:
                lab.let(name, through)

        if options.set_points:
            apart_ms = spreads_ms(whole, folder)
            print(
                f"-- {len(apart_ms)} of {STARTS} writes to all robots together came to the boards within "
                f"{apart_ms[len(apart_ms) // 2]:.1f} ms (median), {apart_ms[-1]:.1f} ms at most"
            )
            keys, period_s = [robot.key for robot in whole.robots], 1 / options.set_points
            writers = Writers(stack, keys, last, TTL_S, period_s=period_s, heard_hz=HEARD_HZ)
            programs |= {
                "a bridge with its board": [one.pid for one in up(fleets) if one.pid is not None],
                "a program that sends set-points to up to 8 robots": writers.pids,
            }
            measure(readers, options.rate, options.seconds, programs)
            whole_s = cut(writers, let, options.cut)
            judge(folder, writers, TTL_S)
        else:
            let(False)
            time.sleep(options.cut)
            whole_s = time.monotonic()
            let(True)
            until(lambda: not any(math.isnan(one.fresh_s) for one in readers.values()), UP_S)
        fresh_s = max(one.fresh_s for one in readers.values()) - whole_s
        print(
            f"-- robots are cut off for {options.cut:g} s: "
            f"the reader of all publishes has fresh ones {fresh_s:.2f} s later"
        )
        again = sum(one.restarts or 0 for one in up(fleets))
        print(f"bridges were started again: {again}, of which this bench killed 1")


if __name__ == "__main__":
    main()
