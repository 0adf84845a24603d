# SPDX-License-Identifier: BSD-3-Clause
"""How soon all values are fresh again after robots were cut off from the network, cut by cut. Needs root.

    python bench/cuts.py
    python bench/cuts.py --cuts 20 --cut 10 --robots 4

Robots, router and reader are in network namespaces of their own. A switch drops what goes to and from the
robots, and nobody is told. Set-points go to the robots all the time, as in `namespaces.py`.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import statistics
import tempfile
import threading
import time
from pathlib import Path

from fleet import UP_S, until
from namespaces import PORT, ROUTER, TTL_S, Lab, described, pids
from partition import BEFORE_S, Sender, end, judge, started


def fresh_after_s(senders: list[Sender], since_s: float) -> float:
    """Wait until all robots have published since then. Return how long that took."""
    until(lambda: all(one.last_seen_s > since_s for one in senders), UP_S)
    return max(one.last_seen_s for one in senders) - since_s


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--robots", type=int, default=2)
    parser.add_argument("--cuts", type=int, default=12)
    parser.add_argument(
        "--cut", type=float, default=10.0, metavar="S", help="how long each takes, and up to 1 s more"
    )
    options = parser.parse_args()
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lab = Lab(stack)
        router = f"tcp/{lab.join('router1')}:{PORT}"
        for name in ("robots", "reader"):
            lab.join(name)
        lab.start("router1", "-c", ROUTER, router, "")
        fleet = described(folder, options.robots, router)
        lab.start("robots", "-m", "unitylink", "fleet", str(fleet.file))
        lab.enter("reader")
        until(lambda: pids(fleet), UP_S)
        stop = threading.Event()
        senders = started([robot.key for robot in fleet.robots], router, TTL_S, stop)
        until(lambda: all(one.last_seen_s for one in senders), UP_S)
        times_s: list[float] = []
        for number in range(1, options.cuts + 1):
            time.sleep(BEFORE_S)
            lab.let("robots", False)
            time.sleep(options.cut + random.random())
            lab.let("robots", True)
            times_s.append(fresh_after_s(senders, time.monotonic()))
            print(f"cut {number}: all values are fresh {times_s[-1]:.2f} s later", flush=True)
        end(senders, stop)
        print(f"median {statistics.median(times_s):.2f} s, worst {max(times_s):.2f} s", end="; ")
        quick = sum(one <= 1 for one in times_s)
        print(f"within 1 s: {quick} of {len(times_s)}; load {os.getloadavg()[0]:.0f}")
        judge(folder, senders, TTL_S)


if __name__ == "__main__":
    main()
