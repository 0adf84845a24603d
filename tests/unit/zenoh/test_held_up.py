# SPDX-License-Identifier: BSD-3-Clause
"""A bridge that is held up, and a network that fails again just after it was mended."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest
import zenoh
from unit.zenoh.rig import ANGLE, GOAL, HITS, STAMP, Gap, Rig, rigged, until

from unitylink import connect
from unitylink.errors import AccessRefused, LinkDown, LinkTimeout, OutcomeUnknown
from unitylink.layer2_message import sent_before
from unitylink.zenoh.link import ZenohLink
from unitylink.zenoh.messages import SUBSCRIBE


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Rig]:
    with rigged(tmp_path_factory.mktemp("zenoh")) as rig:
        yield rig


@pytest.fixture
def link(rig: Rig) -> Iterator[ZenohLink]:
    with connect(rig.url()) as link:
        assert isinstance(link, ZenohLink)
        yield link


def late(rig: Rig) -> dict[str, Any]:
    told: dict[str, Any] = rig.bridge.refusals.report().get("late", {"count": 0, "last": ""})
    return told


def test_a_link_sends_nothing_from_a_moment_on(rig: Rig) -> None:
    line = rig.robot.board_link()
    sent_before(time.monotonic_ns() + 10**10, lambda: line.write(GOAL, 1))
    with pytest.raises(LinkTimeout, match="not sent: its time was over"):
        sent_before(time.monotonic_ns(), lambda: line.write(GOAL, 2))
    assert line.read(GOAL) == 1, "and the limit has ended with the call"


def test_what_is_held_up_in_the_bridge_is_not_written_late(
    link: ZenohLink, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The clock is looked at when bytes go to the line, and not only before."""
    executor, held_s = rig.bridge._executor, [0.0]
    group = executor._group

    def slowly(*what: Any) -> Any:
        time.sleep(held_s[0])  # behind the first look
        return group(*what)

    monkeypatch.setattr(executor, "_group", slowly)
    goals = link.set_points("j1.goal", ttl_s=0.2)
    until(lambda: goals.send(0.5) or rig.board.registers[GOAL] == 500)
    before, held_s[0] = late(rig)["count"], 0.3
    goals.send(0.7)
    until(lambda: late(rig)["count"] > before)
    assert "not sent: its time was over" in late(rig)["last"]
    assert rig.board.registers[GOAL] == 500
    held_s[0] = 0.0
    until(lambda: goals.send(0.9) or rig.board.registers[GOAL] == 900)


