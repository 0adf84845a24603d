# SPDX-License-Identifier: BSD-3-Clause
"""The speed of the compiled gateware: simulated clocks a second of the SCARA's design, and of a ring of five
nodes, while it answers and publishes.
"""

from __future__ import annotations

import time
from dataclasses import replace

from .figure import Figure, Run

SECONDS = 5.0
SECONDS_QUICK = 0.3
CLOCK_HZ = 1_000_000_000  # more than any machine simulates, so the board runs as fast as it can


def measure(run: Run) -> Figure:
    """Measure the figure. The first run compiles the design."""
    return _measure(run, "rtl", "scara", 3e6, "clocks of the compiled gateware")


def measure_ring(run: Run) -> Figure:
    """Measure it for the PC's node and four joint nodes, which exchange their words all the time."""
    return _measure(run, "rtl-ring", "scara_ring", 1e5, "clocks of a compiled ring of five nodes")


def _measure(run: Run, name: str, example: str, asked: float, what: str) -> Figure:
    from unitylink import _native
    from unitylink.layer2_message import Link
    from unitylink.layer3_hardware import TosNetProxy
    from unitylink.simulate.rtl import build_model, design_of, rtl_configuration
    from unitylink.spec import load

    spec = load(run.checkout / "examples" / example / f"{example}.ul")
    configuration = rtl_configuration(spec)
    model = build_model(design_of(spec, configuration), run.say)
    board = _native.Board(replace(configuration, clock_hz=CLOCK_HZ), "fd", "127.0.0.1", model)
    board.start()
    try:
        with Link(f"{board.url()}?timeout=5") as link:
            addresses = [element.address for _, element in spec.walk() if element.access == "READ"]
            while configuration.tosnet and not TosNetProxy(link).status().online:
                time.sleep(0.01)
            # a publish at every strobe; strobes are 1,000 clocks apart
            subscription = link.subscribe(addresses, divisor=1)
            began_s, clocks, reads = time.perf_counter(), board.time_s() * CLOCK_HZ, 0
            worked_s = time.process_time()
            while (took_s := time.perf_counter() - began_s) < (SECONDS_QUICK if run.quick else SECONDS):
                link.read_many(addresses)
                reads += 1
            worked_s = time.process_time() - worked_s
            clocks = board.time_s() * CLOCK_HZ - clocks
            publishes = len(subscription.drain()[0]) + subscription.lost
    finally:
        board.stop()
    details = {
        "publishes/s": publishes / took_s,
        "read-manys/s": reads / took_s,
        "clocks a second of processor time": clocks / worked_s,
    }
    complaint = "" if publishes else "nothing was published"
    return Figure(name, what, asked, False, clocks / took_s, "clocks/s", details, complaint)
