# SPDX-License-Identifier: BSD-3-Clause
"""The live chart of a notebook: from publishes in the link's thread to messages for the browser."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anywidget
import numpy as np
import traitlets

from unitylink.errors import ValueRangeError, shown
from unitylink.layer4_data import Node, ReadValue, Value, ValueGroup

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

MOST = 16  # values of one chart
PERIOD_S = 0.1  # between two messages
POINTS = 100  # of one value in one message; of more samples, the least and the greatest are sent
WAITING = 100_000  # samples of one value that may wait for the next message


class Chart(anywidget.AnyWidget):
    """A chart of values as they come. `unitylink.jupyter.live` makes it. `close()` ends it."""

    _esm = (Path(__file__).parent / "chart.js").read_text(encoding="utf-8")
    series: traitlets.List[Any] = traitlets.List().tag(sync=True)
    window_s = traitlets.Float().tag(sync=True)
    ended = traitlets.Unicode().tag(sync=True)

    def __init__(self, values: Iterable[Any], window_s: float, rate_hz: float) -> None:
        self._stopped = threading.Event()  # close() needs these two, also if this ends by an error
        self._take_back: list[Callable[[], None]] = []
        if not (isinstance(window_s, (int, float)) and 0.1 <= window_s <= 3600):
            raise ValueRangeError(f"a chart of window_s {shown(window_s)}; expected 0.1 to 3600 s")
        drawn = list(dict.fromkeys(_drawable(values)))
        if not 1 <= len(drawn) <= MOST:
            raise ValueRangeError(f"a chart draws 1 to {MOST} values, not {len(drawn)}")
        super().__init__(series=[_facts(value) for value in drawn], window_s=float(window_s))
        self._links = {value.hardware.link for value in drawn}
        self._waiting: list[list[tuple[float, float]]] = [[] for _ in drawn]
        self._lock = threading.Lock()
        try:
            for number, value in enumerate(drawn):
                rate = None if value.publish is not None else rate_hz
                self._take_back.append(value.on_publish(self._taker(number), rate_hz=rate))
        except BaseException:
            self.close()
            raise
        threading.Thread(target=self._send_samples, name="unitylink-live", daemon=True).start()

    def close(self) -> None:
        """End the chart. The publishes go on, because others may use them."""
        self._stopped.set()
        for take_back in self._take_back:
            take_back()
        self._take_back = []
        super().close()

    def _taker(self, number: int) -> Callable[[float, Any], None]:
        def take(time_s: float, value: Any) -> None:
            with self._lock:
                if len(self._waiting[number]) < WAITING:
                    self._waiting[number].append((time_s, float(value)))

        return take

    def _send_samples(self) -> None:
        while not self._stopped.wait(PERIOD_S):
            if all(link.closed for link in self._links):
                self.ended = "the link has ended"
                return
            if (message := self._message()) is not None:
                self.send({"kind": "samples"}, buffers=[message])

    def _message(self) -> bytes | None:
        """Return what has come since the last call, as float64, or None. See `take` of chart.js."""
        with self._lock:
            came, self._waiting = self._waiting, [[] for _ in self._waiting]
        parts = []
        for number, samples in enumerate(came):
            if samples:
                points = thinned(np.array(samples, np.float64).T)
                parts += [np.array([number, points.shape[1]], np.float64), points.reshape(-1)]
        return np.concatenate(parts).astype("<f8").tobytes() if parts else None


def thinned(samples: Floats) -> Floats:
    """Return at most POINTS of the samples, both of shape (2, n): times and values. No peak is lost.

    >>> thinned(np.array([[0.0, 1.0], [5.0, 7.0]]))
    array([[0., 1.],
           [5., 7.]])
    """
    count = samples.shape[1]
    if count <= POINTS:
        return samples
    edges = np.linspace(0, count, POINTS // 2 + 1).astype(int)
    chosen = set()
    for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        part = samples[1, begin:end]
        chosen |= {begin + int(np.argmin(part)), begin + int(np.argmax(part))}
    return samples[:, sorted(chosen)]


def _drawable(values: Iterable[Any]) -> Iterator[ReadValue[Any]]:
    """Yield the values to draw. What is named itself has to be a number. Of a part, others are left out."""
    for value in values:
        if isinstance(value, Value):
            if not isinstance(value, ReadValue) or not _is_number(value):
                raise ValueRangeError(f"{value.path} is no number that can be read, so it cannot be drawn")
            yield value
        elif isinstance(value, (Node, ValueGroup, tuple, list)):
            members = value.values.values() if isinstance(value, ValueGroup) else value
            for member in members:
                if not isinstance(member, Value) or (isinstance(member, ReadValue) and _is_number(member)):
                    yield from _drawable([member])
        else:
            raise ValueRangeError(f"{shown(value)} is no value of a robot")


def _is_number(value: ReadValue[Any]) -> bool:
    return value.quantity.type.kind != "bits" and value.pollable


def _facts(value: Value[Any]) -> dict[str, Any]:
    enum = value.quantity.type.enum
    members = {str(one.value): one.name for one in enum.values} if enum is not None else {}
    return {"name": value.path, "unit": value.unit, "members": members}
