# SPDX-License-Identifier: BSD-3-Clause
"""Measure the time from a sensor to an actuator:  python bench/loops/loops.py [--count N] [--only WAY]

A virtual board has an input and an output. A program in another process sets the output to the input. The
times are of the clock of the computer, and an answer is seen up to 0.1 ms after it came. A board on a UART
takes as long for a byte as a UART does. The processors are kept awake.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from fault import CLOCK_HZ, fault_clocks
from position_loop import pid_s

from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import load
from unitylink_lab.bench.awake import processors_awake
from unitylink_lab.bench.programs import made
from unitylink_lab.bench.ros import LOOPBACK, free_domain

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# way -> (what it is, its processes; URL stands for that of the board)
WAYS = {
    "c-cycle": ("C, exchanges without a pause", [["C", "cycle", "URL"]]),
    "c-event": ("C, a write after each publish", [["C", "event", "URL"]]),
    "python-cycle": ("Python, exchanges without a pause", [["PYTHON", "cycle", "URL"]]),
    "python-event": ("Python, a callback that writes", [["PYTHON", "event", "URL"]]),
    "ros": (
        "ROS 2 on DDS: node, topics, another process",
        [["PYTHON", "node", "URL"], ["PYTHON", "controller"]],
    ),
}
BAUDS = (0, 3_000_000)
PATIENCE_S = 1.0  # for one answer
LOOK_S = (
    20e-6  # between two looks at the output; the system makes it some 80 us, so that the processor is free
)
PAUSE_S = 0.005  # after an answer
SEED = 20


class LoopError(RuntimeError):
    """A program did not start, or did not answer."""


def answers_us(board: Board, count: int) -> list[float]:
    """Return the times from an edge of the input until the output is seen to follow, in us."""
    draw = random.Random(SEED)
    pad = board.components["pad"]
    found = []
    for number in range(count):
        wanted = number % 2 == 0
        began = time.monotonic()
        pad.drive("pin_in", wanted, 0)
        while pad.level("pin_out", 1) != wanted:
            if time.monotonic() > began + PATIENCE_S:
                raise LoopError(f"edge {number}: no answer within {PATIENCE_S:g} s")
            time.sleep(LOOK_S)
        found.append(1e6 * (time.monotonic() - began))
        time.sleep(PAUSE_S + draw.uniform(0, 0.01))
    return found


@contextmanager
def programs(commands: list[list[str]], url: str, c_program: Path) -> Iterator[None]:
    """Run programs until the end of the block. Each has said that its loop runs."""
    with ExitStack() as stack:
        for command in commands:
            first = {"C": [str(c_program)], "PYTHON": [sys.executable, str(HERE / "program.py")]}[command[0]]
            words = [*first, *(url if word == "URL" else word for word in command[1:])]
            running = stack.enter_context(subprocess.Popen(words, stdout=subprocess.PIPE, text=True))
            stack.callback(running.kill)
            assert running.stdout is not None
            if running.stdout.readline() != "ready\n":
                raise LoopError(f"{' '.join(words)} did not start")
        yield


def measure(way: str, baud_hz: int, count: int, c_program: Path) -> list[float]:
    """Return the times of one way, sorted."""
    spec = load(str(HERE / "board.ul"))
    configuration = BoardConfiguration.for_spec(spec, baud_hz=baud_hz, protocol="framed")
    with ExitStack() as stack:
        stack.enter_context(processors_awake())
        board = stack.enter_context(Board(spec, configuration=configuration, endpoint="pty"))
        # a busy machine may keep the board from answering for longer than the default of 0.3 s
        with programs(WAYS[way][1], f"{board.url}?timeout=10", c_program):
            for attempt in range(20):  # until the topics have found each other
                try:
                    answers_us(board, 2)
                    break
                except LoopError:
                    if attempt == 19:
                        raise
            return sorted(answers_us(board, count))


def ranks(found: list[Any]) -> list[Any]:
    """Return the median, the 99th percentile and the last of a sorted list."""
    return [found[len(found) // 2], found[len(found) * 99 // 100], found[-1]]


def compiled() -> Path:
    """Return the program in C, compiled against the library of this checkout."""
    out = ROOT / "build" / "bench" / "loop"
    out.parent.mkdir(parents=True, exist_ok=True)
    library = ROOT / "build" / "native"
    options = ["-L", library, "-lunitylink", f"-Wl,-rpath,{library}"]
    made(["cc", "-O2", "-std=c11", "-I", ROOT / "native" / "include", HERE / "loop.c", "-o", out, *options])
    return out


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description="Measure the time from a sensor to an actuator.")
    parser.add_argument("--count", type=int, default=400, help="edges for each row")
    parser.add_argument("--only", choices=WAYS, action="append", help="this way only; may be repeated")
    given = parser.parse_args()
    os.environ |= {"CYCLONEDDS_URI": LOOPBACK, "ROS_DOMAIN_ID": str(free_domain())}
    ways = given.only or list(WAYS)
    c_program = compiled() if any(way.startswith("c-") for way in ways) else Path()
    print("| loop | line | median | 99 % | longest |\n| -- | -- | -- | -- | -- |")
    if not given.only:
        shown = [f"{clocks / CLOCK_HZ * 1e9:.0f} ns" for clocks in ranks(fault_clocks())]
        print(f"| gateware, a fault to the gates of h_bridge at 50 MHz | none | {' | '.join(shown)} |")
        shown = [f"{1e6 * one:.0f} µs" for one in ranks(pid_s(given.count))]
        what = "gateware, pid at 20 kHz, from an encoder to h_bridge at 20 kHz"
        print(f"| {what} | none | {' | '.join(shown)} |")
    for way in ways:
        for baud_hz in BAUDS:
            times = measure(way, baud_hz, given.count, c_program)
            line = f"UART, {baud_hz / 1e6:g} MBd" if baud_hz else "no limit"
            shown = [f"{one:.0f} µs" for one in ranks(times)]
            print(f"| {WAYS[way][0]} | {line} | {' | '.join(shown)} |", flush=True)


if __name__ == "__main__":
    main()
