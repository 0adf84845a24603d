# SPDX-License-Identifier: BSD-3-Clause
"""A line that comes back: what goes on, what is refused, what is reported."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from collections.abc import Iterator

import pytest
from unit.link.cut_wire import CutWire
from unit.link.reconnect_rig import CONFIGURATION, FIFO, PATIENCE_S, SCRATCH, Rig, opened, until

from unitylink import Link, connect
from unitylink.errors import (
    DeadManTripped,
    DeviceMismatch,
    LinkClosed,
    LinkDown,
    LinkError,
    OutcomeUnknown,
)
from unitylink.layer2_message import LinkEvent
from unitylink.simulate import BoardConfiguration

# ---- what the program asked for goes on


@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("killed", [False, True])
def test_all_that_was_set_up_goes_on(rig: Rig, protocol: str, killed: bool) -> None:
    with opened(rig.url, protocol) as link:
        link.write(SCRATCH, 5)
        by_time = link.subscribe([SCRATCH, SCRATCH + 1], divisor=10)
        by_event = link.subscribe([SCRATCH + 1], on_event=True)
        ended = link.subscribe([SCRATCH + 2], divisor=10)
        group = link.exchange_group(writes=[SCRATCH + 3], reads=[SCRATCH])
        assert by_time.wait(PATIENCE_S)
        generation = link.generation
        if killed:
            rig.wire.on_cut = rig.restart
        rig.wire.cut_after("to the host", 1)
        until(lambda: link.statistics().reconnections == 1)
        assert link.generation != generation
        restarted = ["restarted"] if killed and protocol == "framed" else []
        kinds = [kind for kind, _, _ in link._native.events(0)[0]]
        assert kinds == ["lost", *restarted, "back"]
        ended.close()
        rig.board.registers[SCRATCH + 1] = 7
        expected = (0 if killed else 5, 7)

        def come() -> bool:
            _, rows = by_time.drain()
            return len(rows) > 0 and tuple(rows[-1]) == expected

        until(come)
        by_event.drain()
        rig.board.event(by_event.group)
        assert by_event.wait(PATIENCE_S)
        assert by_event.drain()[1].tolist() == [[7]]
        assert group.exchange([9]).tolist() == [expected[0]]
        assert rig.board.registers[SCRATCH + 3] == 9
        assert link.statistics().restarts == int(killed and protocol == "framed")
        assert not link.closed


def test_a_subscription_that_was_closed_meanwhile_stays_closed(rig: Rig) -> None:
    for protocol in ("framed", "classic"):
        with opened(rig.url, protocol) as link:
            kept, closed = link.subscribe([SCRATCH], divisor=10), link.subscribe([SCRATCH + 1], divisor=10)
            held = threading.Event()
            rig.wire.on_cut = lambda held=held: held.wait(PATIENCE_S)  # type: ignore[misc]
            rig.wire.cut_after("to the host", 1)
            until(lambda link=link: link.trouble)
            closed.close()
            held.set()
            assert link.wait_up(PATIENCE_S)
            kept.drain()
            assert kept.wait(PATIENCE_S)
            before = link.statistics().unclaimed_publishes
            for _ in range(5):
                kept.drain()
                assert kept.wait(PATIENCE_S)
            assert link.statistics().unclaimed_publishes == before


# ---- while it is gone


@pytest.fixture
def lost(rig: Rig) -> Iterator[Link]:
    """Yield a link whose board is gone."""
    with opened(rig.url, "framed") as link:
        rig.wire.close()
        until(lambda: link.trouble)
        rig.wire = CutWire(rig.board.url)  # elsewhere
        yield link


def test_requests_are_refused_at_once(lost: Link) -> None:
    group = 3
    for act in (
        lambda: lost.read(SCRATCH),
        lambda: lost.write(SCRATCH, 1),
        lambda: lost.read_many([1, 2, 3]),
        lambda: lost.write_many([1, 2], [3, 4]),
        lambda: lost.exchange([1], [(2, 3)]),
        lambda: lost.post(SCRATCH, 1),
        lost.sync,
        lost.arm,
        lambda: lost.set_dead_man(1),
        lambda: lost.subscribe([1], divisor=10),
        lambda: lost.exchange_group([1], [2]),
        lambda: lost.read_control(0),
        lambda: asyncio.run(_async_read(lost)),
        lambda: asyncio.run(_async_write(lost)),
    ):
        group += 1
        with pytest.raises(LinkDown, match="is being opened again"):
            act()
    assert not lost.closed
    assert not lost.up
    assert not lost.wait_up(0.01)
    assert "attempt" in lost.trouble
    assert lost.statistics().replies > 0


async def _async_read(link: Link) -> None:
    await link.read_async(SCRATCH)


async def _async_write(link: Link) -> None:
    await link.write_async(SCRATCH, 1)


def test_reads_wait_where_the_url_says_so(rig: Rig) -> None:
    with opened(rig.url, "framed", f"&wait={PATIENCE_S}") as link:
        rig.board.registers[SCRATCH] = 5
        held = threading.Event()
        rig.wire.on_cut = lambda: held.wait(PATIENCE_S)
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.trouble)
        with pytest.raises(LinkDown):
            link.write(SCRATCH, 1)
        with pytest.raises(LinkDown):
            link.read(FIFO, repeat=False)
        threading.Timer(0.05, held.set).start()
        assert link.read_many([SCRATCH, SCRATCH]).tolist() == [5, 5]
        rig.wire.cut_after("to the board", 3)  # in the middle of the request
        assert link.read(SCRATCH) == 5
        assert rig.wire.cuts == 2
    with opened(rig.url, "framed", "&wait=0.01") as link:
        held.clear()
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.trouble)
        with pytest.raises(LinkDown):
            link.read(SCRATCH)
        held.set()


def test_close_waits_for_no_connection(rig: Rig) -> None:
    """Nobody answers at the port, so a connection to it would wait for seconds."""
    with opened(rig.url, "framed", "") as link:
        place = rig.wire.url
        rig.wire.close()
        until(lambda: link.trouble)
        with socket.socket() as full:
            full.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            full.bind(("127.0.0.1", int(place.rsplit(":", 1)[1])))
            full.listen(0)
            waiting = []
            for _ in range(4):  # fill its queue of connections
                one = socket.socket()
                one.setblocking(False)
                one.connect_ex(full.getsockname())
                waiting.append(one)
            attempts = link.trouble
            until(lambda: link.trouble != attempts or True)
            time.sleep(0.3)  # now an attempt is under way, which may take 15 s
            started = time.monotonic()
            link.close()
            assert time.monotonic() - started < 5
            for one in waiting:
                one.close()
        with pytest.raises(LinkClosed):
            link.wait_up(1)
        rig.wire = CutWire(rig.board.url)


def test_waiters_hear_of_the_end(lost: Link) -> None:
    heard: list[type[BaseException]] = []

    def wait() -> None:
        try:
            lost.wait_up(PATIENCE_S)
        except LinkError as error:
            heard.append(type(error))

    thread = threading.Thread(target=wait)
    thread.start()
    lost.close()
    thread.join()
    assert heard == [LinkClosed]


# ---- the device


def test_a_running_dead_man_makes_the_outputs_safe_and_is_armed_by_the_program(rig: Rig) -> None:
    with opened(rig.url, "framed", "&deadman=20") as link:
        link.write(SCRATCH, 5)
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.statistics().reconnections)
        with pytest.raises(DeadManTripped):
            link.write(SCRATCH, 6)
        assert rig.board.registers[SCRATCH] == 5
        link.arm()
        link.write(SCRATCH, 7)
        state = link.dead_man()
        assert state is not None
        assert state.running and state.silence_s == 20
        rig.wire.on_cut = rig.restart
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.statistics().reconnections == 2)
        state = link.dead_man()  # a device that was reset has not tripped, so it is watched again
        assert state is not None
        assert state.running and not state.tripped and state.silence_s == 20


def test_a_reset_is_reported_although_the_line_stays(rig: Rig) -> None:
    with opened(rig.url, "framed") as link:
        heard: list[LinkEvent] = []
        link.on_event(heard.append)
        link.write(SCRATCH, 5)
        generation = link.generation
        rig.wire.lead_to(rig.restart)
        until(lambda: not rig.wire._change)
        until(lambda: link.read(SCRATCH) == 0)
        until(lambda: heard)
        assert [event.kind for event in heard] == ["restarted"]
        assert link.generation != generation
        assert link.statistics().restarts == 1
        assert link.statistics().reconnections == 0


@pytest.mark.parametrize("protocol", ["framed", "classic"])
def test_a_silent_device_is_lost_and_found_without_any_request(rig: Rig, protocol: str) -> None:
    with connect(f"{rig.url}?timeout=0.2&protocol={protocol}&reconnect=1") as link:
        publishes = link.subscribe([SCRATCH], divisor=10)
        rig.wire.stopped = True
        until(lambda: "does not answer" in link.trouble)
        rig.wire.stopped = False
        assert link.wait_up(PATIENCE_S)
        publishes.drain()
        assert publishes.wait(PATIENCE_S)


@pytest.mark.parametrize("protocol", ["framed", "classic"])
def test_another_device_ends_the_link(rig: Rig, protocol: str) -> None:
    with opened(rig.url, protocol) as link:
        rig.configuration = BoardConfiguration(groups=8, data_bits=16, fifos=CONFIGURATION.fifos)
        rig.wire.on_cut = rig.restart
        rig.wire.cut_after("to the host", 0)
        until(lambda: link.closed)
        with pytest.raises(DeviceMismatch, match="another device"):
            link.wait_up(1)
        with pytest.raises(DeviceMismatch):
            link.read(SCRATCH)


def test_unconfirmed_posts_are_reported_and_never_sent_again(rig: Rig) -> None:
    with opened(rig.url, "framed") as link:
        link.post(FIFO, 1)
        link.sync()  # what is on its way when the line is cut may be lost altogether
        rig.wire.cut_after("to the board", 100)
        with pytest.raises((LinkDown, OutcomeUnknown)) as told:
            for number in range(2, 400):
                link.post(FIFO, number)
            link.sync()
        assert link.wait_up(PATIENCE_S)
        if told.type is LinkDown:  # otherwise sync() already found the line back
            with pytest.raises(OutcomeUnknown, match="the line lost"):
                link.sync()
        link.sync()
        link.post(FIFO, 1000)
        link.sync()
    rig.close()
    # The line may be back while the loop still posts. These later posts are new. Only those lost at the cut
    # are missing.
    assert rig.written == sorted(set(rig.written)), "a post came twice, or late"
    assert rig.written[0] == 1 and rig.written[-1] == 1000
    assert len(rig.written) < 400


# ---- events


def test_callbacks_and_tasks_get_events_in_order(rig: Rig) -> None:
    async def follow(link: Link) -> list[str]:
        found = []
        async for event in link.events():
            found.append(event.kind)
            if len(found) == 3:
                break
        return found

    async def run() -> tuple[list[str], list[str]]:
        link = opened(rig.url, "framed")
        heard: list[str] = []

        def fail(event: LinkEvent) -> None:
            heard.append(event.kind)
            raise RuntimeError("as a callback may")

        link.on_event(fail)
        task = asyncio.create_task(follow(link))
        await asyncio.sleep(0)
        rig.wire.on_cut = rig.restart
        rig.wire.cut_after("to the host", 0)
        found = await asyncio.wait_for(task, PATIENCE_S)
        await asyncio.to_thread(until, lambda: len(heard) == 3)
        link.close()
        async for _ in link.events():
            raise AssertionError("a closed link has no events")
        return found, heard

    found, heard = asyncio.run(run())
    assert found == heard == ["lost", "restarted", "back"]


def test_an_async_iteration_goes_on(rig: Rig) -> None:
    async def run() -> None:
        link = opened(rig.url, "framed")
        count = 0
        async for _, (word,) in link.subscribe([SCRATCH], divisor=5):
            count += 1
            if count == 3:
                rig.wire.on_cut = rig.restart
                rig.wire.cut_after("to the host", 0)
                await asyncio.to_thread(until, lambda: link.statistics().reconnections)
                rig.board.registers[SCRATCH] = 9
            if word == 9:
                break
        link.close()

    asyncio.run(asyncio.wait_for(run(), PATIENCE_S))
