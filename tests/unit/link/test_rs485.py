# SPDX-License-Identifier: BSD-3-Clause
"""`rs485:` links to three nodes on one emulated pair, each with a twin behind it."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pytest
from unit.link.reconnect_rig import PATIENCE_S, until

from tests.reference.rs485 import ModelNode, Pair, token
from unitylink import DeviceMismatch, LinkBusy, LinkClosed, LinkNotFound, LinkTimeout, UrlError, connect
from unitylink.errors import LinkDown
from unitylink.protocol import RS485_NODES_MAX
from unitylink.simulate import Board

NODES = (1, 2, 3)


def test_any_two_tokens_differ_in_four_bits() -> None:
    """So up to three flipped bits never turn a token into another.

    Two bytes without check bits are no token.
    """
    numbers = [
        int.from_bytes(token(node, poll=poll)[:2], "big")
        for node in range(RS485_NODES_MAX + 1)
        for poll in (False, True)
    ]
    assert min((one ^ other).bit_count() for one, other in itertools.combinations(numbers, 2)) == 4


@pytest.fixture(params=[False, True], ids=["quiet adapter", "adapter that hears itself"])
def pair(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Pair]:
    with ExitStack() as stack:
        nodes = {}
        for number in NODES:
            board = stack.enter_context(Board(endpoint="tcp"))
            host, _, port = board.url.removeprefix("tcp://").rpartition(":")
            nodes[number] = ModelNode(number, (host, int(port)))
        pair = Pair(nodes, tmp_path / "tty", echo=request.param)
        stack.callback(pair.close)
        yield pair


def url(pair: Pair, node: int, more: str = "") -> str:
    return f"rs485:{pair.path}?node={node}&timeout=2&silence=0.2{more}"


def test_an_adapter_that_is_plugged_in_again(tmp_path: Path) -> None:
    """The pair is gone while two of its nodes are in use. Later both links have it back."""
    place = tmp_path / "tty"
    with ExitStack() as stack:
        boards = {number: stack.enter_context(Board(endpoint="tcp")) for number in (1, 2)}

        def plugged() -> Pair:
            host_ports = {n: board.url.removeprefix("tcp://").rpartition(":") for n, board in boards.items()}
            nodes = {n: ModelNode(n, (host, int(port))) for n, (host, _, port) in host_ports.items()}
            return Pair(nodes, place, echo=False)

        pair = plugged()
        links = {n: stack.enter_context(connect(url(pair, n), reconnect=True)) for n in boards}
        for number, link in links.items():
            link.write(0x12, number)
        pair.close()
        for link in links.values():
            until(lambda link=link: link.trouble)
            with pytest.raises(LinkDown):
                link.write(0x12, 9)
        pair = plugged()
        stack.callback(pair.close)
        for number, link in links.items():
            assert link.wait_up(PATIENCE_S)
            assert link.read(0x12) == number, "what was refused was not written"
            link.write(0x12, 10 + number)
            assert boards[number].registers[0x12] == 10 + number


def test_three_nodes_at_once(pair: Pair) -> None:
    with ExitStack() as stack:
        links = {node: stack.enter_context(connect(url(pair, node))) for node in NODES}
        assert {link.protocol for link in links.values()} == {"framed"}

        def work(node: int) -> list[int]:
            link = links[node]
            for number in range(10):
                link.write(0x12, 1000 * node + number)
                assert link.read(0x12) == 1000 * node + number
            link.write_many([0x13, 0x1A] * 30, list(range(60)))
            return link.read_many([0x12, 0x13, 0x1A], atomic=True).tolist()

        with ThreadPoolExecutor() as pool:
            got = list(pool.map(work, NODES))
        assert got == [[1000 * node + 9, 58, 59] for node in NODES]
        subscription = stack.enter_context(links[2].subscribe([0x12, 0x13], divisor=20))
        for _ in range(3):
            assert subscription.wait(30)
            assert set(map(tuple, subscription.drain()[1].tolist())) == {(2009, 58)}
        for link in links.values():
            seen = link.statistics()
            assert (seen.garbage_bytes, seen.checksum_errors, seen.malformed_messages) == (0, 0, 0)
    assert pair.collisions == 0


def test_a_node_that_is_not_there_and_comes(pair: Pair) -> None:
    pair.dead = {2}
    with connect(url(pair, 1)) as first:
        with pytest.raises(LinkTimeout):
            connect(f"rs485:{pair.path}?node=2&timeout=0.05&attempts=2&silence=0.01")
        first.write(0x12, 5)
        pair.dead = set()
        with connect(url(pair, 2)) as second:
            assert (first.read(0x12), second.read(0x12)) == (5, 0)


def test_flipped_bits_lose_no_write_and_reach_no_other_node(pair: Pair) -> None:
    more = "&attempts=50&timeout=0.2&silence=0.02"
    with (
        connect(f"rs485:{pair.path}?node=1{more}") as one,
        connect(f"rs485:{pair.path}?node=3{more}") as three,
    ):
        pair.flip = 61
        for number in range(1, 16):
            one.write(0x12, number, repeat=True)
            three.write(0x13, number, repeat=True)
        pair.flip = 0
        assert (one.read(0x12), one.read(0x13)) == (15, 0)
        assert (three.read(0x12), three.read(0x13)) == (0, 15)
    assert pair.collisions == 0


def test_an_adapter_that_is_pulled_out_ends_all_links(pair: Pair) -> None:
    links = [connect(url(pair, node)) for node in (1, 2)]
    pair.unplug()
    for link in links:
        with pytest.raises(LinkClosed, match="unplugged"):
            link.read(0x12)
        link.close()


def test_one_link_to_a_node_and_one_rate(pair: Pair) -> None:
    with connect(url(pair, 1)) as link:
        with pytest.raises(LinkBusy, match="node 1 on this pair has a link in this program already"):
            connect(url(pair, 1))
        with pytest.raises(DeviceMismatch, match="spoken to at 115200 baud, and 9600 are asked"):
            connect(url(pair, 2, "&baud=9600"))
        with pytest.raises(LinkBusy, match="another program holds it"):
            connect(f"serial:{pair.path}")
        assert link.read(0x12) == 0
    with connect(url(pair, 2, "&baud=9600")) as link:  # the first link has let the port go
        assert link.read(0x12) == 0


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ("rs485:", UrlError, "the device file is missing, as in rs485:/dev/ttyUSB0"),
        ("rs485:/dev/ttyX", UrlError, r"which node\? node=1 to node=63"),
        ("rs485:/dev/ttyX?node=64", UrlError, "node=64 is not a number from 1 to 63"),
        ("rs485:/dev/ttyX?node=0", UrlError, "node=0 is not a number from 1 to 63"),
        ("rs485:/dev/ttyX?node=1&poll=fast", UrlError, "poll=fast is not a time"),
        ("rs485:/dev/ttyX?node=1&protocol=classic", UrlError, "rs485: carries the framed protocol only"),
        ("rs485:/dev/ttyX?node=1&baud=no", UrlError, "baud=no is not a baud rate"),
        ("serial:/dev/ttyX?node=1", UrlError, "no option 'node'"),
        ("rs485:/dev/ttyX?node=1", LinkNotFound, "there is no such port"),
    ],
)
def test_what_cannot_be(wrong: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        connect(wrong)


def test_a_forked_child_leaves_the_pair_to_its_parent(pair: Pair) -> None:
    with connect(url(pair, 1)) as link:
        child = os.fork()
        if not child:
            os._exit(0 if link.closed else 1)
        assert os.waitpid(child, 0)[1] == 0
        assert link.read(0x12) == 0
