# SPDX-License-Identifier: BSD-3-Clause
"""Time in steps: it passes only while a call waits, and the same calls give the same bytes."""

from __future__ import annotations

import asyncio
import hashlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from math import sin
from pathlib import Path

import pytest

from unitylink import connect
from unitylink.capture.pcapng import read_packets
from unitylink.cli import main
from unitylink.errors import LinkClosed, UnityLinkError, UrlError, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration, Registers
from unitylink.spec import Spec, compile_text, load

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
TEXT = """
public cart() {
   @position = 0x10: i32 READ(UNIT="mm", PUBLISH(100 Hz));
   @speed = 0x20: i32 WRITE(SAFE=0);
}
"""


class Cart:
    """It moves by `speed` in each step of a millisecond."""

    period_s = 0.001

    def __init__(self) -> None:
        self.times_s: list[float] = []
        self.position = 0

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self._registers = registers

    def step(self, time_s: float) -> None:
        self.times_s.append(time_s)
        self.position += self._registers.signed(0x20)
        self._registers[0x10] = self.position


def cart(protocol: str = "framed", **settings: int) -> Board:
    spec = compile_text(TEXT, "cart.ul").spec
    assert spec is not None
    told = BoardConfiguration.for_spec(spec, protocol=protocol, **settings)
    return Board(spec, configuration=told, plant=Cart(), endpoint="lockstep")


@contextmanager
def driven(options: str = "protocol=framed") -> Iterator[tuple[Link, Board]]:
    protocol = options.rpartition("protocol=")[2]
    with cart(protocol) as board, Link(f"{board.url}?{options}") as link:
        yield link, board


def test_time_stands_still_between_calls() -> None:
    with driven() as (link, board):
        begun_s = link.now_s()
        time.sleep(0.05)
        assert link.now_s() == begun_s
        for _ in range(1000):
            link.step(0.001)
        assert link.now_s() == pytest.approx(begun_s + 1.0, abs=1e-9)
        assert board.time_s == pytest.approx(link.now_s() - 1.0, abs=1e-6)
        assert board.statistics.time_slipped_s == 0


def test_calls_between_two_steps_take_time_but_do_not_add_up() -> None:
    with driven() as (link, board):
        begun_s = link.now_s()
        for _ in range(100):
            before_s = link.now_s()
            link.write(0x20, 3)
            link.read(0x10)
            assert before_s < link.now_s() < before_s + 1e-4
            link.step(0.001)
        assert link.now_s() == pytest.approx(begun_s + 0.1, abs=1e-9)
        assert isinstance(board.plant, Cart)
        assert board.plant.times_s[-1] == pytest.approx(0.1, abs=1e-3)
        assert len(board.plant.times_s) == len(set(board.plant.times_s)) in (100, 101)


def test_sleep_until_a_moment_between_two_nanoseconds() -> None:
    with driven() as (link, _):
        for part_s in (1e-10, 0.3e-9, 1 / 3, 0.1 + 0.2, 1e-3):
            due_s = link.now_s() + part_s
            link.sleep_until(due_s)
            assert due_s <= link.now_s() + 1e-12
        before_s = link.now_s()
        link.sleep_until(0.5)  # long ago
        assert link.now_s() == before_s


def test_another_thread_may_close_a_link_that_waits_for_ever() -> None:
    with driven() as (link, _):
        never = link.subscribe([0x10], on_event=True)
        closing = threading.Timer(0.1, link.close)
        closing.start()
        with pytest.raises(LinkClosed):
            never.wait(1e9)
        closing.join()


@pytest.mark.parametrize("plant", [Cart(), None], ids=["plant", "no plant"])
def test_ctrl_c_ends_a_long_step_and_not_the_plant(plant: Cart | None) -> None:
    spec = compile_text(TEXT, "cart.ul").spec
    with Board(spec, plant=plant, endpoint="lockstep") as board, Link(board.url) as link:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            link.step(1e6 - 1)
        link.step(0.01)
        assert board.error is None and link.now_s() < 1e6


def test_an_hour_of_a_robot_that_stands_takes_no_hour() -> None:
    with Board(endpoint="lockstep") as board, Link(board.url) as link:
        link.step(3600.0)
        assert board.time_s > 3600


def run_of(tmp_path: Path, name: str, protocol: str) -> tuple[list[tuple[object, bytes]], list[object]]:
    """Return the bytes on the wire, and all values with their times."""
    file = tmp_path / name
    seen: list[object] = []
    with driven(f"trace={file}&protocol={protocol}") as (link, _):
        subscription = link.subscribe([0x10, 0x20], divisor=10)
        subscription.on_publish(lambda time_s, words: seen.append((time_s, *words)))
        for turn in range(300):
            link.write(0x20, (turn * 7 % 23 - 11) & 0xFFFFFFFF)
            seen.append((link.now_s(), link.read(0x10)))
            link.step(0.001)
    return [(packet.direction, packet.data) for packet in read_packets(file)], seen


