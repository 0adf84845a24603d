# SPDX-License-Identifier: BSD-3-Clause
"""The framed protocol from Python, on the twin, and on the reference device over a bad line."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from reference.line import Line

from unitylink.errors import BusError, DeadManTripped, DeviceMismatch, OutcomeUnknown, ProtocolError
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text


def test_a_batch_is_one_message_each_way() -> None:
    with Board() as board, Link(f"{board.url}?timeout=2") as link:
        assert (link.protocol, link.notice) == ("framed", "")
        requests = link.statistics().requests
        with link.batch(atomic=True) as batch:
            for address in range(0x10, 0x22):
                batch.write(address, 3 * address)
            words = [batch.read(address) for address in range(0x10, 0x22)]
            with pytest.raises(RuntimeError, match="it reads at the end"):
                _ = words[0].value
        assert [word.value for word in words] == [3 * address for address in range(0x10, 0x22)]
        assert link.statistics().requests == requests + 1
        with pytest.raises(ZeroDivisionError), link.batch() as batch:
            batch.write(0x10, 1 // 0)
        assert link.exchange([0x10, 0x11], writes=[(0x11, 9)]).tolist() == [0x30, 9]
        pairs = np.array([[0x12, 7], [0x13, 1 << 31]])  # any array of pairs is accepted
        for writes in (pairs, {0x12: 7, 0x13: 1 << 31}.items(), ((where, what) for where, what in pairs)):
            assert link.exchange((0x12, 0x13), writes).tolist() == [7, 1 << 31]
            link.write_many([0x12, 0x13], [0, 0])


def test_posts_and_what_became_of_them() -> None:
    with Board() as board, Link(f"{board.url}?timeout=2") as link:
        link.post_many([0x20] * 500, range(500))
        link.post(0x21, 7)
        assert link.read_many([0x20, 0x21]).tolist() == [499, 7]
        link.sync()
        health = link.health()
        assert health is not None
        assert (health.posts, health.post_errors, health.discarded_check) == (500 // 32 + 2, 0, 0)
        assert link.statistics().posts == 501


def test_what_a_classic_link_cannot_do_is_said() -> None:
    with (
        Board(configuration=BoardConfiguration(protocol="classic")) as board,
        Link(f"{board.url}?timeout=2") as link,
    ):
        assert link.protocol == "classic"
        assert "classic" in link.notice
        assert link.health() is None and link.description is None and link.clock is None
        link.post_many([0x20, 0x21], [5, 6])
        link.sync()
        assert link.exchange([0x20, 0x21], writes=[(0x21, 8)]).tolist() == [5, 8]
        with pytest.raises(DeviceMismatch, match="framed"):
            link.read_control(0)


def test_a_dead_man_trips_only_where_the_host_is_silent() -> None:
    with Board() as board, Link(f"{board.url}?timeout=2&deadman=20") as link:
        with pytest.raises(ProtocolError, match="control register"):
            link.read_control(0x1000)
        link.write(0x10, 1)
        link.arm()


def test_a_dead_man_trips_at_once_when_it_is_told_to() -> None:
    spec = compile_text("public arm() { @goal = 0x10: u16 WRITE(SAFE=3); }", "arm.ul").spec
    assert spec is not None
    with (
        Board(spec, configuration=BoardConfiguration.for_spec(spec)) as board,
        Link(f"{board.url}?timeout=2&deadman=20") as link,
    ):
        for _ in range(2):
            link.write(0x10, 7)
            link.trip()
            assert board.registers[0x10] == 3
            with pytest.raises(DeadManTripped):
                link.write(0x10, 8)
            link.trip()  # it has tripped already
            link.arm()
            state = link.dead_man()
            assert state is not None and not state.tripped and state.running
            assert state.silence_s == pytest.approx(20, abs=0.01)  # as before
        link.write(0x10, 9)
        assert board.registers[0x10] == 9


def test_a_classic_link_has_no_dead_man_to_trip() -> None:
    with (
        Board() as board,
        Link(f"{board.url}?protocol=classic") as link,
        pytest.raises(DeviceMismatch, match="framed"),
    ):
        link.trip()


@pytest.mark.parametrize("seed", range(6))
def test_everything_is_executed_once_or_reported_as_unknown(seed: int) -> None:
    line = Line(seed)
    choose = random.Random(seed)
    made: list[int] = []
    done: list[int] = []

    def fresh(count: int) -> list[int]:
        made.extend(range(len(made) + 1, len(made) + 1 + count))
        return made[-count:]

    def write(link: Link, words: list[int]) -> None:
        for word in words[:3]:
            link.write(word % 8, word)
        words[3:] = []

    def write_many(link: Link, words: list[int]) -> None:
        link.write_many([word % 8 for word in words], words)

    def post(link: Link, words: list[int]) -> None:
        link.post_many([word % 8 for word in words], words)
        link.sync()

    def exchange(link: Link, words: list[int]) -> None:
        words[10:] = []
        read = link.exchange([words[-1] % 8], writes=[(word % 8, word) for word in words])
        assert read.tolist() == [words[-1]]

    def cycle(link: Link, words: list[int]) -> None:
        words[4:] = []
        with link.exchange_group(writes=[word % 8 for word in words], reads=[words[-1] % 8]) as group:
            assert group.exchange(words).tolist() == [words[-1]]

    calls: list[Callable[[Link, list[int]], None]] = [write, write_many, post, exchange, cycle]
    with Link(line.url) as link:
        for _ in range(60):
            words = fresh(choose.randrange(1, 90))
            try:
                choose.choice(calls)(link, words)
                done += words
            except OutcomeUnknown:
                assert line.reset_rate > 0
        line.calm = True
    log = [value for what, _, value in line.device.bus.log if what == "write"]
    assert len(set(log)) == len(log)
    place = {value: index for index, value in enumerate(log)}
    assert all(value in place for value in done)
    assert [place[value] for value in done] == sorted(place[value] for value in done)


def test_a_bus_error_is_reported_with_its_address_and_stops_a_list() -> None:
    line = Line(0)
    line.calm = True
    line.device.bus.bad[0x30] = 1
    with Link(line.url) as link:
        with pytest.raises(BusError) as caught:
            link.write_many([0x2F, 0x30, 0x31], [1, 2, 3])
        assert caught.value.address == 0x30
        assert 0x31 not in line.device.bus.words
        link.post_many([0x30], [1])
        with pytest.raises(BusError, match="0x0030"):
            link.sync()
        link.sync()


def test_a_group_is_no_larger_than_the_frames_of_the_device() -> None:
    configuration = BoardConfiguration(groups=3, group_size=255, base_hz=1000)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=2") as link:
        assert (link.configuration.group_size, link.configuration.usable_group_size) == (255, 60)
        with pytest.raises(DeviceMismatch, match=r"can hold 60 \(of 255: its frames hold no more"):
            link.subscribe(range(61), divisor=1)
        with link.subscribe(range(60), divisor=1) as subscription:
            assert subscription.wait(10)
            assert subscription.drain()[1].shape[1] == 60
    large = replace(configuration, long_frames=True, request_max=1200, reply_max=1200, credit=4096)
    with Board(configuration=large) as board, Link(board.url) as link:
        assert link.configuration.usable_group_size == 255
