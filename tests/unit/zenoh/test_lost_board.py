# SPDX-License-Identifier: BSD-3-Clause
"""A board, or its bridge, that is lost and comes back, or is another one then."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from unit.zenoh.rig import ANGLE, HITS, Rig, rigged, until

from unitylink import connect
from unitylink.errors import DeviceMismatch, LinkDown
from unitylink.layer2_message import Subscription
from unitylink.zenoh.link import ZenohLink


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    with rigged(tmp_path_factory.mktemp("zenoh")) as rig:
        yield rig


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def opened(stack: ExitStack, rig: Rig, more: str = "") -> ZenohLink:
    link = stack.enter_context(connect(rig.url(more)))
    assert isinstance(link, ZenohLink)
    return link


def test_a_board_that_dies_and_comes_back(stack: ExitStack, rig: Rig) -> None:
    """Its token goes within a second. Clients come back by themselves, and so do their publishes."""
    link = opened(stack, rig)
    rows: list[int] = []
    subscription = stack.enter_context(link.subscribe([ANGLE], divisor=10))
    subscription.on_publish(lambda time_s, words: rows.append(words[0]))
    until(lambda: rows)
    generation = link.generation
    began_s = time.monotonic()
    rig.board.close()
    until(lambda: not link.up)
    assert time.monotonic() - began_s < 1.0
    with pytest.raises(LinkDown, match="the board, its bridge or the way to it is gone"):
        link.read(ANGLE)
    rows.clear()
    rig.new_board()
    assert link.wait_up(10)
    assert link.read(ANGLE) == 250 and link.generation > generation
    until(lambda: rows)


def never_away(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bridge looks for its board so seldom that it never finds it gone."""
    real = rig.bridge._link

    def found() -> Any:
        while (link := real()) is None and not rig.bridge.ended.is_set():
            time.sleep(0.005)
        return link

    monkeypatch.setattr(rig.bridge, "_link", found)


def test_a_topic_goes_on_when_its_board_was_replaced(
    stack: ExitStack, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    samples: list[object] = []
    session = stack.enter_context(rig.network.opened())
    stack.callback(session.declare_subscriber("lab/arm1/publish/100_hz", samples.append).undeclare)
    until(lambda: samples)
    never_away(rig, monkeypatch)
    link = rig.robot.board_link()
    rig.board.close()
    rig.new_board()
    link.close()  # as if the board had refused what belonged to the link
    until(lambda: rig.robot.away == "")
    samples.clear()
    until(lambda: samples)


def test_a_board_is_replaced_by_one_with_fewer_groups(
    stack: ExitStack, rig: Rig, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """It is so fast that the bridge does not notice that the first one is gone."""

    link = opened(stack, rig)
    one, two = link.subscribe([ANGLE], divisor=10), link.subscribe([HITS], divisor=20)
    assert one.wait(10) and two.wait(10)
    never_away(rig, monkeypatch)
    rig.board.close()
    rig.new_board(groups=1)
    with pytest.raises(DeviceMismatch, match=r"board that came back refuses it: .*all 1 groups .* in use"):
        until(lambda: two.wait(0.1) and not two.drain())
    with pytest.raises(DeviceMismatch, match="refuses it"):
        asyncio.run(_all_of(two))
    assert "no more callbacks: the subscription has ended" in caplog.text
    one.drain()
    assert one.wait(10), "the first subscription goes on"
    monkeypatch.undo()
    rig.board.close()
    rig.new_board()
    until(lambda: link.up)


def test_a_bridge_that_dies_and_comes_back(stack: ExitStack, rig: Rig) -> None:
    """It is the router, too. Nothing that was meant for the old one is executed by the new one."""
    link = opened(stack, rig, "&timeout=0.2")
    link.write(HITS, 1)
    rig.bridge.close()
    until(lambda: not link.up)
    rig.start()
    assert link.wait_up(10)
    link.write(HITS, 2)
    assert rig.board.registers[HITS] == 2


async def _all_of(subscription: Subscription) -> None:
    async for _ in subscription:
        pass
