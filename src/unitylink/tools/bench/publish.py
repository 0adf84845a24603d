# SPDX-License-Identifier: BSD-3-Clause
"""Publishes: what it costs to decode, check and drain a stream of them, and how fast callbacks are called.

The source is another process and numbers every message, so that a lost or doubled one cannot hide.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from .board import ADDRESS
from .figure import BenchError, Figure, Run
from .programs import Process, native

if TYPE_CHECKING:
    import numpy.typing as npt

    from unitylink.layer2_message import Subscription

BITS_PER_SECOND = 64_000_000
MESSAGE_BYTES = 21  # &PUB:ggnnxxxxxxxx*hh and the line feed
DRAIN_S = 0.02
RING = 1 << 16
FLOOD_PER_SECOND = 1_000_000
PACED_PER_SECOND = 525_000
PTY_BAUD = 100_000_000  # what a pty would have to be called for the stream to fit


@dataclass(frozen=True)
class Stream:
    """What was seen of a stream in one window after another."""

    cpu_percent: float  # of one core, user and system, all threads; median of the windows
    mbit_per_second: float  # of messages that arrived
    messages: int
    missing: int


@contextmanager
def subscription(run: Run, endpoint: str, bits_per_second: int) -> Iterator[Subscription]:
    """Start a source and subscribe to it."""
    from unitylink import connect

    options = ["--endpoint", endpoint, "--bits-per-second", str(bits_per_second)]
    with Process([native(run.checkout, "bench_publish_source"), *options]) as source:
        place = source.line()
        url = f"tcp://{place}?" if endpoint == "tcp" else f"serial:{place}?baud={PTY_BAUD}&"
        with (
            connect(f"{url}protocol=classic") as link,
            link.subscribe([ADDRESS], divisor=1, ring=RING) as stream,
        ):
            if not stream.wait(5.0):
                raise BenchError(f"the publish source on {endpoint} published nothing for 5 s")
            yield stream


def watch(run: Run, endpoint: str) -> Stream:
    """Drain a paced stream for some seconds and account for every message."""
    windows = run.rounds(5)
    window_s = 1.0 if not run.quick else 0.2
    drained: list[npt.NDArray[np.uint32]] = []
    shares: list[float] = []
    rates: list[float] = []
    with subscription(run, endpoint, BITS_PER_SECOND) as stream:
        drained.append(stream.drain()[1])
        for _ in range(windows):
            count = 0
            wall, cpu = time.perf_counter(), time.process_time()
            while time.perf_counter() - wall < window_s:
                time.sleep(DRAIN_S)
                words = stream.drain()[1]
                drained.append(words)
                count += len(words)
            cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
            shares.append(100 * cpu / wall)
            rates.append(count * MESSAGE_BYTES * 8 / wall / 1e6)
    numbers = np.concatenate(drained)[:, 0].astype(np.int64)
    missing = int(np.sum(np.abs(np.diff(numbers) - 1)))
    return Stream(median(shares), median(rates), len(numbers), missing)


def measure_stream(run: Run) -> Figure:
    """Measure the processor time of a 64 Mbit/s stream, over TCP and over a pty."""
    tcp = watch(run, "tcp")
    pty = watch(run, "pty")
    complaint = ""
    if tcp.missing:
        complaint = f"{tcp.missing} of {tcp.messages} messages did not arrive"
    elif tcp.mbit_per_second < 0.98 * BITS_PER_SECOND / 1e6:
        complaint = f"only {tcp.mbit_per_second:.1f} Mbit/s arrived"
    return Figure(
        "publish",
        "64 Mbit/s of publishes decoded, checked, drained; TCP",
        10,
        True,
        tcp.cpu_percent,
        "% of a core",
        {
            "TCP Mbit/s": tcp.mbit_per_second,
            "TCP missing": tcp.missing,
            "pty % of a core": pty.cpu_percent,
            "pty Mbit/s": pty.mbit_per_second,
            "pty missing": pty.missing,
        },
        complaint,
    )


class Counter:
    """A callback that counts and notices gaps."""

    def __init__(self) -> None:
        self.calls = 0
        self.missing = 0
        self.next = -1

    def __call__(self, time_s: float, values: tuple[int, ...]) -> None:
        """Take one publish."""
        number = values[0]
        if number != self.next and self.next >= 0:
            self.missing += abs(number - self.next)
        self.next = number + 1
        self.calls += 1


def count_callbacks(run: Run, per_second: int) -> tuple[float, Counter]:
    """Return callbacks per second and the callback, for a stream of so many messages per second."""
    counter = Counter()
    with subscription(run, "tcp", per_second * MESSAGE_BYTES * 8) as stream:
        stream.on_publish(counter)
        time.sleep(0.1 if run.quick else 0.5)  # the ring's backlog from before is no sustained rate
        calls, start = counter.calls, time.perf_counter()
        time.sleep(0.3 if run.quick else 3.0)
        rate = (counter.calls - calls) / (time.perf_counter() - start)
    return rate, counter


def measure_callbacks(run: Run) -> Figure:
    """Measure how many Python callbacks a second a stream makes, one for each message.

    The source offers twice what is asked; what a link cannot call back for, it passes over. Offered a little
    more than what is asked, it must pass over nothing.
    """
    rate, flooded = count_callbacks(run, FLOOD_PER_SECOND)
    paced_rate, paced = count_callbacks(run, PACED_PER_SECOND)
    complaint = ""
    if paced.missing:
        complaint = f"of {PACED_PER_SECOND:,} a second, {paced.missing} in {paced.calls} were passed over"
    return Figure(
        "callbacks",
        f"Python callbacks, one a publish, {FLOOD_PER_SECOND:,}/s offered; TCP",
        500_000,
        False,
        rate,
        "/s",
        {
            "passed over": flooded.missing,
            f"{PACED_PER_SECOND:,}/s offered: callbacks/s": paced_rate,
            "of these passed over": paced.missing,
        },
        complaint,
    )
