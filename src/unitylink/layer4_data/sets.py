# SPDX-License-Identifier: BSD-3-Clause
"""From publishes to sets: values that are sampled together, with the newest of those that come at other
times.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .publication import base_hz
from .published import PublishedValue
from .snapshot import Snapshot

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.spec.model import Publish


_STEP_PART = 0.75  # a sample that is older by more than this part of a period belongs to the tick before


class Sets:
    """Make one set of some READs for each beat. A beat is a tick of one of their rates, or an event.

    Values of the same rate belong to one beat, whatever gateware groups and links carry them. A set waits for
    all of them. The other values are the newest that have come. A value that has not come yet is not in the
    set.
    """

    def __init__(self, reads: Mapping[str, PublishedValue], labels: Mapping[Link, str]) -> None:
        self._lock = threading.Lock()
        self._begun = False
        self._reads, self._labels = reads, labels
        # value -> (time of its sample, its number)
        self._newest: dict[PublishedValue, tuple[float, Any]] = {}
        self._times_s: dict[str, float] = {}
        self._beats: dict[PublishedValue, Hashable] = {}
        self._sizes: dict[Hashable, int] = {}  # beat -> number of its values
        # beat -> those of its values that have come
        self._fresh: dict[Hashable, dict[PublishedValue, float]] = {}

    def expect(self, publishes: Mapping[PublishedValue, Publish]) -> None:
        """Tell how each READ is published."""
        with self._lock:
            beat_of = {value: _beat(value, publish) for value, publish in publishes.items()}
            if beat_of == self._beats:
                return
            self._beats = beat_of
            beats = list(self._beats.values())
            self._sizes = {beat: beats.count(beat) for beat in beats}
            self._fresh = {beat: {} for beat in self._sizes}

    def begin(self) -> None:
        """Make sets from now on. Values that are already known are in the first set."""
        self._begun = True

    @property
    def unknown(self) -> list[PublishedValue]:
        """The values that the first sets may lack. None if all values come with one beat of a rate."""
        if len(self._sizes) <= 1 and all(isinstance(beat, float) for beat in self._sizes):
            return []
        return [value for value in self._reads.values() if value not in self._newest]

    def seed(self, time_s: float, value: PublishedValue, number: Any) -> None:
        """Take values that were read, for those that have not been published yet."""
        with self._lock:
            if value not in self._newest:
                self._keep(time_s, value, number)

    def take(
        self, time_s: float, values: Sequence[PublishedValue], numbers: Sequence[Any]
    ) -> Snapshot | None:
        """Take a publish that carries some of our values. Return the set that it completes, or None."""
        with self._lock:
            beat: Hashable = None
            for value, number in zip(values, numbers, strict=True):
                if value in self._beats:
                    beat = self._beats[value]
                    self._keep(time_s, value, number)
                    self._fresh[beat][value] = time_s
            if (
                beat is None
                or not self._begun
                or len(self._fresh[beat]) < self._sizes[beat]
                or self._drop_stale(beat)
            ):
                return None
            self._fresh[beat].clear()
            return self._set()

    def current(self) -> Snapshot | None:
        """Return the set as it is now. Return None if nothing is known."""
        with self._lock:
            return self._set() if self._newest else None

    def _keep(self, time_s: float, value: PublishedValue, number: Any) -> None:
        self._newest[value] = time_s, number
        label = self._labels[value.hardware.link]
        self._times_s[label] = max(time_s, self._times_s.get(label, time_s))

    def _set(self) -> Snapshot:
        known = [(key, self._newest[v]) for key, v in self._reads.items() if v in self._newest]
        return Snapshot(
            {key: number for key, (_, number) in known},
            self._times_s,
            {key: time_s for key, (time_s, _) in known},
        )

    def _drop_stale(self, beat: Hashable) -> bool:
        """Forget samples of the tick before. Return True if there were any.

        They exist if a publish of another gateware group was lost. Now the groups are in step again.
        """
        fresh = self._fresh[beat]
        if len(set(fresh.values())) == 1:
            return False
        newest_s = max(fresh.values())
        stale = [value for value, time_s in fresh.items() if newest_s - time_s > _patience_s(value)]
        for value in stale:
            del fresh[value]
        return bool(stale)


def _beat(value: PublishedValue, publish: Publish) -> Hashable:
    """Return the beat of a value: its period in s, or its event."""
    link = value.hardware.link
    if publish.trigger == "rate":
        return round(publish.divisor / base_hz(link), 9)
    return link, publish.trigger, publish.event, publish.group


def _patience_s(value: PublishedValue) -> float:
    """Return how much older than the newest one a sample of a set may be.

    This needs a device that tells its time.
    """
    link = value.hardware.link
    if value.publish is None or not value.publish.divisor or link.protocol != "framed":
        return math.inf
    return _STEP_PART * value.publish.divisor / base_hz(link)
