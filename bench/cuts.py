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
import time
from pathlib import Path

from lab import PORT, Lab
from namespaces import described, up
from partition import BEFORE_S, judge
from processes import end_on_signals, router_program
from writers import Writers

TTL_S = 0.1


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--robots", type=int, default=2)
    parser.add_argument("--cuts", type=int, default=12)
    parser.add_argument(
        "--cut", type=float, default=10.0, metavar="S", help="how long each takes, and up to 1 s more"
    )
    options = parser.parse_args()
    end_on_signals()
    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        lab = Lab(stack)
        router = f"tcp/{lab.join('router1')}:{PORT}"
        for name in ("m0", "reader"):
            lab.join(name)
        lab.start("router1", *router_program(router))
        whole, (fleet,) = described(folder, options.robots, router)
        lab.start("m0", "-m", "unitylink", "fleet", str(fleet.file))
        lab.enter("reader")
        up([fleet])
        writers = Writers(stack, [robot.key for robot in whole.robots], router, TTL_S)
        times_s: list[float] = []
        for number in range(1, options.cuts + 1):
            time.sleep(BEFORE_S)
            lab.let("m0", False)
            time.sleep(options.cut + random.random())
            whole_s = time.monotonic()
            lab.let("m0", True)
            times_s.append(writers.fresh_after_s(whole_s))
            print(f"cut {number}: all values are fresh {times_s[-1]:.2f} s later", flush=True)
        time.sleep(BEFORE_S)
        writers.end()
        print(f"median {statistics.median(times_s):.2f} s, worst {max(times_s):.2f} s", end="; ")
        quick = sum(one <= 1 for one in times_s)
        print(f"within 1 s: {quick} of {len(times_s)}; load {os.getloadavg()[0]:.0f}")
        judge(folder, writers, TTL_S)


if __name__ == "__main__":
    main()
