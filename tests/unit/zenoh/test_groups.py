# SPDX-License-Identifier: BSD-3-Clause
"""Which groups of the board the users of a bridge share."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from tests.unit.server.served import arm
from unitylink import Link
from unitylink.simulate import Board
from unitylink.zenoh.bridge.groups import Groups

WORDS = (0x1A, 0x1B)


@pytest.fixture
def groups() -> Iterator[Groups]:
    nobody: Any = SimpleNamespace(put=lambda data: None, undeclare=lambda: None)
    with Board(arm()) as board, Link(board.url) as link:
        made = Groups(lambda: link, lambda number: nobody)
        yield made
        made.clear()


def test_equal_wishes_share_a_group_and_others_do_not(groups: Groups) -> None:
    first = groups.join(1, WORDS, divisor=100)
    assert groups.join(2, WORDS, divisor=100) == first
    assert groups.join(2, WORDS, divisor=200) != first
    assert groups.join(2, WORDS[:1], divisor=100) != first


def test_who_wants_a_certain_group_of_the_board_shares_no_other(groups: Groups) -> None:
    """Its event input is what matters. Who wants any takes what is there."""
    first = groups.join(1, WORDS, divisor=0, on_event=True, group=0)
    second = groups.join(2, WORDS, divisor=0, on_event=True, group=1)
    assert first != second
    assert groups.join(3, WORDS, divisor=0, on_event=True, group=1) == second
    assert groups.join(4, WORDS, divisor=0, on_event=True) == first
