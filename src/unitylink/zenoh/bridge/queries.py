# SPDX-License-Identifier: BSD-3-Clause
"""Answers queries by a few threads, so that a slow answer does not hold up all others."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

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
    """

    def __init__(
        self,
        session: zenoh.Session,
        answers: Mapping[str, Answer],
        refusals: Refusals,
        *,
        threads: int = 1,
    ) -> None:
        import zenoh

        self._refusals = refusals
        self._closed = False
        self._queryables: list[Any] = []
        self._threads: list[threading.Thread] = []
        for key, answer in answers.items():
            queryable = session.declare_queryable(key, zenoh.handlers.RingChannel(WAITING_MAX))
            self._queryables.append(queryable)
            self._threads += [
                threading.Thread(
                    target=self._work, args=(queryable, answer), name=f"zenoh {key}", daemon=True
                )
                for _ in range(threads)
            ]
        for thread in self._threads:
            thread.start()

    def close(self) -> None:
        """Answer no more."""
        self._closed = True
        for queryable in self._queryables:
            queryable.undeclare()
        for thread in self._threads:
            thread.join()

    def _work(self, queryable: Any, answer: Answer) -> None:
        import zenoh

        while not self._closed:
            try:
                query = queryable.handler.recv()
            except zenoh.ZError:  # it was undeclared
                return
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
