# SPDX-License-Identifier: BSD-3-Clause
"""A request is executed at most once, and its outcome told, whatever the network does to its copies."""

from __future__ import annotations

import json
import random
import threading
from typing import Any
from unittest.mock import MagicMock

import pytest

from unitylink.zenoh.bridge.ledger import OPEN_MAX, Ledger, Verdict
from unitylink.zenoh.bridge.queries import KEPT
from unitylink.zenoh.bridge.requests import Requests

ATTEMPTS = 3


class _Bridge:
    """Executes what its ledger calls new, and counts how often it did so for each id."""

    def __init__(self) -> None:
        self.ledger: Ledger[bytes] = Ledger()
        self.executed: dict[int, int] = {}
        self.running: set[int] = set()

    def take(self, number: int, settled: int) -> bytes | Verdict:
        known = self.ledger.begin(number, settled)
        if known is Verdict.NEW:
            self.executed[number] = self.executed.get(number, 0) + 1
            self.running.add(number)
        return known

    def end(self, number: int) -> bytes:
        self.running.discard(number)
        answer = b"%d" % number
        self.ledger.finish(number, answer)
        return answer


@pytest.mark.parametrize("seed", range(20))
def test_copies_that_are_lost_doubled_late_and_out_of_order(seed: int) -> None:
    """The outcome that a client believes is the truth: told means executed once, not told means 0 or 1."""
    chance, bridge = random.Random(seed), _Bridge()
    flying: list[tuple[int, int]] = []  # copies that the network still has
    told: dict[int, bytes] = {}
    open_ids: set[int] = set()
    for number in range(1, 400):
        open_ids.add(number)
        settled = min(open_ids)
        for _ in range(ATTEMPTS):
            flying += [(number, settled)] * chance.choice((0, 1, 1, 1, 2))
            chance.shuffle(flying)
            for _ in range(chance.randrange(4)):
                if not flying:
                    break
                one = flying.pop()
                answer = bridge.take(*one)
                if answer is Verdict.NEW and chance.random() < 0.8:
                    answer = bridge.end(one[0])
                if isinstance(answer, bytes) and chance.random() < 0.7:  # else the answer is lost
                    told[one[0]] = answer
            if number in told:
                break
        for late in list(bridge.running):
            bridge.end(late)
        if chance.random() < 0.9:
            open_ids.discard(number)  # else it is a call of another thread, which goes on
    for one in flying:
        bridge.take(*one)
    assert set(bridge.executed.values()) == {1}, "no id was executed twice"
    assert all(answer == b"%d" % number and number in bridge.executed for number, answer in told.items())
    assert bridge.ledger.repeated > 0, "copies did come again"


def test_a_request_that_its_client_has_given_up_is_not_executed_later() -> None:
    ledger: Ledger[bytes] = Ledger()
    assert ledger.begin(5, settled=5) is Verdict.NEW
    ledger.finish(5, b"done")
    assert ledger.begin(9, settled=9) is Verdict.NEW
    assert ledger.begin(7, settled=3) is Verdict.SETTLED, "an old copy that comes after all"
    assert ledger.begin(5, settled=5) is Verdict.SETTLED


def test_the_open_requests_of_a_client_are_limited() -> None:
    ledger: Ledger[bytes] = Ledger()
    for number in range(1, OPEN_MAX + 1):
        assert ledger.begin(number, settled=1) is Verdict.NEW
    assert ledger.begin(OPEN_MAX + 1, settled=1) is Verdict.FULL
    ledger.finish(1, b"")
    assert ledger.begin(OPEN_MAX + 1, settled=2) is Verdict.NEW


def test_an_answer_that_nobody_waits_for_is_not_kept() -> None:
    ledger: Ledger[bytes] = Ledger()
    ledger.begin(1, settled=1)
    ledger.begin(2, settled=2)
    ledger.finish(1, b"late")
    assert ledger.begin(1, settled=2) is Verdict.SETTLED


class _Query:
    """A copy of a request. It keeps its answer, or nobody is there any more to take it."""

    key_expr = "lab/arm1/do/1"

    def __init__(self, *, there: bool = True) -> None:
        self.told: dict[str, Any] = {}
        self.dropped = False
        self._there = there

    def reply_err(self, data: bytes) -> None:
        if not self._there:
            raise ValueError("whoever asked is gone")
        self.told = json.loads(data)

    def drop(self) -> None:
        self.dropped = True


def test_a_failure_of_the_bridge_answers_all_copies() -> None:
    """Each copy gets a typed error: who waited, who is behind one that is gone, and who comes later."""
    requests = Requests(
        MagicMock(), MagicMock(), threading.Lock(), MagicMock(), refusals=MagicMock(), leave=MagicMock()
    )
    visit, request = MagicMock(number=7, ledger=Ledger()), MagicMock(id=1, settled=1)
    first, gone, waits, late = _Query(), _Query(there=False), _Query(), _Query()

    def fail() -> bytes:
        for one in (gone, waits):  # they come meanwhile
            assert requests.answer_once(one, visit, request, fail) is KEPT  # type: ignore[arg-type]
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        requests.answer_once(first, visit, request, fail)  # type: ignore[arg-type]
    requests.answer_once(late, visit, request, fail)  # type: ignore[arg-type]
    for one in (first, waits, late):
        assert one.told["error"] == "OutcomeUnknown" and "the bridge failed" in one.told["text"]
    assert (gone.dropped, waits.dropped) == (True, True)
