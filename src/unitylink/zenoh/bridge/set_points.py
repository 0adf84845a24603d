# SPDX-License-Identifier: BSD-3-Clause
"""Set-points from the network: the newest of each key is written, unless its time is over."""

from __future__ import annotations

import threading
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from unitylink.errors import LinkTimeout, ProtocolError, UnityLinkError

from ..messages import SetPoint, decode_set_point
from .freshest import Freshest
from .queries import BYTES_MAX, reason_of

if TYPE_CHECKING:
    import zenoh

    from ..schema import Layout
    from .executor import Executor
    from .refusals import Refusals
    from .visits import Visits


class SetPoints:
    """Takes what is put below `key`, and writes it by a thread of its own.

    So a board that is slow holds up no network thread, and gets the newest set-point when it is ready.
    """

    def __init__(
        self,
        session: zenoh.Session,
        key: str,
        layouts: dict[str, tuple[str, Layout]],
        executor: Executor,
        *,
        visits: Visits,
        lock: threading.Lock,
        refusals: Refusals,
    ) -> None:
        """`layouts` has the part and the layout of each key below."""
        self._layouts, self._executor, self._visits = layouts, executor, visits
        self._visits_lock, self._refusals = lock, refusals
        self._freshest = Freshest()
        self._lock = threading.Condition()
        self._closed = False
        self.written = 0
        self._thread = threading.Thread(target=self._work, name=f"zenoh {key}", daemon=True)
        self._thread.start()
        self._subscriber = session.declare_subscriber(f"{key}/**", self._take)

    def close(self) -> None:
        """Take no more, and write nothing more."""
        self._subscriber.undeclare()
        with self._lock:
            self._closed = True
            self._lock.notify()
        self._thread.join()

    def forget(self, visit: int) -> None:
        """A client is gone. What it has sent is not written any more."""
        with self._lock:
            self._freshest.forget(visit)

    def report(self) -> dict[str, int]:
        """Return how many were written, replaced by newer ones, and too late when their turn came."""
        with self._lock:
            return {"written": self.written, "replaced": self._freshest.replaced, "late": self._freshest.late}

    def _take(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if "*" in key:
            return self._refusals.add("wildcard", f"{key}: a set-point for one key is expected")
        if key not in self._layouts:
            return self._refusals.add("unknown", f"{key}: there is no set-point of this name")
        try:
            data = sample.payload.to_bytes()
            if len(data) > BYTES_MAX:
                raise ProtocolError(f"a set-point of {len(data)} bytes")
            point = decode_set_point(key, data)
            point = replace(point, values=self._layouts[key][1].unpack(point.body))
        except UnityLinkError as error:
            return self._refusals.add(reason_of(error), f"{key}: {error}")
        with self._visits_lock:
            known = self._visits.get(point.visit) is not None
        if not known:
            return self._refusals.add("unknown", f"{key}: a client that has not said hello to this bridge")
        with self._lock:
            why = self._freshest.offer(point, time.monotonic_ns())
            if not why:
                self._lock.notify()
        if why:
            self._refusals.add(why, f"{key}: set-point {point.sequence}")
        return None

    def _work(self) -> None:
        while True:
            with self._lock:
                points = self._freshest.take(time.monotonic_ns())
                if self._closed:
                    return
                if not points:
                    self._lock.wait()
                    continue
            for point in points:
                self._write(point)

    def _write(self, point: SetPoint) -> None:
        part, _ = self._layouts[point.key]
        with self._visits_lock:
            visit = self._visits.get(point.visit)
        if visit is None:
            return
        try:
            self._executor.set_point(visit.client, point.values, part, point.deadline_ns)
            self.written += 1
        except LinkTimeout as error:
            self._refusals.add("late", f"{point.key}: {error}")
        except UnityLinkError as error:
            self._refusals.add(reason_of(error), f"{point.key}: {error}")