@pytest.mark.parametrize("protocol", ["framed", "classic"])
def test_two_runs_are_equal_byte_for_byte(tmp_path: Path, protocol: str) -> None:
    first = run_of(tmp_path, "first", protocol)
    time.sleep(0.01)
    second = run_of(tmp_path, "second", protocol)
    assert first == second
    assert len(first[1]) > 320  # there are publishes among them
    assert sum(len(sent) for _, sent in first[0]) > 10_000


def digest_of(file: Path, steps: int) -> tuple[str, str]:
    """Drive the SCARA for some steps. Return the digests of all bytes on the wire, and of all values."""
    arm = EXAMPLES / "scara" / "scara.ul"
    values, wire = hashlib.sha256(), hashlib.sha256()
    with connect(f"sim:{arm}?plant=scara&trace={file}", time="lockstep") as link:
        robot = load_spec_objects(load(arm), link)
        joints = [robot[name] for name in ("j1", "j2", "j3", "j4")]
        places = ValueGroup([value for joint in joints for value in (joint["cpos"], joint["spd"])])
        targets = ValueGroup([joint["pos_sp"] for joint in joints])
        ValueGroup([joint["spd_sp"] for joint in joints]).write([20_000, 30_000, 9_000, 90_000])
        for step in range(steps):
            seen = places.snapshot()
            values.update(repr((seen.time_s, *seen.values())).encode())
            targets.write([round(9_000 * sin(step * part)) for part in (0.01, 0.013, 0.02, 0.05)])
            link.step(0.001)
    for packet in read_packets(file):
        wire.update(packet.data)
    file.unlink()
    return wire.hexdigest(), values.hexdigest()


@pytest.mark.parametrize("steps", [2_000, pytest.param(100_000, marks=pytest.mark.long)])
def test_many_steps_of_a_robot_are_equal_byte_for_byte(tmp_path: Path, steps: int) -> None:
    first = digest_of(tmp_path / "wire.pcapng", steps)
    assert first == digest_of(tmp_path / "wire.pcapng", steps) and first[0] != first[1]


def test_publishes_come_at_their_time() -> None:
    with driven() as (link, _):
        subscription = link.subscribe([0x10], divisor=100)
        assert subscription.wait(10.0)
        first_s = link.now_s()
        subscription.drain()
        assert subscription.wait(10.0)
        assert 0 < link.now_s() - first_s < 2.0  # and not after the ten seconds
        assert subscription.lost == subscription.missing == 0


def test_callbacks_are_called_in_steps_by_the_same_thread() -> None:
    with driven() as (link, _):
        threads = set()
        subscription = link.subscribe([0x10], divisor=10)
        subscription.on_publish(lambda *_: threads.add(threading.get_ident()))
        link.read(0x10)
        assert not threads
        link.step(0.5)
        assert threads == {threading.get_ident()}
        assert not any(each.name == "unitylink callbacks" for each in threading.enumerate())


def test_boards_of_a_process_share_the_time() -> None:
    with cart() as left, cart() as right, Link(left.url) as one, Link(right.url) as other:
        one.write(0x20, 1)
        other.write(0x20, 2)
        stamps = other.subscribe([0x10], divisor=100)
        one.step(0.5)
        assert one.now_s() == other.now_s()
        assert left.time_s == pytest.approx(right.time_s, abs=1e-4)
        assert abs(other.read(0x10) - 2 * one.read(0x10)) <= 2
        assert stamps.available > 3  # read although nobody asked this link


def test_boards_that_nothing_came_for_still_keep_their_time() -> None:
    boards = [cart() for _ in range(6)]
    links = [Link(board.url) for board in boards]
    for number, link in enumerate(links):
        link.write(0x20, number)
    for _ in range(50):
        links[3].step(0.01)
        links[3].read(0x10)
    assert {round(board.time_s, 4) for board in boards[1:]} == {round(boards[1].time_s, 4)}
    moved = [link.read(0x10) for link in links]
    for number, place in enumerate(moved):
        assert abs(place - 500 * number) <= number
    for each in (*links, *boards):
        each.close()


