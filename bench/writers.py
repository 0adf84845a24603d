# SPDX-License-Identifier: BSD-3-Clause
"""Set-points to many robots, all the time, from processes of their own.

    python bench/writers.py ROUTER TTL_S PERIOD_S HEARD_HZ FIRST KEY...

As a program, it opens all its robots at once, and says a line when each has published. Then it sends. For a
line with a moment, it tells when all its robots were heard again with what they sampled after it. When its
input ends, it tells all that it has sent and heard. All times are those of the monotonic clock.
"""

from __future__ import annotations

import contextlib
import json
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

from processes import Processes, first_line

from unitylink import connect
from unitylink.errors import LinkError
from unitylink.layer4_data.publication import base_hz
from unitylink.zenoh.link import ZenohLink

APART = 1_000_000  # between the set-points of two robots, so that each is known by its value
BACK_S = 120.0  # how long robots have to be heard again
EACH = 8  # robots of one process
Sent = dict[int, tuple[float, float]]  # of each value, moments before and after it was sent
Heard = list[tuple[float, float]]  # when a publish came, and when it was sampled


class Writer:
    """Sends set-points to one robot, and notes when each was sent, and what came from the robot."""

    def __init__(self, url: str, first: int, ttl_s: float, heard_hz: float) -> None:
        self.sent_s: Sent = {}
        self.heard: Heard = []
        self.newest_s = 0.0  # when the newest of what came was sampled
        self._next = first
        self.link = link = connect(url)
        assert isinstance(link, ZenohLink)
        self._goals = link.set_points("stamp", ttl_s=ttl_s)
        count = dict(link.spec.walk())["count"]
        published = link.subscribe(count.addresses, divisor=round(base_hz(link) / heard_hz))
        published.on_publish(self._hear)

    def send(self) -> None:
        """Send the next one. While the robot is away, there is nobody to whom it could go."""
        self._next += 1
        before_s = time.monotonic()
        with contextlib.suppress(LinkError):
            self._goals.send(self._next)
        self.sent_s[self._next] = before_s, time.monotonic()

    def _hear(self, time_s: float, words: object) -> None:
        self.heard.append((time.monotonic(), time_s))
        self.newest_s = time_s

    def fresh_s(self, since_s: float) -> float | None:
        """Return when the first publish came that was sampled after `since_s`."""
        return next((came_s for came_s, sampled_s in self.heard if sampled_s > since_s), None)


class Writers:
    """Processes that send set-points to robots through the router at `place`, until `end`.

    They have the robots by turns, up to EACH. When this returns, all robots have been heard.
    """

    def __init__(
        self,
        stack: ExitStack,
        keys: Sequence[str],
        place: str,
        ttl_s: float,
        *,
        period_s: float = 0.02,
        heard_hz: float = 100.0,
    ) -> None:
        programs = Processes(stack)
        self._all = [
            programs.begin(
                str(Path(__file__).resolve()),
                *map(str, (place, ttl_s, period_s, heard_hz, APART * (1 + start))),
                *keys[start : start + EACH],
                quiet=False,
            )
            for start in range(0, len(keys), EACH)
        ]
        for one in self._all:
            first_line(one)
        self.sent_s: Sent = {}
        self.heard: dict[str, Heard] = {}

    @property
    def pids(self) -> list[int]:
        return [one.pid for one in self._all]

    def fresh_after_s(self, since_s: float) -> float:
        """Wait until all robots were heard again. Return how long after `since_s` that was."""
        for one in self._all:
            assert one.stdin is not None
            print(since_s, file=one.stdin, flush=True)
        told = [json.loads(first_line(one)) for one in self._all]
        silent = [key for one in told for key in one["silent"]]
        if silent:
            raise SystemExit(f"not back within {BACK_S:.0f} s: {', '.join(silent)}")
        return max(float(one["came_s"]) for one in told) - since_s

    def end(self) -> None:
        """Stop them, and fill `sent_s` and `heard`."""
        for one in self._all:
            assert one.stdin is not None
            one.stdin.close()
        for one in self._all:
            told = json.loads(first_line(one))
            self.sent_s |= {int(value): (at_s[0], at_s[1]) for value, at_s in told["sent_s"].items()}
            self.heard |= told["heard"]
            one.wait()


def main() -> None:
    place, *numbers = sys.argv[1:6]
    ttl_s, period_s, heard_hz, first = map(float, numbers)
    keys = sys.argv[6:]

    def opened(place_of: tuple[int, str]) -> Writer:
        number, key = place_of
        return Writer(f"zenoh:{key}?connect={place}", int(first) + APART * number, ttl_s, heard_hz)

    with ThreadPoolExecutor(len(keys)) as pool:
        writers = dict(zip(keys, pool.map(opened, enumerate(keys)), strict=True))
    _wait(lambda: all(one.heard for one in writers.values()))
    print("there", flush=True)
    over = threading.Event()
    threading.Thread(target=_answer, args=(writers, over), daemon=True).start()
    next_s = time.monotonic()
    while not over.wait(max(0.0, next_s - time.monotonic())):
        next_s = max(next_s + period_s, time.monotonic())
        for one in writers.values():
            one.send()
    sent_s = {value: at_s for one in writers.values() for value, at_s in one.sent_s.items()}
    for one in writers.values():
        one.link.close()
    print(json.dumps({"sent_s": sent_s, "heard": {key: one.heard for key, one in writers.items()}}))


def _answer(writers: dict[str, Writer], over: threading.Event) -> None:
    for line in sys.stdin:
        since_s = float(line)
        _wait(lambda: all(one.newest_s > since_s for one in writers.values()))  # noqa: B023
        came = {key: one.fresh_s(since_s) for key, one in writers.items()}
        told = {
            "came_s": max((at_s for at_s in came.values() if at_s is not None), default=since_s),
            "silent": [key for key, at_s in came.items() if at_s is None],
        }
        print(json.dumps(told), flush=True)
    over.set()


def _wait(true: Callable[[], bool]) -> None:
    limit_s = time.monotonic() + BACK_S
    while not true() and time.monotonic() < limit_s:
        time.sleep(0.01)


if __name__ == "__main__":
    main()
