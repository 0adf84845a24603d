# SPDX-License-Identifier: BSD-3-Clause
"""A set-point is written if it is the newest, and never after its time, whatever clocks and network do."""

from __future__ import annotations

import random

import pytest

from unitylink.zenoh.bridge.freshest import KEYS_MAX, Freshest
from unitylink.zenoh.far_clock import DRIFT, FarClock
from unitylink.zenoh.messages import TTL_MAX_NS, SetPoint

MS = 1_000_000


class _Clocks:
    """The clock of a client and that of a bridge, with another zero and another pace."""

    def __init__(self, chance: random.Random) -> None:
        self.zero_ns = chance.randrange(-(10**15), 10**15)
        self.pace = 1 + chance.uniform(-DRIFT, DRIFT)

    def far(self, here_ns: int) -> int:
        return self.zero_ns + int(here_ns * self.pace)


@pytest.mark.parametrize("seed", range(30))
def test_an_arm_is_dated_by_the_question_that_came_there_fastest(seed: int) -> None:
    chance = random.Random(seed)
    clocks, clock, now_ns, best_ns = _Clocks(chance), FarClock(), 10**12, 10**18
    for _ in range(50):
        there, back = (chance.choice((1, 3, 900)) * MS for _ in range(2))
        clock.learn(now_ns, clocks.far(now_ns + there), now_ns + there + back)
        now_ns += there + back + chance.randrange(500 * MS)
        drifted_ns = int(2.1 * DRIFT * 3000 * MS)
        best_ns = min(best_ns + drifted_ns, there + drifted_ns)
        late_ns = clock.latest(now_ns) - clocks.far(now_ns)
        assert 0 <= late_ns <= best_ns, "an older or a later time than what the answers allow"


@pytest.mark.parametrize("seed", range(30))
def test_no_set_point_is_executed_after_its_time(seed: int) -> None:
    """The oracle knows both clocks. Delays go up to seconds, questions are asked at any time."""
    chance = random.Random(seed)
    clocks, clock, freshest = _Clocks(chance), FarClock(), Freshest()
    ttl_ns, now_ns = 100 * MS, 10**12
    sent_ns: dict[int, int] = {}
    flying: list[tuple[int, SetPoint]] = []
    executed: list[int] = []
    for number in range(600):
        now_ns += chance.randrange(20 * MS)
        if number % 40 == 0:  # the way to the bridge, and the way back
            there, back = (int(chance.expovariate(1 / (5 * MS))) for _ in range(2))
            if chance.random() < 0.2:
                back += chance.randrange(3000 * MS)
            clock.learn(now_ns, clocks.far(now_ns + there), now_ns + there + back)
            now_ns += there + back
        sent_ns[number] = now_ns
        assert clock.latest(now_ns) >= clocks.far(now_ns), "an arm would look older than a stop before it"
        point = SetPoint("j1", 1, number, clock.deadline(now_ns, ttl_ns), b"")
        delay = chance.choice((1, 5, 30, 90, 110, 400, 5000)) * MS
        flying += [(now_ns + delay, point)] * chance.choice((0, 1, 1, 2))
        for due in sorted((one for one in flying if one[0] <= now_ns), key=lambda one: one[0]):
            flying.remove(due)
            freshest.offer(due[1], clocks.far(now_ns))
        if chance.random() < 0.7:  # else the board is busy
            for one in freshest.take(clocks.far(now_ns)):
                assert now_ns - sent_ns[one.sequence] <= ttl_ns + 1, "older than its time to live"
                assert not executed or one.sequence > executed[-1], "a newer one was executed before"
                executed.append(one.sequence)
    assert len(executed) > 20


def test_the_time_that_is_lost_is_a_round_trip_at_most() -> None:
    clock = FarClock()
    clock.learn(asked_ns=0, told_ns=500 * MS, heard_ns=4 * MS)
    assert 0 <= 500 * MS + 4 * MS + 100 * MS - clock.deadline(4 * MS, 100 * MS) <= 4 * MS + MS // 10
    assert 0 <= clock.latest(4 * MS) - (500 * MS + 4 * MS) <= 4 * MS + MS // 10
    clock.learn(asked_ns=10 * MS, told_ns=511 * MS, heard_ns=911 * MS)  # a slow answer says less
    assert clock.here(500 * MS) == 2 * MS


@pytest.mark.parametrize(
    ("deadline_ns", "why"), [(99, "late"), (100, "late"), (101, ""), (100 + TTL_MAX_NS + 1, "time to live")]
)
def test_a_deadline_is_soon_and_not_over(deadline_ns: int, why: str) -> None:
    assert Freshest().offer(SetPoint("j1", 1, 1, deadline_ns, b""), now_ns=100) == why


def test_the_newest_of_each_key_wins_and_the_others_are_counted() -> None:
    freshest = Freshest()
    for key, number in (("j1", 1), ("j2", 1), ("j1", 2), ("j1", 4)):
        assert freshest.offer(SetPoint(key, 7, number, 1000, b""), 0) == ""
    assert freshest.offer(SetPoint("j1", 7, 3, 1000, b""), 0) == "overtaken"
    assert freshest.offer(SetPoint("j1", 7, 4, 1000, b""), 0) == "overtaken"
    assert [(one.key, one.sequence) for one in freshest.take(10)] == [("j2", 1), ("j1", 4)]
    assert (freshest.replaced, freshest.late) == (2, 0)
    freshest.offer(SetPoint("j1", 7, 5, 1000, b""), 0)
    assert freshest.take(1000) == [] and freshest.late == 1


def test_what_a_lost_client_has_sent_is_dropped() -> None:
    freshest = Freshest()
    freshest.offer(SetPoint("j1", 7, 1, 1000, b""), 0)
    freshest.offer(SetPoint("j2", 8, 1, 1000, b""), 0)
    freshest.forget(7)
    assert [one.key for one in freshest.take(0)] == ["j2"]
    assert freshest.offer(SetPoint("j1", 7, 1, 1000, b""), 0) == "", "nothing is known of it any more"


def test_the_keys_of_a_client_are_limited() -> None:
    freshest = Freshest()
    for number in range(KEYS_MAX):
        freshest.offer(SetPoint(f"k{number}", 1, 1, 1000, b""), 0)
    assert freshest.offer(SetPoint("one more", 1, 1, 1000, b""), 0) == "full"