def test_what_is_written_while_its_lease_is_lost_is_made_safe_again(
    link: ZenohLink, rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The SAFE values go to the board beside a write that is under way, so they may be first."""
    executor, guests = rig.bridge._executor, rig.bridge._guests
    group = executor._group
    stamp = link.set_points("stamp", ttl_s=5.0)
    until(lambda: stamp.send(5) or rig.board.registers[STAMP] == 5)

    def lost_meanwhile(*what: Any) -> Any:
        if what[2] != {"stamp": 7}:
            return group(*what)  # an earlier one, which is still under way
        (visit,) = (one for one in guests.visits.all() if one.number == link._far.bridge.visit)
        guests._gone(visit, "of the test")
        until(lambda: rig.board.registers[STAMP] == 0)
        return SimpleNamespace(write=seen_at_the_board(group(*what).write))

    def seen_at_the_board(write: Any) -> Any:
        def write_and_wait(*what: Any, **how: Any) -> None:
            write(*what, **how)
            until(lambda: rig.oracle.seen[-1][1] == 7)

        return write_and_wait

    monkeypatch.setattr(executor, "_group", lost_meanwhile)
    stamp.send(7)
    until(lambda: [value for _, value in rig.oracle.seen][-2:] == [7, 0])


def test_a_write_whose_way_is_lost_after_it_has_arrived_is_not_told_as_not_sent(rig: Rig) -> None:
    """Who gets LinkDown may write again. So it is for what was not sent, and this was executed."""
    gap = Gap(rig.port)
    with connect(rig.url("&timeout=0.5&attempts=4", gap.port)) as link:
        link.write(HITS, 0)
        gap.back.clear()  # the request arrives, its answer does not
        lost = threading.Thread(target=lambda: until(lambda: rig.board.registers[HITS]) and gap.lose())
        lost.start()
        with pytest.raises(OutcomeUnknown, match="executed once or never"), link.batch() as batch:
            batch.add(HITS, 1)
        lost.join()
        assert rig.board.registers[HITS] == 1
        assert link.wait_up(10)
    gap.close()


def test_a_subscription_whose_answer_is_lost_comes_back(
    link: ZenohLink, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After a loss, all is subscribed anew. The network may fail again in that moment."""
    rows: list[int] = []
    subscription = link.subscribe([ANGLE], divisor=10)
    subscription.on_publish(lambda time_s, words: rows.append(words[0]))
    until(lambda: rows)
    bridge, asked = link._far.bridge, list[int]()
    ask = bridge.ask

    def first_is_lost(kind: int, *what: Any, **more: Any) -> Any:
        asked.append(kind)
        if asked.count(SUBSCRIBE) == 1 and kind == SUBSCRIBE:
            raise OutcomeUnknown("no answer")
        return ask(kind, *what, **more)

    monkeypatch.setattr(bridge, "ask", first_is_lost)
    bridge.greet_again()
    until(lambda: asked.count(SUBSCRIBE) == 2 and link.up)
    rows.clear()
    until(lambda: rows)
    subscription.close()


def test_a_stop_goes_before_all_else(link: ZenohLink, monkeypatch: pytest.MonkeyPatch) -> None:
    sent: dict[str, tuple[Any, bool]] = {}
    questions = link._far.bridge.questions
    real = questions._session

    class Session:
        def get(self, key: str, **how: Any) -> Any:
            sent[key.rpartition("/")[2]] = how["priority"], how["express"]
            return real.get(key, **how)

    monkeypatch.setattr(questions, "_session", Session())
    link.trip()
    stop = sent.pop("stop")
    assert link.read(GOAL) == 0
    monkeypatch.undo()
    assert stop == (zenoh.Priority.REAL_TIME, True)
    assert sent and all(priority != zenoh.Priority.REAL_TIME for priority, _ in sent.values())


def test_a_stop_while_the_board_is_away(rig: Rig, link: ZenohLink) -> None:
    """It is an error, and holds: the board that comes is made safe, and nobody writes before `arm`."""
    rig.board.close()
    until(lambda: not link.up)
    with pytest.raises(LinkDown):
        link.trip()
    board = rig.new_board()
    board.registers[GOAL] = 700  # what it does at power-up
    until(lambda: board.registers[GOAL] == 0)
    assert link.wait_up(10)
    with pytest.raises(AccessRefused, match=r"zenoh has stopped the robot; .*link\.arm\(\)"):
        link.write(GOAL, 1)
    link.arm()
    link.write(GOAL, 2)
    assert board.registers[GOAL] == 2


def test_an_arm_that_is_held_up_does_not_end_a_later_stop(rig: Rig, link: ZenohLink) -> None:
    """It arrives in time, and its way is longer than that of the stop which came after it."""
    gap, told = Gap(rig.port), list[Exception]()
    with connect(rig.url("&timeout=5", gap.port)) as far:
        link.trip()
        far.arm()  # this one knows of the stop

        def arm() -> None:
            try:
                far.arm()
            except AccessRefused as error:
                told.append(error)

        gap.there.clear()
        arming = threading.Thread(target=arm)
        arming.start()
        until(lambda: far._far.bridge._open)  # type: ignore[attr-defined]
        time.sleep(0.1)  # so it is under way
        link.trip()
        gap.there.set()
        arming.join(20)
        assert "was stopped after this was asked for" in str(told[0])
        with pytest.raises(AccessRefused, match="has stopped the robot"):
            link.write(GOAL, 1)
        far.arm()
        link.write(GOAL, 3)
    gap.close()
