# SPDX-License-Identifier: BSD-3-Clause
"""The samples of a robot behind a server, read once and handed to all streams."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from unitylink.connection import connect
from unitylink.errors import UnityLinkError
from unitylink.layer4_data import Publisher, Value, load_spec_objects
from unitylink.layer4_data.everything import publish_all
from unitylink.layer4_data.topics import topics_of

from .topic import Batch, Batches, Topic

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer2_message.native_link import Times, Words
    from unitylink.layer4_data.published import PublishedValue
    from unitylink.spec.model import Spec

    from .topic import Rows

ROUND_S = 0.02  # samples are handed over so often
READ_HZ = 5.0  # how often items without PUBLISH are read
_PAUSE_S = 1.0  # between two attempts to reach the board
_MOST_WAITING = 100_000  # samples of a topic; this process was stopped, and the older ones are left out


class Stream(Protocol):
    """Takes the samples. No call may wait for a reader. All come from one thread."""

    def begin(self, topics: Sequence[Topic], values: Mapping[str, Value[Any]]) -> None:
        """The board is there, and these topics follow. They replace others. `values` has all by path."""
        ...

    def take(self, batches: Batches) -> None:
        """Samples have come since the last call. It is also called if there are none."""
        ...

    def away(self, why: str) -> None:
        """The board is away. `begin` follows when it is back."""
        ...


class Source:
    """Reads a robot by `url`, which is one of its server, while the `with` block runs.

    So the line carries each publish once, and the loops of programs wait for no stream. It comes back when
    the board does.
    """

    def __init__(self, url: str, spec: Spec, streams: Sequence[Stream]) -> None:
        self._url, self._spec, self._streams = url, spec, tuple(streams)
        self._lock = threading.Lock()
        self._arrived: dict[tuple[PublishedValue, ...], list[tuple[Sequence[float] | Times, Rows]]] = {}
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink streams", daemon=True)

    def __enter__(self) -> Source:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closed.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._closed.is_set():
            try:
                with connect(self._url, reconnect=True) as link:
                    self._read(link)
                why = "its link has ended"
            except UnityLinkError as error:
                why = str(error)
            for stream in self._streams:
                stream.away(why)
            self._closed.wait(_PAUSE_S)

    def _read(self, link: Link) -> None:
        values = {value.path: value for value in load_spec_objects(self._spec, link)}
        publisher = Publisher(gather_s=ROUND_S)
        publish_all(publisher, link, values.values(), READ_HZ)
        publisher.take_with(self._take, self._take_arrays)
        with self._lock:
            self._arrived.clear()
        with publisher.running(fallback=True):
            since_1970_s = time.time() - link.now_s()
            publishes = {path: element.publish for path, element in self._spec.walk()}
            reports = publisher.reports()
            names = topics_of(self._spec.name, publishes, reports)
            topics: dict[tuple[str, ...], Topic] = {}
            for report in reports:
                name = _unlike(names[report.paths], {topic.name for topic in topics.values()})
                topics[report.paths] = Topic(name, [values[path] for path in report.paths], report.rate_hz)
            up = False
            while not self._closed.wait(ROUND_S) and not link.closed:
                if link.up != up:
                    up = link.up
                    for stream in self._streams:
                        stream.begin(list(topics.values()), values) if up else stream.away(link.trouble)
                batches = self._gathered(topics, since_1970_s) if up else {}
                for stream in self._streams:
                    stream.take(batches)

    def _take(
        self, time_s: float, values: Sequence[PublishedValue], _: Sequence[Any], raws: Sequence[int]
    ) -> None:
        with self._lock:
            self._arrived.setdefault(tuple(values), []).append(([time_s], [raws]))

    def _take_arrays(self, times: Times, values: Sequence[PublishedValue], raws: Words) -> None:
        with self._lock:
            self._arrived.setdefault(tuple(values), []).append((times, raws))

    def _gathered(self, topics: dict[tuple[str, ...], Topic], since_1970_s: float) -> Batches:
        with self._lock:
            arrived, self._arrived = self._arrived, {}
        batches = {}
        for values, parts in arrived.items():
            times_s = np.concatenate([np.asarray(times, np.float64) for times, _ in parts]) + since_1970_s
            rows = [row for _, some in parts for row in some]
            topic = topics[tuple(value.path for value in values)]
            batches[topic] = Batch(times_s[-_MOST_WAITING:], rows[-_MOST_WAITING:])
        return batches


def _unlike(name: str, taken: set[str]) -> str:
    """Return the name, with a number if others have it. Recordings number them in the same way."""
    count, numbered = 1, name
    while numbered in taken:
        count += 1
        numbered = f"{name}_{count}"
    return numbered
