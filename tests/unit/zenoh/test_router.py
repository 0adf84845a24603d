# SPDX-License-Identifier: BSD-3-Clause
"""Bridge, client and router are three places of a network, which is cut for a while."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path

import pytest
from unit.zenoh.elsewhere import PLACE, router
from unit.zenoh.rig import ANGLE, STAMP, rigged, until

from unitylink import connect
from unitylink.errors import LinkDown, LinkTimeout
from unitylink.zenoh.link import ZenohLink
from unitylink.zenoh.session import Network

CUT_S = 1.5


@pytest.mark.parametrize("place", [PLACE])
@pytest.mark.takes(3)
def test_a_router_in_a_place_of_its_own(tmp_path: Path, place: str) -> None:
    """A robot is read and written through the router. What was sent while the way was cut is not executed."""
    with rigged(tmp_path) as rig, router() as far:
        rig.bridge.close()
        rig.port = 0  # nobody uses the rig's own router any more
        rig.bridge = rig.made(Network(connect=far.locator), Network(connect=far.locator))
        until(lambda: rig.bridge.state()["away"] == "")
        with connect(f"zenoh:lab/arm1?connect={far.locator}") as link:
            assert isinstance(link, ZenohLink)
            assert link.read(ANGLE) == 250
            stamps = link.set_points("stamp", ttl_s=0.2)

            def written(stamp: int) -> bool:
                with suppress(LinkDown):  # on a busy machine, a stamp may be too late, or the client lost
                    stamps.send(stamp)
                return bool(rig.board.registers[STAMP] == stamp)

            until(lambda: written(1))
            far.let(False)
            cut_s = time.monotonic()
            while time.monotonic() < cut_s + CUT_S:
                written(2)
                time.sleep(0.05)
            assert rig.oracle.seen[-1][1] in (1, 0), "0: the client was taken for lost, so the board is safe"
            far.let(True)

            def read() -> bool:
                with suppress(LinkDown, LinkTimeout):
                    return link.read(ANGLE) == 250
                return False

            until(read, 30)
            assert 2 not in {value for _, value in rig.oracle.seen}, "nothing old was executed"
            until(lambda: written(3))
