# SPDX-License-Identifier: BSD-3-Clause
"""A recording on the side of the server: what comes goes into a file, whoever looks."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.errors import UnityLinkError
from unitylink.layer4_data.topics import topics_of
from unitylink.recording import Origin, Sample, create
from unitylink.recording.reorder_buffer import ReorderBuffer
from unitylink.values import plain

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from unitylink.spec.model import Instance

    from .feed import Feed, Portion
    from .shelf import Shelf

WRITE_S = 0.25  # between two looks at what has come; a killed program loses so much, and HOLD_S
HOLD_S = 1.0  # samples are held back for so long, so that the file has them in the order of their times
WAITING = 200_000  # samples that may wait; more are lost, and counted
LOOK_S = 2.0  # between two looks whether there is still room


class Recorder:
    """Writes all that the feed brings into a new file of the shelf, from now on until `end`.

    The feed's thread only puts samples into a queue. A thread of the recorder writes them. It ends by itself
    if there is no more room. `ended` then says why.
    """

    def __init__(
        self,
        shelf: Shelf,
        feed: Feed,
        root: Instance,
        origin: Origin,
        *,
        ending: str,
        by: str,
        done: Callable[[Recorder], object] = lambda _: None,
    ) -> None:
        """`by` is the name of who began it. `done` is called when it has ended by itself.

        Raises UnityLinkError if there is no room, or the format's library is absent.
        """
        self.path: Path = shelf.new(root.name, ending)
        self.by = by
        self.begun_s = time.time()
        self.lost = 0
        self.ended = ""
        self._shelf, self._feed, self._done = shelf, feed, done
        self._since_1970_s = time.time() - feed.link.now_s()
        self._arrived: deque[Portion] = deque()
        self._waiting = 0
        self._held = ReorderBuffer[Sample](HOLD_S)
        reports = feed.publications()
        publishes = {element.path: element.publish for element in root.walk()}
        topics = topics_of(root.name, publishes, reports)
        names = tuple(path for report in reports for path in report.paths)
        self._writer = create(self.path, origin, names, topics=topics)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink-recorder", daemon=True)
        self._thread.start()
        feed.takers.append(self._take)

    def told(self) -> dict[str, Any]:
        """Return its state for JSON."""
        return {
            "name": self.path.name,
            "by": self.by,
            "samples": self._writer.count,
            "size_bytes": self._writer.size_bytes,
            "lost": self.lost,
            "seconds": round(time.time() - self.begun_s, 1),
        }

    def end(self, reason: str = "") -> None:
        """Write what has come, and close the file. It may be called again."""
        if self._take in self._feed.takers:
            self._feed.takers.remove(self._take)
        self._stop.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _take(self, portion: Portion) -> None:
        if self._waiting + len(portion.times_s) > WAITING:
            self.lost += len(portion.times_s)
            return
        self._waiting += len(portion.times_s)
        self._arrived.append(portion)

    def _run(self) -> None:
        looked_s = time.monotonic()
        try:
            with self._writer:
                while not self._stop.wait(WRITE_S) and not self.ended:
                    self._write(self._feed.link.now_s())
                    self._writer.flush()
                    if time.monotonic() - looked_s >= LOOK_S:
                        looked_s = time.monotonic()
                        self.ended = self._shelf.full()
                self._write(math.inf)
        except UnityLinkError as error:
            self.ended = str(error)
        except OSError as error:
            self.ended = f"{self.path.name}: {error.strerror or error}"
        if self.ended:
            self.end()
            self._done(self)

    def _write(self, now_s: float) -> None:
        while self._arrived:
            portion = self._arrived.popleft()
            self._waiting -= len(portion.times_s)
            paths = [value.path for value in portion.values]
            columns = [_plain(value, raws) for value, raws in zip(portion.values, portion.raws, strict=True)]
            for time_s, *row in zip(portion.times_s.tolist(), *columns, strict=True):
                sample = Sample(self._since_1970_s + time_s, dict(zip(paths, row, strict=True)))
                self.lost += not self._held.put(time_s, sample)
        while (next_one := self._held.take(now_s)) is not None:
            self._writer.add(next_one)


def _plain(value: Any, raws: NDArray[np.uint64]) -> Sequence[Any]:
    """Return a column of samples as `unitylink record` writes it: members by name, packed ones as objects."""
    quantity = value.quantity
    if quantity.type.kind in ("enum", "bits"):
        known = {raw: plain(value.codec.decode(raw), quantity) for raw in set(raws.tolist())}
        return [known[raw] for raw in raws.tolist()]
    numbers = value.codec.decode_array(raws).tolist()
    if quantity.type.kind == "float":
        return [plain(number, quantity) if math.isfinite(number) else number for number in numbers]
    return list(numbers)
