# SPDX-License-Identifier: BSD-3-Clause
"""Attempts to connect are short, so that the next one comes soon. A slow way gets a long one."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from unit.zenoh.rig import Gap, free_port

from unitylink.errors import LinkNotFound
from unitylink.zenoh import session
from unitylink.zenoh.session import Network


class Slow(Gap):
    """A way on which whatever is sent needs some time, or never arrives in the first connections."""

    def __init__(self, port: int, delay_s: float, dead: int = 0) -> None:
        self._delay_s, self._dead, self.begun_s = delay_s, dead, list[float]()
        super().__init__(port)

    def _carry(self, source: Any, target: Any, open_: Any) -> None:
        self.begun_s.append(time.monotonic())  # twice for each connection
        if len(self.begun_s) <= 2 * self._dead:
            return
        time.sleep(self._delay_s)
        super()._carry(source, target, open_)


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def through(stack: ExitStack, delay_s: float, dead: int = 0) -> tuple[Slow, Network]:
    port = free_port()
    stack.enter_context(Network(listen=f"tcp/127.0.0.1:{port}").opened())
    way = Slow(port, delay_s, dead)
    stack.callback(way.close)
    return way, Network(connect=f"tcp/127.0.0.1:{way.port}")


def test_an_attempt_without_an_answer_is_given_up_soon(
    stack: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert session._OPEN_MS + session._PAUSE_MS < 700, "TCP alone would ask again after 1 s"
    monkeypatch.setattr(session, "_OPEN_MS", 100)
    way, network = through(stack, 0.0, dead=2)
    stack.enter_context(network.opened())
    first_s, third_s = way.begun_s[0], way.begun_s[4]
    assert 0.3 < third_s - first_s < 2.0


@pytest.mark.takes(2)
def test_a_way_that_is_too_slow_for_a_short_attempt_gets_a_long_one(
    stack: ExitStack, monkeypatch: pytest.MonkeyPatch
) -> None:
    way, network = through(stack, 0.15)
    monkeypatch.setattr(session, "_OPEN_MS", 50)
    monkeypatch.setattr(session, "_TRY_MS", 200)
    opened = stack.enter_context(network.opened())
    assert opened.info.routers_zid() and len(way.begun_s) > 2
    monkeypatch.setattr(session, "_SLOW_OPEN_MS", 50)
    with pytest.raises(LinkNotFound, match="no Zenoh router answers"):
        network.opened()
