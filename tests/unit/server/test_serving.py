# SPDX-License-Identifier: BSD-3-Clause
"""A server in front of a virtual board: what its clients can do, and what they cannot."""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.unit.server.served import REFUSED, Served, arm, served
from unitylink import Link
from unitylink.errors import (
    AccessRefused,
    BusError,
    DeadManTripped,
    DeviceMismatch,
    LeaseHeld,
    LinkBusy,
    LinkClosed,
    LinkNotFound,
    UrlError,
    ValueRangeError,
)
from unitylink.layer2_message import Subscription
from unitylink.server import serving
from unitylink.server.audit import Audit
from unitylink.server.metrics import write_metrics
from unitylink.server.robot import Robot
from unitylink.server.serving import Server
from unitylink.server.tokens import Tokens
from unitylink.simulate import Board, BoardConfiguration


@pytest.fixture(scope="module")
def one() -> Iterator[Served]:
    with served() as all_of_it:
        yield all_of_it


def until(check: object, patience_s: float = 10.0) -> None:
    end = time.monotonic() + patience_s
    while not check():  # type: ignore[operator]
        assert time.monotonic() < end, "it does not happen"
        time.sleep(0.005)


def test_two_clients_write_and_read(one: Served) -> None:
    with one.link() as ana, one.link() as ben:
        ana.write(0x1A, 5)
        assert ben.read(0x1A) == 5 == one.board.registers[0x1A]
        ben.write(0x1B, 6)
        assert ana.read_many([0x1A, 0x1B], atomic=True).tolist() == [5, 6]


def test_one_client_writes_a_part_at_a_time(one: Served) -> None:
    with one.link() as ben:
        with one.link() as ana:
            ana.write(0x1A, 5)
            for refused in (lambda: ben.write(0x1A, 6), lambda: ben.write_many([0x1B, 0x1A], [1, 6])):
                with pytest.raises(LeaseHeld, match="another client has the write lease"):
                    refused()
            ben.post(0x1A, 6)
            with pytest.raises(BusError):
                ben.sync()
            held = one.robot.report()["leases"][-1]
            assert (held["part"], held["holder"], held["ending"]) == ("target", "all", "")
            ana.write(0x1A, 7)
        until(lambda: written(ben, 0x1B, 8) and written(ben, 0x1A, 8))  # she has closed her link
        assert one.board.registers[0x1A] == 8


def test_the_outputs_of_a_dead_holder_are_safe_before_another_writes(one: Served) -> None:
    with one.link() as ben:
        ana = one.link()
        ana.write(0x1B, 9)
        ana.disown()  # its connection ends without a farewell
        until(lambda: one.board.registers[0x1B] == 0)
        until(lambda: written(ben, 0x1B, 3))
        assert [entry["event"] for entry in map(json.loads, one.lines)][-4:].count("safe") == 1


def written(link: Link, address: int, value: int) -> bool:
    try:
        link.write(address, value)
    except LeaseHeld:
        return False
    return True


def test_everything_that_a_framed_link_can_do(one: Served) -> None:
    with one.link() as link:
        link.write_many([0x40, 0x41, 0x42], [1, 2, 3])
        with link.batch(atomic=True) as batch:
            batch.write(0x43, 0xF0)
            batch.add(0x40, 9)
            read = batch.read(0x40)
        assert read.value == 10
        assert link.exchange(writes=[(0x44, 4)], reads=[0x44, 0x41], atomic=True).tolist() == [4, 2]
        with link.exchange_group([(0x45, 2), (0x46, 4)], [(0x45, 4), (0x41, 1)]) as group:
            assert group.exchange([0x1234, 7]).tolist() == [0x1234, 2]
        health = link.health()
        assert health is not None and health.frames > 0


def test_posts_arrive_in_order_and_their_failures_are_told(one: Served) -> None:
    with one.link() as link:
        link.post_many([0x47] * 300, list(range(300)))
        link.sync()
        assert one.board.registers[0x47] == 299
        for address in (0x48, REFUSED, 0x49):
            link.post(address, 8)
        with pytest.raises(BusError, match="1 post was refused"):
            link.sync()
        assert one.board.registers[0x48] == 8 == one.board.registers[0x49]


