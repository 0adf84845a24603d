# SPDX-License-Identifier: BSD-3-Clause
"""The values of a robot as they come: published by the gateware, or read by the PC."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from unitylink.errors import LinkError
from unitylink.layer4_data import Publisher, Value
from unitylink.layer4_data.everything import publish_all
from unitylink.layer4_data.publication import PublishReport
from unitylink.values import format_value

from .description import as_text
from .history import History

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from unitylink.layer2_message import Link
    from unitylink.layer2_message.native_link import Times, Words
    from unitylink.layer4_data.published import PublishedValue

    Rows = Union[Sequence[Sequence[int]], Words]

GATHER_S = 0.02  # s; publishes are handed over so much later, many at once
READ_HZ = 5.0


@dataclass(frozen=True)
class Portion:
    """Samples of one publish that came together.

    `times_s` has the shape (n,). `raws` and `numbers` have a column of the shape (n,) for each of `values`.
    """

    values: tuple[PublishedValue, ...]
    times_s: NDArray[np.float64]
    raws: list[NDArray[np.uint64]]
    numbers: list[NDArray[np.float64]]


@dataclass
class Track:
    """What is known of one item: its samples, and in which round the last of them came."""

    value: Value[Any]
    history: History = field(default_factory=History)
    round: int = 0
    raw: int | None = None  # the last sample as it came
    text: str = ""
    rate_hz: float = 0.0  # how often it should come, 0 if on an event


class Feed:
    """Publish all items of a robot while the `with` block runs, and keep their samples.

    The gateware sends items with PUBLISH. The PC reads the others at `read_hz`, and also set-points that the
    device lets it read. An item that a read would change is only heard. `tracks` has one entry for each of
    `values`, in their order. The samples come in by `gather`, which also hands them to `takers`. A taker must
    not wait.
    """

    def __init__(self, link: Link, values: Iterable[Value[Any]], read_hz: float = READ_HZ) -> None:
        self.round = 0
        self.tracks = [Track(value) for value in values]
        self.takers: list[Callable[[Portion], object]] = []
        self.link = link
        self._lock = threading.Lock()
        self._arrived: dict[tuple[PublishedValue, ...], list[tuple[Sequence[float] | Times, Rows]]] = {}
        self._publisher = Publisher(gather_s=GATHER_S)
        self.by_path = {track.value.path: track for track in self.tracks}
        publish_all(self._publisher, link, (track.value for track in self.tracks), read_hz)
        self._publisher.take_with(self._take, self._take_arrays)

    def __enter__(self) -> Feed:
        self._publisher.start(fallback=True)
        for report in self._publisher.reports():
            for path in report.paths:
                self.by_path[path].rate_hz = report.rate_hz
        return self

    def __exit__(self, *_: object) -> None:
        self._publisher.stop()

    def _take(
        self, time_s: float, values: Sequence[PublishedValue], _: Sequence[Any], raws: Sequence[int]
    ) -> None:
        with self._lock:
            self._arrived.setdefault(tuple(values), []).append(([time_s], [raws]))

    def _take_arrays(self, times: Times, values: Sequence[PublishedValue], raws: Words) -> None:
        with self._lock:
            self._arrived.setdefault(tuple(values), []).append((times, raws))

    def latest(self, path: str) -> Any:
        """Return the newest value of an item, or None."""
        return self.by_path[path].value.latest if path in self.by_path else None

    def gather(self) -> int:
        """Put what has arrived since the last call into the histories. Return the number of this round."""
        with self._lock:
            arrived, self._arrived = self._arrived, {}
        self.round += 1
        for values, parts in arrived.items():
            times_s = np.concatenate([np.asarray(times, np.float64) for times, _ in parts])
            portion = Portion(values, times_s, [], [])
            for column, value in enumerate(values):
                raws = np.concatenate([_column(rows, column) for _, rows in parts])
                numbers = value.codec.decode_array(raws).astype(np.float64)
                portion.raws.append(raws)
                portion.numbers.append(numbers)
                track = self.by_path[value.path]
                track.history.add(times_s, numbers)
                track.round, track.raw = self.round, int(raws[-1])
                if as_text(track.value):
                    track.text = format_value(value.codec.decode(track.raw))
            for take in list(self.takers):
                take(portion)
        return self.round

    def round_trip_s(self) -> float | None:
        """Return how long a read takes now, in s, or None if it fails or there is nothing to read."""
        value = next((track.value for track in self.tracks if track.value.pollable), None)
        if value is None or not self.link.up:
            return None
        begun_s = time.monotonic()
        try:
            self.link.read(value.address)
        except LinkError:
            return None
        return time.monotonic() - begun_s

    def publications(self) -> list[PublishReport]:
        """Return for each publish what was asked for, what came, and what was lost."""
        return self._publisher.reports()

    def reports(self) -> list[dict[str, Any]]:
        """Return the same for JSON."""
        return [
            {
                "paths": report.paths,
                "hardware": report.hardware,
                "rate_hz": report.rate_hz,
                "received": report.received,
                "lost": report.lost,
            }
            for report in self.publications()
        ]


def _column(rows: Rows, column: int) -> NDArray[np.uint64]:
    if isinstance(rows, np.ndarray):
        return rows[:, column].astype(np.uint64)
    return np.array([row[column] for row in rows], np.uint64)