def test_a_group_of_two_links_needs_no_thread() -> None:
    threads = set()

    class Seen(Cart):
        def step(self, time_s: float) -> None:
            threads.add(threading.get_ident())
            super().step(time_s)

    spec = compile_text(TEXT, "cart.ul").spec
    assert spec is not None
    with ExitStack() as stack:
        boards = [stack.enter_context(Board(spec, plant=Seen(), endpoint="lockstep")) for _ in range(2)]
        links = [stack.enter_context(Link(board.url)) for board in boards]
        robots = [load_spec_objects(spec, link) for link in links]
        group = ValueGroup({f"{n}.{each.path}": each for n, robot in enumerate(robots) for each in robot})
        for turn in range(20):
            group.write([turn, -turn])
            links[0].step(0.001)
            assert set(group.snapshot()) == {"0.position", "1.position"}
    assert threads == {threading.get_ident()}


def test_what_nobody_reads_makes_the_board_wait_and_is_not_lost() -> None:
    with driven() as (link, board):
        for other in range(3):  # a link that is not read, because its program only steps
            with cart() as silent, Link(silent.url) as deaf:
                publishes = deaf.subscribe([0x10], divisor=1)
                link.step(1.0)
                assert publishes.available > 90, other
                assert publishes.lost == publishes.missing == 0
        assert board.error is None


def test_a_board_cannot_differ_in_time_from_the_others() -> None:
    with Board(endpoint="lockstep"), pytest.raises(UnityLinkError, match="go in steps"):
        Board()
    with Board() as real, pytest.raises(UnityLinkError, match="follow real time"):
        Board(endpoint="lockstep")
    assert real.closed
    with Board(endpoint="lockstep") as board, Link(board.url) as link:
        link.step(0.1)


def test_patience_is_counted_in_the_time_of_the_robot() -> None:
    with driven() as (link, board):
        begun_s = link.now_s()
        never = link.subscribe([0x10], on_event=True)
        assert not never.wait(120.0)
        assert link.now_s() - begun_s == pytest.approx(120.0, abs=1e-3)
        board.hang_up()
        with pytest.raises(LinkClosed):
            link.read(0x10)


def test_the_dead_man_counts_steps() -> None:
    with driven("deadman=0.05&protocol=framed") as (link, board):
        link.write(0x20, 5)
        link.step(10.0)  # the link gives its signs of life
        assert board.registers[0x20] == 5
        link.trip()
        assert board.registers[0x20] == 0


def test_without_a_link_the_dead_man_trips_when_others_step() -> None:
    with cart() as arm, cart() as other, Link(other.url) as clock:
        link = Link(f"{arm.url}?deadman=0.05")
        link.write(0x20, 5)
        link.disown()  # it vanishes, as a program that is killed
        clock.step(0.02)
        assert arm.registers[0x20] == 5
        clock.step(0.2)
        assert arm.registers[0x20] == 0


def test_a_plant_that_raises_ends_and_the_board_goes_on() -> None:
    class Wrong(Cart):
        def step(self, time_s: float) -> None:
            raise ZeroDivisionError("a singular matrix")

    with Board(endpoint="lockstep", plant=Wrong()) as board, Link(board.url) as link:
        link.step(0.01)
        assert "singular" in str(board.error)
        assert link.read(0x10) == 0


def test_a_plant_may_close_its_own_board() -> None:
    class Last(Cart):
        board: Board | None = None

        def step(self, time_s: float) -> None:
            if time_s > 0.005 and self.board is not None:
                self.board.close()

    plant = Last()
    board = Board(endpoint="lockstep", plant=plant)
    with Link(board.url) as link:
        plant.board = board
        with pytest.raises(LinkClosed):
            link.step(0.01)
            link.read(0x10)
    assert board.closed


def test_what_cannot_be_stepped_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "cart.ul"
    spec.write_text(TEXT)
    with Board() as board, Link(board.url) as link, pytest.raises(UnityLinkError, match="time=lockstep"):
        link.step(0.1)
    with pytest.raises(UrlError, match="for virtual boards"):
        connect("tcp://127.0.0.1:1", time="lockstep")
    with pytest.raises(UrlError, match="expected real or lockstep"):
        connect(f"sim:{spec}?time=fast")
    with pytest.raises(UrlError, match="give it once"):
        connect(f"sim:{spec}?time=real", time="lockstep")
    with pytest.raises(UrlError, match="leave out reconnect="):
        connect(f"sim:{spec}?reconnect=1", time="lockstep")
    assert main(["read", f"sim:{spec}?time=lockstep", "position"]) == 1
    assert "a command lets no time pass" in capsys.readouterr().err
    with connect(f"sim:{spec}", time="lockstep") as link:
        for wrong_s in (-1.0, float("nan"), float("inf")):
            with pytest.raises(ValueRangeError, match="a step of"):
                link.step(wrong_s)

        async def ask() -> None:
            await link.read_async(0x10)

        with pytest.raises(UnityLinkError, match="asyncio"):
            asyncio.run(ask())
    with pytest.raises(LinkClosed):
        link.step(0.1)
