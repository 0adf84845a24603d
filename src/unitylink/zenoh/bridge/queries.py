# SPDX-License-Identifier: BSD-3-Clause
"""Answers queries by a few threads, so that a slow answer does not hold up all others."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from unitylink.errors import LinkError, UnityLinkError

from ..failures import encode_failure
from .refusals import Refusals

if TYPE_CHECKING:
    import zenoh

WAITING_MAX = 256
BYTES_MAX = 65536  # of a payload
KEPT = object()
Answer = Callable[["zenoh.Query"], object]
_log = logging.getLogger("unitylink.zenoh")


class Refused(LinkError):
    """A query that is refused, with the reason under which it is counted."""

    def __init__(self, reason: str, error: UnityLinkError) -> None:
        super().__init__(str(error))
        self.reason, self.error = reason, error


class Queries:
    """Calls the answer of a key for each query there. An error that it raises is the answer.

    If it returns KEPT, it answers later, and drops the query itself. Beyond WAITING_MAX, the oldest queries
    that wait get no answer: who asked may ask again. No network thread waits for a board.

    The queries of all keys wait in one line, which `threads` threads serve. They sleep until a query comes: a
    thread that waits at a handler of Zenoh wakes ten times a second, and a robot has many keys.
    """

    def __init__(
        self,
        session: zenoh.Session,
        answers: Mapping[str, Answer],
        refusals: Refusals,
        *,
        threads: int = 1,
    ) -> None:
        self._refusals = refusals
        self._closed = False
        self._waiting: SimpleQueue[tuple[zenoh.Query, Answer] | None] = SimpleQueue()
        self._queryables = [
            session.declare_queryable(key, self._taker(answer)) for key, answer in answers.items()
        ]
        names = f"zenoh {' '.join(answers)}"
        self._threads = [threading.Thread(target=self._work, name=names, daemon=True) for _ in range(threads)]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Answer no more. A query that waits gets no answer."""
        self._closed = True
        for queryable in self._queryables:
            queryable.undeclare()
        with suppress(Empty):
            while True:
                self._waiting.get_nowait()  # who asked learns it now, and not when the last answer is given
        for _ in self._threads:
            self._waiting.put(None)
        for thread in self._threads:
            thread.join()

    def _taker(self, answer: Answer) -> Callable[[zenoh.Query], None]:
        waiting = self._waiting

        def take(query: zenoh.Query) -> None:
            if waiting.qsize() >= WAITING_MAX:
                with suppress(Empty):  # a thread was faster
                    waiting.get_nowait()
            if not self._closed:
                waiting.put((query, answer))

        return take

    def _work(self) -> None:
        while (one := self._waiting.get()) is not None and not self._closed:
            query, answer = one
            kept = None
            try:
                kept = answer(query)
            except Refused as refused:
                self._refuse(query, refused.reason, refused.error)
            except UnityLinkError as error:
                self._refuse(query, reason_of(error), error)
            except Exception:
                _log.exception("a query at %s failed", query.key_expr)
            finally:
                if kept is not KEPT:
                    query.drop()
                del one, query  # else it is kept until the next one comes

    def _refuse(self, query: zenoh.Query, reason: str, error: UnityLinkError) -> None:
        self._refusals.add(reason, f"{query.key_expr}: {error}")
        try:
            query.reply_err(encode_failure(error))
        except Exception as failed:  # whoever asked is gone
            _log.debug("no answer to %s: %s", query.key_expr, failed)


def payload_of(query: zenoh.Query) -> bytes:
    """Return the payload of a query."""
    return query.payload.to_bytes() if query.payload is not None else b""


def reason_of(error: UnityLinkError) -> str:
    """Return the reason under which an error is counted."""
    return _REASONS.get(type(error).__name__, "board")


_REASONS = {
    "ProtocolError": "malformed",
    "ValueRangeError": "value",
    "UnknownName": "unknown",
    "AccessRefused": "access",
    "LeaseHeld": "access",
}
