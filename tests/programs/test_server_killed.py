# SPDX-License-Identifier: BSD-3-Clause
"""kill -9 of the server at random points of a run with a writer and a dead-man.

The board's own journal of its output is the oracle.
"""

from __future__ import annotations

import random
import threading

import pytest

from tests.programs.kill_rig import TARGET, TOKEN, KillRig, kill_rig
from tests.unit.server.served import token_of
from tests.unit.server.test_serving import until
from unitylink import Link
from unitylink.errors import DeadManTripped, LeaseHeld, LinkClosed, LinkError, OutcomeUnknown

POINTS, LONG_POINTS = 20, 1000
DEAD_MAN_S = 0.1


def test_no_old_set_point_after_a_killed_server() -> None:
    _kill_often(POINTS, seed=1)


@pytest.mark.long
@pytest.mark.patience(3600)
def test_no_old_set_point_after_a_killed_server_at_a_thousand_points() -> None:
    _kill_often(LONG_POINTS, seed=2)


def _kill_often(points: int, seed: int) -> None:
    chance = random.Random(seed)
    with kill_rig() as rig, token_of(TOKEN):
        last = 0
        for point in range(1, points + 1):
            last = _kill_once(chance, rig, last)
            if point % 100 == 0:
                print(f"{point} servers killed, {last} values written")


def _kill_once(chance: random.Random, rig: KillRig, last: int) -> int:
    """Write rising values until the server dies. Return the last one that was tried."""
    wire, board, journal = rig.wire, rig.board, rig.journal
    server, place = rig.mother.start(f"{wire.url}?timeout=2")
    begin = len(journal.values)
    told: list[BaseException] = []
    answered, tried = last, last
    link = Link(f"serve://{place}/arm?timeout=2")
    if last:
        until(lambda: link.dead_man().tripped)  # the board's own, when its last server had gone
    assert board.registers[TARGET] == 0  # a new server has sent nothing of the old one
    link.arm()
    link.set_dead_man(DEAD_MAN_S)
    assert board.registers[TARGET] == 0

    def write() -> None:
        nonlocal answered, tried
        try:
            while True:
                tried += 1
                try:
                    link.write(TARGET, tried)
                except (DeadManTripped, LeaseHeld):  # this machine has paused: that is an answer, too
                    link.arm()
                    link.set_dead_man(DEAD_MAN_S)
                answered = tried
        except LinkError as error:
            told.append(error)

    wire.kill_after(server, chance.random() < 0.5, chance.randrange(1, 3000))
    writer = threading.Thread(target=write)
    writer.start()
    writer.join(20)
    assert told and isinstance(told[0], OutcomeUnknown | LinkClosed)  # never silence
    link.close()
    until(lambda: journal.values[-1] == 0 == board.registers[TARGET])
    seen = journal.values[begin:]
    rising = [value for value in seen if value]
    assert rising == sorted(set(rising))  # no value comes again
    assert all(last < value <= tried for value in rising)  # none is of an earlier server
    assert answered >= tried - 1
    return tried
