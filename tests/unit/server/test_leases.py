# SPDX-License-Identifier: BSD-3-Clause
"""The rule that matters: two clients never hold the same part, and a lost part is safe before it is given."""

import pytest
from effort import many
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from unitylink.errors import LeaseHeld, ValueRangeError
from unitylink.server.leases import Leases
from unitylink.server.subtree import contains, overlap

PARTS = ("", "j1", "j1.target", "j1.limit", "j10", "j[2]", "j")
PART, CLIENT = st.sampled_from(PARTS), st.integers(1, 3)


def leased(part="j1", client=1, duration_s=2.0, now_s=0.0):
    leases = Leases()
    leases.take(part, client=client, holder=f"user {client}", duration_s=duration_s, now_s=now_s)
    return leases


@pytest.mark.parametrize("other", ["j1", "j1.target", ""])
def test_an_overlapping_part_is_held(other):
    leases = leased()
    with pytest.raises(LeaseHeld, match=r"user 1 holds the write lease of j1, for 1\.5 s more"):
        leases.take(other, client=2, holder="user 2", duration_s=1.0, now_s=0.5)
    assert leases.take("j10", client=2, holder="user 2", duration_s=1.0, now_s=0.5)


def test_a_lost_part_is_made_safe_before_it_is_given():
    leases = leased()
    leases.lose(1)
    with pytest.raises(LeaseHeld, match=r"j1 is being made safe, because user 1 lost .*its connection ended"):
        leases.take("j1.target", client=2, holder="user 2", duration_s=1.0, now_s=0.1)
    assert not leases.may_write(1, "j1.target", 0.1)
    leases.made_safe("j1")
    assert leases.take("j1.target", client=2, holder="user 2", duration_s=1.0, now_s=0.1)


def test_the_old_holder_cannot_take_a_lost_part_either():
    leases = leased()
    with pytest.raises(LeaseHeld, match="its time was over"):
        leases.take("j1", client=1, holder="user 1", duration_s=2.0, now_s=2.0)


def test_a_released_part_is_free_at_once():
    leases = leased()
    leases.release(2, "j1")
    assert leases.may_write(1, "j1.target", 0.0)
    leases.release(1, "j1")
    assert not leases.all()


def test_a_handed_over_part_is_never_free():
    leases = leased()
    lease = leases.hand_over("j1", client=1, to=2, holder="user 2", now_s=1.0)
    assert (lease.client, lease.until_s) == (2, 3.0)
    assert not leases.ending()
    with pytest.raises(LeaseHeld):
        leases.hand_over("j1", client=1, to=1, holder="user 1", now_s=1.0)


def test_a_renewed_lease_runs_on():
    leases = leased()
    leases.renew(1, 1.9)
    assert leases.may_write(1, "j1", 3.8)
    assert not leases.may_write(1, "j1", 3.9)


@pytest.mark.parametrize("duration_s", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_a_duration_that_cannot_be(duration_s):
    with pytest.raises(ValueRangeError):
        leased(duration_s=duration_s)


class Machine(RuleBasedStateMachine):
    """Random calls beside a model: who may write which item, and which items are not safe yet."""

    def __init__(self):
        super().__init__()
        self.leases, self.now_s = Leases(), 0.0
        self.unsafe: set[str] = set()
        self.held: dict[int, set[str]] = {}

    def allowed(self):
        return {part: client for client, parts in self.held.items() for part in parts}

    @rule(part=PART, client=CLIENT, duration_s=st.sampled_from([1.0, 5.0]))
    def take(self, part, client, duration_s):
        foreign = [one for one in self.leases.all() if overlap(one.part, part)]
        blocked = any(one.client != client or one.ending or one.until_s <= self.now_s for one in foreign)
        try:
            self.leases.take(part, client=client, holder="x", duration_s=duration_s, now_s=self.now_s)
        except LeaseHeld:
            assert blocked
        else:
            assert not blocked
            assert self.leases.may_write(client, part, self.now_s)

    @rule(client=CLIENT)
    def lose(self, client):
        parts = {one.part for one in self.leases.of(client)}
        self.leases.lose(client)
        assert parts <= {one.part for one in self.leases.ending()}

    @rule(part=PART)
    def break_up(self, part):
        self.leases.break_up(part, "admin")
        assert not any(overlap(one.part, part) and not one.ending for one in self.leases.all())

    @rule(client=CLIENT, part=PART)
    def release(self, client, part):
        self.leases.release(client, part)

    @rule(client=CLIENT)
    def renew(self, client):
        self.leases.renew(client, self.now_s)

    @rule(seconds=st.sampled_from([0.3, 1.0, 4.0]))
    def wait(self, seconds):
        self.now_s += seconds

    @rule()
    def make_safe(self):
        for lease in self.leases.ending():
            self.leases.made_safe(lease.part)

    @invariant()
    def nobody_shares_a_part(self):
        leases = self.leases.all()
        for number, one in enumerate(leases):
            assert not any(overlap(one.part, other.part) for other in leases[number + 1 :])

    @invariant()
    def one_client_at_most_writes_an_item(self):
        for part in PARTS:
            writers = [one for one in (1, 2, 3) if self.leases.may_write(one, part, self.now_s)]
            assert len(writers) <= 1
            for lease in self.leases.ending():
                assert not (writers and contains(lease.part, part))


TestLeases = Machine.TestCase
TestLeases.settings = settings(max_examples=many(40), stateful_step_count=20, deadline=None)
