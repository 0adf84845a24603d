# SPDX-License-Identifier: BSD-3-Clause
"""Requests in words: each is executed at most once, and all of its copies get the same answer."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from unitylink.errors import LinkBusy, LinkDown, LinkTimeout, OutcomeUnknown, ProtocolError, UnityLinkError

from ..failures import encode_failure
from ..messages import (
    ARM,
    DO,
    LEAVE,
    ON_EVENT,
    READS,
    SUBSCRIBE,
    UNSUBSCRIBE,
    VERIFY,
    Answer,
    Request,
    decode_request,
)
from .ledger import OPEN_MAX, Verdict
from .queries import BYTES_MAX, KEPT, Refused, payload_of, reason_of
from .visits import UNKNOWN

if TYPE_CHECKING:
    import zenoh

    from .executor import Executor
    from .groups import Groups
    from .refusals import Refusals
    from .visits import Visit, Visits

_log = logging.getLogger("unitylink.zenoh")
_ALWAYS = frozenset((UNSUBSCRIBE, LEAVE))  # what is done however late: it only lets something go
_ERROR, _ANSWER = b"e", b"a"  # what the ledger keeps: an answer, or an error


class Requests:
    """Answers the queries of clients that have said hello. `leave` is called for one that goes in order."""

    def __init__(
        self,
        executor: Executor,
        visits: Visits,
        lock: threading.Lock,
        groups: Groups,
        *,
        refusals: Refusals,
        leave: Callable[[Visit], None],
    ) -> None:
        self._executor, self._visits, self._lock = executor, visits, lock
        self._groups, self._refusals, self._leave = groups, refusals, leave
        self._copies: dict[tuple[int, int], list[zenoh.Query]] = {}  # they wait for the first one

    def answer(self, query: zenoh.Query) -> object:
        """Answer a query in the form of `decode_request`."""
        visit, request = self.taken(payload_of(query))
        if not request.once:
            query.reply(query.key_expr, self._done(visit, request))
            return None
        return self.answer_once(query, visit, request, lambda: self._done(visit, request))

    def taken(self, data: bytes) -> tuple[Visit, Request]:
        """Return who asks what. Raises Refused."""
        if len(data) > BYTES_MAX:
            raise Refused("malformed", ProtocolError(f"a request of {len(data)} bytes"))
        request = decode_request(data)
        with self._lock:
            visit = self._visits.get(request.visit)
        if visit is None:
            raise Refused("unknown", LinkDown(UNKNOWN))
        return visit, request

    def answer_once(
        self, query: zenoh.Query, visit: Visit, request: Request, do: Callable[[], bytes]
    ) -> object:
        """Answer with what `do` returns or raises. It is called once, whatever comes how often.

        An error of this program is OutcomeUnknown for all who have asked, and is raised.
        """
        place = (visit.number, request.id)
        with self._lock:
            known = visit.ledger.begin(request.id, request.settled)
            if known is Verdict.RUNNING:
                self._copies.setdefault(place, []).append(query)
                return KEPT
        if known is Verdict.SETTLED:
            raise OutcomeUnknown("the request came again after its client had given it up")
        if known is Verdict.FULL:
            raise Refused("full", LinkBusy(f"{OPEN_MAX} requests of this client are open"))
        if isinstance(known, bytes):
            self._reply(query, known)
            return None
        kept = _ERROR + encode_failure(OutcomeUnknown("the bridge failed while it executed the request"))
        try:
            kept = _ANSWER + do()
        except UnityLinkError as error:
            self._refusals.add(reason_of(error), f"{query.key_expr}: {error}")
            kept = _ERROR + encode_failure(error)
        finally:
            with self._lock:
                visit.ledger.finish(request.id, kept)
                copies = self._copies.pop(place, [])
            self._reply(query, kept)
            for one in copies:
                self._reply(one, kept)
                one.drop()
        return None

    def _reply(self, query: zenoh.Query, kept: bytes) -> None:
        try:
            if kept[:1] == _ERROR:
                query.reply_err(kept[1:])
            else:
                query.reply(query.key_expr, kept[1:])
        except Exception as failed:  # whoever asked is gone; the others get their answers
            _log.debug("no answer to %s: %s", query.key_expr, failed)

    def _done(self, visit: Visit, request: Request) -> bytes:
        words: list[int] = []
        late = request.deadline_ns and time.monotonic_ns() >= request.deadline_ns
        if late and request.kind not in _ALWAYS:
            raise LinkTimeout("it reached the bridge too late, and was not executed")
        if request.kind == DO:
            words = self._executor.words(visit.client, request)
        elif request.kind == SUBSCRIBE:
            words = [self._subscribed(visit, request)]
        elif request.kind == UNSUBSCRIBE:
            self._groups.leave(request.argument, visit.number)
            visit.groups.discard(request.argument)
        elif request.kind == ARM:
            self._executor.arm(visit.client, request.asked_ns)
        elif request.kind == LEAVE:
            self._leave(visit)
            return Answer(request.id, 0).encode()
        else:
            raise ProtocolError(f"a request of the kind {request.kind} does not belong here")
        return Answer(request.id, self._executor.generation, tuple(words)).encode()

    def _subscribed(self, visit: Visit, request: Request) -> int:
        if not request.operations or any(one[0] not in READS for one in request.operations):
            raise ProtocolError("a subscription names words to read")
        self._executor.check_reads(visit.client, request.operations)
        number = self._groups.join(
            visit.number,
            tuple(one[1] for one in request.operations),
            divisor=request.argument,
            on_event=bool(request.flags & ON_EVENT),
            verify=bool(request.flags & VERIFY),
            group=request.detail - 1 if request.detail else None,
        )
        visit.groups.add(number)
        return number