def test_a_read_token_reads_only(one: Served) -> None:
    with one.link("looks") as link:
        assert link.read(0x50) == 0
        for refused in (lambda: link.write(0x1A, 1), lambda: link.write_many([0x1A, 0x1B], [1, 2]), link.arm):
            with pytest.raises(AccessRefused, match="not_allowed"):
                refused()
        with pytest.raises(AccessRefused):
            link.set_dead_man(1)
        assert link.read(0x50) == 0  # the link goes on


def test_a_scope_is_a_range_of_addresses(one: Served) -> None:
    with one.link("moves") as link:
        link.write(0x1A, 3)
        with pytest.raises(AccessRefused):
            link.write(0x1B, 3)
        with pytest.raises(AccessRefused):
            link.write_many([0x1A, 0x1B], [8, 8])
        assert one.board.registers[0x1A] == 3


@pytest.mark.parametrize(
    ("token", "name", "error", "words"),
    [
        ("wrong", "arm", AccessRefused, "the token is wrong"),
        ("", "arm", AccessRefused, "the token is missing"),
        ("all", "leg", LinkNotFound, "no board 'leg'; there are: arm"),
        ("two words", "arm", AccessRefused, "not one word"),
    ],
)
def test_who_is_not_let_in(one: Served, token: str, name: str, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        one.link(token, name=name)


def test_a_token_from_a_file(one: Served, tmp_path: Path) -> None:
    file = tmp_path / "mine"
    file.write_text("looks\n")
    with one.link("wrong", f"&token_file={file}") as link:
        assert link.read(0x50) == 0
    file.write_text("\n")
    with pytest.raises(LinkNotFound, match="has no token"):
        one.link("all", f"&token_file={file}")


def test_a_server_with_one_board_needs_no_name(one: Served) -> None:
    with one.link(name="") as link:
        assert link.read(0x50) == 0


def test_the_scheme_speaks_frames_only(one: Served) -> None:
    with pytest.raises(UrlError, match="framed protocol only"):
        one.link(options="&protocol=classic")


def test_errors_of_the_board_reach_the_client(one: Served) -> None:
    with one.link() as link:
        for asked in (lambda: link.read(REFUSED), lambda: link.write(REFUSED, 1)):
            with pytest.raises(BusError, match=f"0x{REFUSED:02x}"):
                asked()
        with pytest.raises(BusError, match="refused"):
            link.write_many([0x40, REFUSED, 0x41], [7, 7, 7])
        assert one.board.registers[0x40] == 7


def test_equal_groups_are_one_group_of_the_board(one: Served) -> None:
    with one.link() as ana, one.link() as ben:
        with ana.subscribe([0x12, 0x13], divisor=10) as hers, ben.subscribe([0x12, 0x13], divisor=10) as his:
            assert one.robot.report()["groups"] == 1
            before = one.robot.report()["statistics"]["publishes"]
            assert hers.wait(5) and his.wait(5)
            until(lambda: hers.available >= 5 and his.available >= 5)
            times, words = hers.drain()
            assert words.shape[1] == 2 and hers.missing == 0 == his.missing
            assert list(times) == sorted(times)
            sent = one.robot.report()["statistics"]["publishes"] - before
            assert sent <= max(len(times), his.available) + 50
            with ana.subscribe([0x12], divisor=10):
                assert one.robot.report()["groups"] == 2
        until(lambda: one.robot.report()["groups"] == 0)


@pytest.mark.parametrize("first", ["client", "program"])
def test_a_group_is_shared_with_a_program_that_serves_the_board(one: Served, first: str) -> None:
    """A bridge to another network subscribes at the link of the server itself."""

    def groups() -> int:
        count: int = one.robot.report()["groups"]
        return count

    link = one.robot.board_link()
    came: list[tuple[int, ...]] = []
    with one.link() as ana:
        begins, follows = (ana, link) if first == "client" else (link, ana)
        goes, stays = begins.subscribe([0x12], divisor=10), follows.subscribe([0x12], divisor=10)
        ours, hers = (stays, goes) if first == "client" else (goes, stays)
        assert groups() == 1
        with link.subscribe([0x12], divisor=10) as another:  # has a ring of its own
            assert groups() == 2 and another.wait(5)
        ours.on_publish(lambda time_s, words: came.append(words))
        until(lambda: len(came) > 3 and hers.available > 3)
        goes.close()
        assert groups() == 1
        came.clear()
        hers.drain()
        until(lambda: len(came) > 3 if stays is ours else hers.available > 3)
        stays.close()
        until(lambda: groups() == 0)
        assert hers.missing == hers.lost == ours.missing == ours.lost == link.statistics().overruns == 0
    with link.subscribe([0x12], divisor=10) as alone:  # nobody else is there, so its own thread reads
        assert alone.wait(5)


def test_a_program_ends_a_subscription_that_a_client_shares(one: Served) -> None:
    """For the program it has ended: nothing waits, and the next subscription is another one."""
    link = one.robot.board_link()

    async def count(over: Subscription) -> int:
        return len([publish async for publish in over])

    with one.link() as ana, ana.subscribe([0x12], divisor=10):
        ours, waited = link.subscribe([0x12], divisor=10), link.subscribe([0x13], divisor=60_000)
        with ana.subscribe([0x13], divisor=60_000), ThreadPoolExecutor() as threads:
            assert ours.wait(5)
            counted = threads.submit(asyncio.run, count(ours))
            forlorn = threads.submit(waited.wait, 60)
            until(lambda: ours.available == 0)
            assert one.robot.report()["groups"] == 2
            waited.close()
            ours.close()
            assert counted.result(10) > 0
            with pytest.raises(LinkClosed, match="the subscription is closed"):
                forlorn.result(10)
        with link.subscribe([0x12], divisor=10) as next_one:
            assert next_one.wait(5) and ours.available == 0 == len(ours.drain()[0])
            ours.close()
            next_one.drain()
            assert next_one.wait(5)


def test_a_shared_subscription_of_a_program_is_checked_as_any_other(one: Served) -> None:
    link = one.robot.board_link()
    with one.link() as ana, ana.subscribe([REFUSED], divisor=10, verify=False):
        for ring in (0, 1 << 30):
            with pytest.raises(ValueRangeError, match=f"a ring of {ring} publishes; 1 to "):
                link.subscribe([REFUSED], divisor=10, verify=False, ring=ring)
        with pytest.raises(BusError, match="every address is read once before it is published"):
            link.subscribe([REFUSED], divisor=10)
        with link.subscribe([REFUSED], divisor=10, verify=False):
            assert one.robot.report()["groups"] == 1


def test_a_board_without_a_free_group_says_so(one: Served) -> None:
    with one.link() as ana, one.link() as ben:
        held = [ana.subscribe([0x12 + n], divisor=100) for n in range(ana.configuration.groups)]
        with pytest.raises(DeviceMismatch):
            ana.subscribe([0x70], divisor=100)
        with pytest.raises(Exception, match=r"no_group|no group"):
            ben.subscribe([0x71], divisor=100)
        ben.subscribe([0x12], divisor=100).close()  # an equal one is shared
        for subscription in held:
            subscription.close()


def test_the_dead_man_of_one_client_is_not_fed_by_another(one: Served) -> None:
    with one.link() as busy, one.link() as other:
        other.write(0x1B, 77)
        quiet = socket_of(one)
        quiet.close()
        other.set_dead_man(0.2)
        freeze(other)
        until(lambda: busy.dead_man().tripped)
        assert one.board.registers[0x1B] == 0
        until(lambda: refused_by_dead_man(busy))  # as soon as the lease of the dead one is free
        busy.arm()
        busy.write(0x1B, 1)
        assert one.board.registers[0x1B] == 1


def refused_by_dead_man(link: Link) -> bool:
    try:
        written(link, 0x1B, 1)
    except DeadManTripped:
        return True
    return False


def test_a_board_that_trips_by_itself_is_armed_at_once() -> None:
    """A tick of this board is so short that it trips before the server does it."""
    configuration = BoardConfiguration.for_spec(arm(), base_hz=10_000)
    with (
        served(Board(arm(), configuration=configuration, endpoint="tcp")) as one,
        one.link() as ana,
        one.link() as eva,
    ):
        for number in range(1, 6):
            ana.write(0x1A, number)
            eva.trip()
            with pytest.raises(DeadManTripped):
                ana.write(0x1A, 60)
            eva.arm()
            ana.write(0x1A, number)
            assert one.board.registers[0x1A] == number
            assert not eva.dead_man().running


def test_what_is_no_login_is_turned_away(one: Served) -> None:
    for said in (
        b"GET / HTTP/1.1\r\n\r\n",
        b"\0\x80\x03\x01\x01\n",
        b"x" * 600,
        b"unitylink-serve 1 arm all\nmore",
    ):
        with socket_of(one) as caller:
            caller.sendall(said)
            told = b""
            with contextlib.suppress(ConnectionResetError):  # the rest of what it said was not read
                while piece := caller.recv(1000):
                    told += piece
            assert not told.startswith(b"admitted")
    with pytest.raises(LinkClosed):
        Link(f"tcp://{one.server.place}?timeout=0.3&protocol=framed")


def test_a_server_without_its_port_touches_no_board(one: Served) -> None:
    host, _, port = one.server.place.rpartition(":")
    tokens = Tokens(())
    robot = Robot("arm", "tcp://127.0.0.1:1", arm(), tokens, Audit(one.lines.append))
    with pytest.raises(LinkBusy, match="another program has this port"):
        Server([robot], tokens, Audit(one.lines.append), host, int(port))
    robot.close()
    assert not robot.opened.is_set() and robot.away


def test_the_last_places_are_for_users_who_have_none(one: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    until(lambda: one.robot.connected == 0)
    monkeypatch.setattr(serving, "CLIENTS_MAX", 3)
    monkeypatch.setattr(serving, "CLIENTS_KEPT", 1)
    with one.link("looks"), one.link("looks"):
        with pytest.raises(LinkBusy, match="the last 1 places are for users who have no connection"):
            one.link("looks")
        with one.link("all"), pytest.raises(LinkBusy, match="3 clients are connected, which is all"):
            one.link("part")


def test_a_log_that_cannot_be_written_stops_nobody() -> None:
    class Full(list[str]):
        def append(self, line: str) -> None:
            raise OSError(28, "No space left on device")

    with served(lines=Full()) as one, one.link() as link:
        link.write(0x1A, 5)
        assert one.board.registers[0x1A] == 5
        assert one.server.report()["log_lines_lost"] >= 3  # up, login, lease


def test_the_metrics_name_each_client(one: Served, tmp_path: Path) -> None:
    with one.link("looks") as link:
        link.read(0x50)
        write_metrics(str(tmp_path / "serve.prom"), one.server.report())
    text = (tmp_path / "serve.prom").read_text()
    assert 'unitylink_board_up{board="arm"} 1' in text
    assert re.search(r'unitylink_client_requests_total\{board="arm",user="looks",client="\d+"\} [1-9]', text)
    names = [line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")]
    assert len(names) == len(set(names)) and list(tmp_path.iterdir()) == [tmp_path / "serve.prom"]


def test_the_audit_log_names_who_came(one: Served) -> None:
    with one.link("looks"):
        pass
    said = [json.loads(line) for line in one.lines]
    assert any({"user": "looks", "event": "login", "robot": "arm"}.items() <= entry.items() for entry in said)
    assert all(entry.get("token") != "all" for entry in said)


@contextlib.contextmanager
def logged_in(one: Served, token: str = "all") -> Iterator[socket.socket]:
    """Yield a socket behind the login, for bytes of one's own."""
    with socket_of(one) as bare:
        bare.sendall(f"unitylink-serve 1 arm {token}\n".encode())
        assert bare.recv(1000).startswith(b"admitted")
        yield bare


def socket_of(one: Served) -> socket.socket:
    host, port = one.server.place.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=10)


def freeze(link: Link) -> None:
    """Let a link give no more signs of life, as if its program hung, while its connection stays open."""
    link.watch_program(0.01)
