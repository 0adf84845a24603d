# SPDX-License-Identifier: BSD-3-Clause
"""Publishes: the cost of decoding, checking and draining a stream, and the rate of callbacks.

The source is another process. It numbers every message, so a lost or doubled one is noticed.
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
from .programs import Process, frame_bytes, native

if TYPE_CHECKING:
    import numpy.typing as npt

    from unitylink.layer2_message import Subscription

MESSAGE_BYTES = 21  # the bytes of &PUB:ggnnxxxxxxxx*hh and the line feed
PUBLISH_HEAD_BYTES = 7  # group, sequence, clock
SELDOM = 1 << 30  # divisor of the twin's own publishes, so large that it sends none
DRAIN_S = 0.02
RING = 1 << 16
FLOOD_PER_SECOND = 1_000_000
PACED_PER_SECOND = 525_000
PTY_BAUD = 100_000_000  # nominal rate of a pty that is fast enough for the stream


@dataclass(frozen=True)
class Source:
    """A stream: its rate, and the words of a message. A classic stream has lines of one word."""

    bits_per_second: int
    words: int = 1
    framed: bool = False

    @property
    def message_bytes(self) -> int:
        """Bytes of one message."""
        return frame_bytes(PUBLISH_HEAD_BYTES + 4 * self.words) if self.framed else MESSAGE_BYTES


CLASSIC = Source(64_000_000)
FRAMED = Source(320_000_000, words=16, framed=True)


@dataclass(frozen=True)
class Stream:
    """The measurements of a stream, window by window."""

    cpu_percent: float  # share of one core, user and system, over all threads; median of the windows
    mbit_per_second: float  # counts the messages that arrived
    messages: int
    missing: int


@contextmanager
def subscription(run: Run, endpoint: str, stream_of: Source) -> Iterator[Subscription]:
    """Start a source and subscribe to it."""
    from unitylink import connect

    options = ["--endpoint", endpoint, "--bits-per-second", str(stream_of.bits_per_second)]
    options += ["--words", str(stream_of.words)] if stream_of.framed else []
    addresses = list(range(ADDRESS, ADDRESS + stream_of.words))
    with Process([native(run.checkout, "bench_publish_source"), *options]) as source:
        place = source.line()
        url = f"tcp://{place}?" if endpoint == "tcp" else f"serial:{place}?baud={PTY_BAUD}&"
        with (
            connect(f"{url}protocol={'framed' if stream_of.framed else 'classic'}") as link,
            link.subscribe(addresses, divisor=SELDOM if stream_of.framed else 1, ring=RING) as stream,
        ):
            if not stream.wait(5.0):
                raise BenchError(f"the publish source on {endpoint} published nothing for 5 s")
            yield stream


def watch(run: Run, endpoint: str, source: Source) -> Stream:
    """Drain a stream of a fixed rate for some seconds, and account for every message and word."""
    windows = run.rounds(5)
    window_s = 1.0 if not run.quick else 0.2
    drained: list[npt.NDArray[np.uint32]] = []
    shares: list[float] = []
    rates: list[float] = []
    with subscription(run, endpoint, source) as stream:
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
            rates.append(count * source.message_bytes * 8 / wall / 1e6)
    words = np.concatenate(drained)
    if (words != words[:, :1] + np.arange(source.words, dtype=np.uint32)).any():
        raise BenchError(f"words of the stream on {endpoint} are not what was sent")
    numbers = words[:, 0].astype(np.int64)
    missing = int(np.sum(np.abs(np.diff(numbers) - 1)))
    return Stream(median(shares), median(rates), len(numbers), missing)


def measure_stream(run: Run) -> Figure:
    """Measure the processor time of a 64 Mbit/s stream, over TCP and over a pty."""
    tcp = watch(run, "tcp", CLASSIC)
    pty = watch(run, "pty", CLASSIC)
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
        _complaint(tcp, CLASSIC),
    )


def _complaint(stream: Stream, source: Source) -> str:
    if stream.missing:
        return f"{stream.missing} of {stream.messages} messages did not arrive"
    if stream.mbit_per_second < 0.98 * source.bits_per_second / 1e6:
        return f"only {stream.mbit_per_second:.1f} Mbit/s arrived"
    return ""


def measure_frames(run: Run) -> Figure:
    """Measure the processor time of a 320 Mbit/s stream of 16-word frames over TCP."""
    tcp = watch(run, "tcp", FRAMED)
    return Figure(
        "publish-framed",
        f"320 Mbit/s of {FRAMED.words}-word frames decoded, checked, drained; TCP",
        25,
        True,
        tcp.cpu_percent,
        "% of a core",
        {"Mbit/s": tcp.mbit_per_second, "messages": tcp.messages, "missing": tcp.missing},
        _complaint(tcp, FRAMED),
    )


class Counter:
    """A callback that counts its calls and notices gaps."""

    def __init__(self) -> None:
        self.calls = 0
        self.missing = 0
        self.next = -1

    def __call__(self, time_s: float, values: tuple[int, ...]) -> None:
        """Count one publish."""
        number = values[0]
        if number != self.next and self.next >= 0:
            self.missing += abs(number - self.next)
        self.next = number + 1
        self.calls += 1


def count_callbacks(run: Run, per_second: int) -> tuple[float, Counter]:
    """Return the callbacks per second and the callback, for a stream of `per_second` messages a second."""
    counter = Counter()
    with subscription(run, "tcp", Source(per_second * MESSAGE_BYTES * 8)) as stream:
        stream.on_publish(counter)
        # let the backlog in the ring drain first, because it would count as a higher rate
        time.sleep(0.1 if run.quick else 0.5)
        calls, start = counter.calls, time.perf_counter()
        time.sleep(0.3 if run.quick else 3.0)
        rate = (counter.calls - calls) / (time.perf_counter() - start)
    return rate, counter


def measure_callbacks(run: Run) -> Figure:
    """Measure how many Python callbacks a second a stream makes. Each message makes one.

    The source offers twice the required rate. The link skips messages for which it has no time to call back.
    At a little more than the required rate, it must skip none.
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
