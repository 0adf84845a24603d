# SPDX-License-Identifier: BSD-3-Clause
"""A line that comes back is cut at any byte, with boards that die and boards that run on.

The board itself counts whether a set-point was written once, twice, late or never.
"""

from __future__ import annotations

import contextlib
import random
import threading
from collections.abc import Callable

import pytest
from unit.link.reconnect_rig import FIFO, PATIENCE_S, SCRATCH, Rig, opened, until

from unitylink import Link
from unitylink.errors import LinkDown, LinkError, OutcomeUnknown

# ---- every moment: after each byte of each kind of request, in each direction


class Writer:
    """Writes numbers that never come again, and keeps what the link reported for each."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.numbers = iter(range(1, 1_000_000))
        self.done: list[int] = []
        self.unknown: list[int] = []
        self.refused: list[int] = []
        self.group = link.exchange_group(writes=[FIFO], reads=[SCRATCH])

    def tell(self, numbers: list[int], act: Callable[[], object]) -> None:
        try:
            act()
        except OutcomeUnknown:
            self.unknown += numbers
        except LinkDown:
            self.refused += numbers
        else:
            self.done += numbers

    def write(self) -> None:
        number = next(self.numbers)
        self.tell([number], lambda: self.link.write(FIFO, number))

    def exchange(self) -> None:
        number = next(self.numbers)
        self.tell([number], lambda: self.group.exchange([number]))

    def read(self) -> None:
        """Read. A read changes nothing, and always ends: with the word, or with an error."""
        self.tell([], lambda: self.link.read_many([SCRATCH, SCRATCH + 1]))

    def post(self) -> None:
        numbers = [next(self.numbers) for _ in range(3)]

        def act() -> None:
            self.link.post_many([FIFO] * 3, numbers)
            self.link.sync()

        try:
            act()
        except LinkDown:  # raised by one of the posts, or by sync
            self.unknown += numbers
            assert self.link.wait_up(PATIENCE_S)
            with contextlib.suppress(OutcomeUnknown):
                self.link.sync()
        except OutcomeUnknown:
            self.unknown += numbers
        else:
            self.done += numbers

    def subscribe(self) -> None:
        try:
            with self.link.subscribe([SCRATCH, SCRATCH + 1], divisor=20) as publishes:
                publishes.wait(0.01)
        except (LinkDown, OutcomeUnknown):
            pass

    def judge(self, written: list[int]) -> None:
        counted = {number: written.count(number) for number in written}
        assert all(count == 1 for count in counted.values()), "a set-point was written twice"
        assert [n for n in self.done if counted.get(n, 0) != 1] == [], "what was confirmed was not written"
        assert [n for n in self.refused if n in counted] == [], "what was refused was written"
        assert written == sorted(written), "a set-point came late"


# Bytes from one cut to the next, through every byte of a request and its answer. Posts and subscriptions need
# many messages, and a board that dies must be made again each time.
EVERY = {"write": 1, "exchange": 1, "read": 1, "post": 3, "subscribe": 9}
KILLED = 5


@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("killed", [False, True])
@pytest.mark.parametrize("what", EVERY)
def test_the_line_is_cut_anywhere(rig: Rig, protocol: str, killed: bool, what: str) -> None:
    """It is cut from the first byte of a request to the last byte of its answer."""
    if killed:
        rig.wire.on_cut = rig.restart
    step = max(EVERY[what], KILLED if killed else 1)
    cut = 0
    with opened(rig.url, protocol) as link:
        writer = Writer(link)
        act = getattr(writer, what)
        before = link.statistics()
        act()
        after = link.statistics()
        sent, received = after.bytes_sent - before.bytes_sent, after.bytes_received - before.bytes_received
        assert sent > 5 and received > 1
        for way, size in (("to the board", sent), ("to the host", received)):
            for count in range(0, size + 1, step):
                cuts = rig.wire.cuts
                rig.wire.cut_after(way, count)
                act()
                if rig.wire.cuts == cuts:  # the last byte passed uncut
                    rig.wire.cut_after(way, 0)
                until(lambda cuts=cuts: rig.wire.cuts > cuts)
                assert link.wait_up(PATIENCE_S)
                act()
                cut += 1
        so_far = len(writer.done)
        until(lambda: writer.write() or len(writer.done) > so_far)
    rig.close()
    writer.judge(rig.written)
    assert cut * step > sent + received


@pytest.mark.parametrize("protocol", ["framed", "classic"])
def test_connecting_is_cut_anywhere(rig: Rig, protocol: str) -> None:
    """At the first connection, a cut is an error with the URL. After a loss, the link tries again."""
    whole = 0
    for count in range(0, 200, 3):
        rig.wire.cut_after("to the host", count)
        try:
            with opened(rig.url, protocol, "&attempts=2") as link:
                whole += 1
                rig.wire.cut_after("to the host", 0)
                until(lambda link=link: link.statistics().reconnections)
                cuts = rig.wire.cuts
                rig.wire.cut_after("to the host", 0)  # a second cut while the link is set up again
                until(lambda cuts=cuts: rig.wire.cuts > cuts)
                rig.wire.cut_after("to the host", count % 40)
                assert link.wait_up(PATIENCE_S)
        except LinkError as error:
            assert rig.url in str(error)
        rig.wire.cut_after("to the host", 0)
    assert whole > 0


def test_boards_die_at_random_under_many_threads(rig: Rig) -> None:
    rig.wire.on_cut = rig.restart
    random_ = random.Random(7)
    with opened(rig.url, "framed") as link:
        over = threading.Event()
        writer = Writer(link)

        def read() -> None:
            while not over.is_set():
                writer.read()

        def write() -> None:
            while not over.is_set():
                writer.write()

        publishes = link.subscribe([SCRATCH], divisor=1)
        threads = [threading.Thread(target=work) for work in (read, read, write)]
        for thread in threads:
            thread.start()
        for turn in range(1, 1000):
            rig.wire.cut_after(random_.choice(["to the board", "to the host"]), random_.randrange(400))
            until(lambda turn=turn: rig.wire.cuts == turn)
            assert link.wait_up(PATIENCE_S)
            # Some boards die again before they are set up. The machine decides how many.
            if turn >= 20 and link.statistics().restarts > 5 and len(writer.done) > 20:
                break
        over.set()
        for thread in threads:
            thread.join()
        publishes.drain()
        assert publishes.wait(PATIENCE_S)
        assert link.statistics().restarts > 5
    rig.close()
    writer.judge(rig.written)
    assert len(writer.done) > 20
