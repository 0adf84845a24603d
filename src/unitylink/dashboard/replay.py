# SPDX-License-Identifier: BSD-3-Clause
"""A recording that is shown again: its samples as histories, so that charts draw them like live ones."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from unitylink.errors import UnityLinkError
from unitylink.recording import RecordingTruncated, Sample, samples

from .history import History

if TYPE_CHECKING:
    from unitylink.layer4_data import Value

MOST_BYTES = 300_000_000  # of a file; more would take minutes to read
KEPT = 2  # replays that are kept in memory
_PORTION = 4096  # samples of an item that go into its history together


class Replay:
    """What a recording has of the items of this robot. Its times begin at 0 with the first sample.

    `begun_s` is the time of that sample, in s since 1970. `notice` says what is wrong with the file, or "".
    `histories` has one entry for each of `values`, in their order; those without samples are empty.
    """

    def __init__(self, path: Path, values: Sequence[Value[Any]]) -> None:
        """Read the whole file. Raises UnityLinkError if it is no recording, or is of another robot."""
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise UnityLinkError(
                f"{path.name} has {size / 1e6:,.0f} MB, more than the {MOST_BYTES / 1e6:,.0f} MB that a page "
                "replays; download it, and use `unitylink plot` or `unitylink replay`"
            )
        self.name = path.name
        self.histories = [History() for _ in values]
        self.begun_s = self.duration_s = 0.0
        self.notice = ""
        self._columns = {
            value.path: _Column(value, history) for value, history in zip(values, self.histories, strict=True)
        }
        first = True
        try:
            for sample in samples(path):
                if first:
                    self.begun_s, first = sample.time_s, False
                self._take(sample)
        except RecordingTruncated as error:
            self.notice = str(error)
        for column in self._columns.values():
            column.flush()
        self.items = [number for number, history in enumerate(self.histories) if history.count]
        if not self.items:
            raise UnityLinkError(f"{path.name}: has no sample of an item of this robot")

    def _take(self, sample: Sample) -> None:
        time_s = max(0.0, sample.time_s - self.begun_s)
        self.duration_s = max(self.duration_s, time_s)
        for name, value in sample.values.items():
            column = self._columns.get(name)
            if column is not None:
                column.take(time_s, value)

    def told(self) -> dict[str, Any]:
        """Return what a page has to know of it, for JSON."""
        return {
            "name": self.name,
            "begun_s": self.begun_s,
            "duration_s": self.duration_s,
            "items": self.items,
            "notice": self.notice,
        }


class _Column:
    """The samples of one item on their way into its history."""

    def __init__(self, value: Value[Any], history: History) -> None:
        enum = value.quantity.type.enum
        self._members = {one.name: float(one.value) for one in enum.values} if enum is not None else {}
        self._history = history
        self._times: list[float] = []
        self._numbers: list[float] = []

    def take(self, time_s: float, value: Any) -> None:
        if isinstance(value, str):
            value = self._members.get(value, math.nan)
        if isinstance(value, (int, float)):  # packed values are not drawn
            self._times.append(time_s)
            self._numbers.append(float(value))
            if len(self._times) >= _PORTION:
                self.flush()

    def flush(self) -> None:
        if self._times:
            self._history.add(np.array(self._times), np.array(self._numbers))
            self._times, self._numbers = [], []


class Replays:
    """The replays of a robot, the last ones of which stay in memory. Any thread may ask."""

    def __init__(self, values: Sequence[Value[Any]]) -> None:
        self._values = values
        self._lock = threading.Lock()  # held while a file is read, so that one is read at a time
        self._kept: dict[tuple[str, int, int], Replay] = {}

    def load(self, path: Path) -> Replay:
        """Return the replay of a file, and read it if that has not been done. Raises what Replay raises."""
        try:
            found = path.stat()
        except OSError as error:
            raise UnityLinkError(f"{path.name}: {error.strerror or error}") from error
        key = path.name, found.st_mtime_ns, found.st_size
        with self._lock:
            replay = self._kept.pop(key, None) or Replay(path, self._values)
            self._kept[key] = replay
            while len(self._kept) > KEPT:
                self._kept.pop(next(iter(self._kept)))
            return replay
