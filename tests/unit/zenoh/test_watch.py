# SPDX-License-Identifier: BSD-3-Clause
"""A connection from which nobody reads is ended, and no other one."""

from __future__ import annotations

import ipaddress
import random
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress

import pytest
from unit.zenoh.rig import Gap, free_port, until

from unitylink.zenoh import session
from unitylink.zenoh.session import Network
from unitylink.zenoh_watch import UNREAD_S, Watch, places_of

HOST = "127.0.0.1"


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Watch:
    """A watch that looks only when it is asked to."""
    monkeypatch.setattr(Watch, "_run", lambda self: None)
    return Watch()


def door(stack: ExitStack) -> socket.socket:
    return stack.enter_context(socket.create_server((HOST, 0)))


def place(one: socket.socket) -> str:
    return f"tcp/{HOST}:{one.getsockname()[1]}"


def test_a_connection_from_which_nobody_reads_is_ended(stack: ExitStack, watch: Watch) -> None:
    there = door(stack)
    deaf, reader = (stack.enter_context(socket.create_connection(there.getsockname())) for _ in range(2))
    far, far_reader = (stack.enter_context(there.accept()[0]) for _ in range(2))
    watch.add([place(there)])
    ended = 0
    for at_s in (0.0, 0.5 * UNREAD_S, UNREAD_S):
        for one in (far, far_reader):
            one.send(b"are you there?")
        ended += watch.look(at_s)
        assert len(reader.recv(1)) == 1, "something is left, but one reads"
    assert ended == 1
    far.settimeout(5.0)
    assert far.recv(9) == b""
    reader.send(b"yes")
    assert far_reader.recv(9) == b"yes"
    assert deaf.fileno() != -1, "whoever has it closes it"


def test_a_connection_in_which_nothing_waits_is_let_alone(stack: ExitStack, watch: Watch) -> None:
    there = door(stack)
    quiet = stack.enter_context(socket.create_connection(there.getsockname()))
    far = stack.enter_context(there.accept()[0])
    watch.add([place(there)])
    assert not any(watch.look(float(at_s)) for at_s in range(10))
    far.send(b"yes")
    assert quiet.recv(9) == b"yes"


def test_connections_to_other_places_are_let_alone(stack: ExitStack, watch: Watch) -> None:
    there, other = door(stack), door(stack)
    stack.enter_context(socket.create_connection(there.getsockname()))
    far = stack.enter_context(there.accept()[0])
    far.send(b"are you there?")
    watch.add([place(other)])
    assert not any(watch.look(float(at_s)) for at_s in range(10))


def test_the_thread_looks_by_itself(stack: ExitStack) -> None:
    there = door(stack)
    stack.enter_context(socket.create_connection(there.getsockname()))
    far = stack.enter_context(there.accept()[0])
    far.send(b"are you there?")
    Watch().add([place(there)])
    far.settimeout(10.0)
    assert far.recv(9) == b""


def test_where_locators_lead() -> None:
    some = [f"tcp/{HOST}:1#so_sndbuf=9", "tls/[::1]:2?prio=1", "tcp/[::ffff:10.0.0.7]:3", "udp/10.0.0.7:4"]
    some += ["tcp/no.such.host.invalid:5", "tcp/10.0.0.7", "unixsock-stream/x", ""]
    found = [(HOST, 1), ("::1", 2), ("10.0.0.7", 3)]
    assert places_of(some) == {(ipaddress.ip_address(host), port) for host, port in found}


class Late(Gap):
    """A way whose second connection gets the end of its handshake at a given moment."""

    def __init__(self, port: int, at_s: float) -> None:
        self._at_s, self._begun = at_s, 0
        super().__init__(port)

    def _carry(self, source: socket.socket, target: socket.socket, open_: threading.Event) -> None:
        began_s = time.monotonic()
        back = open_ is self.back
        self._begun += back
        if back and self._begun == 2:
            with suppress(OSError):
                target.sendall(source.recv(65536))  # that the router heard us
                data = source.recv(65536)  # that we are in
                time.sleep(max(0.0, began_s + self._at_s - time.monotonic()))
                target.sendall(data)
        super()._carry(source, target, open_)


@pytest.mark.long
def test_a_session_that_zenoh_leaves_deaf_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """If none is left deaf, Zenoh may have been mended: then zenoh_watch.py can go."""
    monkeypatch.setattr(session, "_OPEN_MS", 100)
    ended: list[int] = []
    look = Watch.look
    monkeypatch.setattr(Watch, "look", lambda self, now_s: ended.append(look(self, now_s)))
    draw, port = random.Random(1), free_port()
    with Network(listen=f"tcp/{HOST}:{port}").opened() as router:
        kept = router.declare_queryable("here", lambda query: query.reply("here", b"yes"))
        for _ in range(200):
            way = Late(port, draw.uniform(0.098, 0.101))
            with Network(connect=f"tcp/{HOST}:{way.port}").opened() as one:
                until(lambda one=one: any(reply.ok for reply in one.get("here", timeout=0.5)))
                way.lose()
                until(lambda way=way: way._begun > 1)
                until(lambda one=one: any(reply.ok for reply in one.get("here", timeout=0.5)))
            way.close()
            if sum(ended) >= 3:
                break
        kept.undeclare()
    assert sum(ended) >= 3
