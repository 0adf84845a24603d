# SPDX-License-Identifier: BSD-3-Clause
"""The throughput of a line that loses frames, against ideal selective repeat on the same line.

It runs on a virtual clock (`native/src/faults/goodput.hpp`), so the same seed gives the same rate. The ideal
sender knows of a loss at the time when the answer would have come. It sends that frame next. It waits only
when its window is full. `python tools/docs/goodput.py` draws the curves of docs/faults.md.
"""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

from unitylink import protocol

from .figure import BenchError, Figure, Run

BYTE_NS = 833  # 12 MBd
DELAY_NS = 125_000  # each way: a USB microframe
LOSS = 0.01  # share of the frames that is lost, each way
ASKED = 0.97
SEEDS = 5
WINDOW = protocol.FRAME_WINDOW_DEFAULT


@dataclass(frozen=True)
class Traffic:
    """Messages of one kind: posts, writes or reads, of `message_words` words each."""

    name: str
    kind: str
    message_words: int
    window: int = WINDOW


REQUESTS = (
    Traffic("reads", "reads", 1),
    Traffic("writes", "writes", 1),
    Traffic("lists of 18 reads", "reads", 18),
    Traffic("lists of 18 writes", "writes", 18),
)
POSTS = Traffic("posts of 32 words", "posts", 32)


@dataclass(frozen=True)
class Point:
    """The throughput and the throughput of the ideal sender, in words a second."""

    words_per_s: float
    ideal_words_per_s: float

    @property
    def share(self) -> float:
        """The share of the ideal throughput that was reached."""
        return self.words_per_s / self.ideal_words_per_s


def goodput(traffic: Traffic, lose: float, *, words: int, seed: int = 1) -> Point:
    """Return the throughput if the share `lose` of the frames is lost, each way.

    Raises BenchError if a word was not written exactly once and in order, or was read wrongly.
    """
    from unitylink import _native

    def run(loss: float) -> dict[str, float]:
        report = _native.goodput(
            seed, traffic.kind, words, loss, traffic.message_words, traffic.window, BYTE_NS, DELAY_NS
        )
        if report["wrong"] or not report["words_per_s"]:
            raise BenchError(f"{traffic.name}: not each word was written once, in order, and read as it is")
        return report

    quiet = run(0.0)
    there, back = (
        quiet[way] * traffic.message_words * BYTE_NS * 1e-9
        for way in ("sent_bytes_per_word", "returned_bytes_per_word")
    )
    # From the end of a request to the end of its answer: the delay both ways, and the shorter transmission.
    trip_s = 2 * DELAY_NS * 1e-9 + min(there, back)
    messages = -(-words // traffic.message_words)
    window, ways = (messages, 1) if traffic.kind == "posts" else (traffic.window, 2)  # posts have no answer
    draw = random.Random(seed)
    ideal = _ideal_messages_per_s(
        (all(draw.random() >= lose for _ in range(ways)) for _ in itertools.count()),
        messages,
        window,
        max(there, back),
        trip_s,
    )
    return Point(run(lose)["words_per_s"], ideal * traffic.message_words)


def _ideal_messages_per_s(
    carried: Iterator[bool], messages: int, window: int, slot_s: float, trip_s: float
) -> float:
    """Simulate the ideal sender.

    `carried` tells of each transmission whether both it and its answer arrive.
    """
    now_s, base, following = 0.0, 0, 0
    # (time at which the answer comes or would come, number, whether it comes)
    answers: list[tuple[float, int, bool]] = []
    missing: list[int] = []
    answered: set[int] = set()
    while base < messages:
        while answers and answers[0][0] <= now_s:
            _, number, came = heapq.heappop(answers)
            if not came:
                heapq.heappush(missing, number)
                continue
            answered.add(number)
            while base in answered:
                answered.remove(base)
                base += 1
        if missing:
            number = heapq.heappop(missing)
        elif following < min(messages, base + window):
            number, following = following, following + 1
        else:
            now_s = answers[0][0] if answers else now_s
            continue
        now_s += slot_s
        heapq.heappush(answers, (now_s + trip_s, number, next(carried)))
    return messages / now_s


def measure(run: Run) -> Figure:
    """Measure acknowledged requests. The figure is that of the worst kind."""
    shares = {traffic.name: _share(run, traffic) for traffic in REQUESTS}
    return _figure("goodput", "acknowledged requests", min(shares.values()), shares)


def measure_posts(run: Run) -> Figure:
    """Measure posts. They are executed in order, so the posts behind a lost one are sent again."""
    return _figure("posts-loss", POSTS.name, _share(run, POSTS), {})


def _figure(name: str, what: str, share: float, more: dict[str, float]) -> Figure:
    told = f"{what} at 1 % of frames lost / ideal selective repeat, virtual 12 MBd"
    return Figure(name, told, ASKED, False, share, "x", more)


def _share(run: Run, traffic: Traffic) -> float:
    words = 5_000 if run.quick else 100_000
    seeds = range(1, 2 if run.quick else SEEDS + 1)
    return median(goodput(traffic, LOSS, words=words, seed=seed).share for seed in seeds)
