# SPDX-License-Identifier: BSD-3-Clause
"""The link chooses the protocol and the check of frames, if the URL does not."""

from __future__ import annotations

import select
import socket
import threading
from urllib.parse import urlsplit

import pytest

from unitylink import Link
from unitylink.errors import LinkTimeout
from unitylink.protocol import REQUEST_KIND_HELLO
from unitylink.simulate import Board, BoardConfiguration

HELLO = bytes([REQUEST_KIND_HELLO, 3, 1, 1])  # the 3 is the place of the next zero


@pytest.mark.parametrize(
    ("built", "spoken"), [("framed", "framed"), ("both", "framed"), ("classic", "classic")]
)
def test_what_the_gateware_was_built_with_is_spoken(built: str, spoken: str) -> None:
    with (
        Board(configuration=BoardConfiguration(protocol=built)) as board,
        Link(f"{board.url}?timeout=0.3") as link,
    ):
        assert link.protocol == spoken
        assert bool(link.notice) == (built == "classic")
        link.write(0x10, 5)
        assert link.read(0x10) == 5


@pytest.mark.parametrize("built", ["framed", "both"])
def test_frames_are_found_without_waiting(built: str) -> None:
    """HELLO comes first. Gateware of frames alone does not answer the fence of the classic protocol."""
    with (
        Board(configuration=BoardConfiguration(protocol=built)) as board,
        Link(f"{board.url}?timeout=5") as link,
    ):
        assert (link.protocol, link.statistics().timeouts) == ("framed", 0)


def test_frames_are_found_if_the_first_hello_is_lost() -> None:
    """The fence comes then. It goes unanswered, and HELLO is sent again."""
    ours, relay = socket.socketpair()
    with Board(configuration=BoardConfiguration(protocol="framed"), endpoint="tcp") as board:
        where = urlsplit(board.url)
        with socket.create_connection((where.hostname, where.port)) as there, relay:
            passing = threading.Thread(target=_pass_on_from_the_second_hello, args=(relay, there))
            passing.start()
            with Link(f"fd:{ours.detach()}?timeout=0.1") as link:
                link.write(0x10, 5)
                assert (link.protocol, link.read(0x10)) == ("framed", 5)
            passing.join()


def _pass_on_from_the_second_hello(host: socket.socket, board: socket.socket) -> None:
    hellos = 0
    while ready := select.select([host, board], [], [])[0]:
        for end in ready:
            if not (chunk := end.recv(4096)):
                return
            hellos += chunk.count(HELLO) if end is host else 0
            if hellos > 1:
                (board if end is host else host).sendall(chunk)


def test_a_device_that_answers_in_neither_protocol_gives_the_error_of_the_first_question() -> None:
    ours, theirs = socket.socketpair()
    with theirs, pytest.raises(LinkTimeout, match="the device has never answered"):
        Link(f"fd:{ours.detach()}?timeout=0.05&attempts=1")


@pytest.mark.parametrize("protocol", ["classic", "framed", "auto"])
def test_a_frame_that_an_earlier_host_left_unfinished_is_ended(protocol: str) -> None:
    with Board(endpoint="tcp") as board:
        where = urlsplit(board.url)
        with socket.create_connection((where.hostname, where.port)) as gone:
            gone.sendall(b"\0\x83\1\2")
        with Link(f"{board.url}?protocol={protocol}&timeout=0.3") as link:
            link.write(0x10, 5)
            assert link.read(0x10) == 5


@pytest.mark.parametrize(
    ("endpoint", "long_frames", "check_bytes"), [("fd", True, 3), ("udp", True, 5), ("udp", False, 3)]
)
def test_frames_over_datagrams_carry_the_long_check(
    endpoint: str, long_frames: bool, check_bytes: int
) -> None:
    """This is so if the device supports it. Our gateware does not."""
    configuration = BoardConfiguration(long_frames=long_frames)
    with (
        Board(configuration=configuration, endpoint=endpoint) as board,
        Link(f"{board.url}?timeout=2") as link,
    ):
        before = link.statistics()
        link.read(0x10)
        after = link.statistics()
        if after.requests == before.requests + 1:  # nothing was lost
            assert after.bytes_sent - before.bytes_sent == 1 + (3 + 1) + check_bytes + 1
        link.write_many(range(0x10, 0x40), range(48))
        assert link.read_many(range(0x10, 0x40)).tolist() == list(range(48))


def test_falling_back_is_warned_of(caplog: pytest.LogCaptureFixture) -> None:
    classic = BoardConfiguration(protocol="classic")
    with Board(configuration=classic) as board, Link(f"{board.url}?timeout=0.3") as link:
        assert [record.levelname for record in caplog.records] == ["WARNING"]
        assert link.notice in caplog.text
    caplog.clear()
    with Board(configuration=classic) as board, Link(f"{board.url}?protocol=classic"):
        assert not caplog.records
