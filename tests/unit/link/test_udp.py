# SPDX-License-Identifier: BSD-3-Clause
"""Datagrams: what the network reports about them, and who may send them."""

from __future__ import annotations

import pytest

from unitylink import Link
from unitylink.errors import LinkNotFound, LinkTimeout
from unitylink.simulate import Board


def test_port_unreachable_is_a_lost_datagram_and_not_the_end() -> None:
    """A board that restarts causes this message, and anybody can forge it."""
    with Board(endpoint="udp") as board:
        place = board.url
        link = Link(f"{place}?timeout=0.05&attempts=2")
        link.write(0x10, 5)
    with pytest.raises(LinkTimeout):
        link.read(0x10)
    assert not link.closed
    with Board(endpoint=f"udp:{place.rpartition(':')[2]}") as again:
        again.registers[0x10] = 7
        for _ in range(100):  # the session is a new one, so reads are repeated in it
            try:
                assert link.read(0x10) == 7
                break
            except LinkTimeout:
                continue
        else:
            pytest.fail("the board is back, and the link is not")
        link.close()


def test_where_nobody_has_ever_answered_nobody_is_there() -> None:
    with Board(endpoint="udp") as board:
        place = board.url
    with pytest.raises(LinkNotFound):
        Link(f"{place}?timeout=0.5")
