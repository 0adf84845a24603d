# SPDX-License-Identifier: BSD-3-Clause
"""A peer that is cut off holds up nobody: its socket is closed without waiting."""

from __future__ import annotations

import socket
import struct
from contextlib import ExitStack

import pytest
from unit.zenoh.rig import free_port, until

from unitylink.ros.zenoh_session import RosSession
from unitylink.zenoh.session import Network
from unitylink.zenoh_sockets import relax, sockets_between


def lingers(one: socket.socket) -> bool:
    return bool(struct.unpack("ii", one.getsockopt(socket.SOL_SOCKET, socket.SO_LINGER, 8))[0])


@pytest.mark.parametrize(("host", "form"), [("127.0.0.1", "tcp/{}:{}"), ("::1", "tls/[{}]:{}?prio=1-2")])
def test_only_the_socket_between_two_places_is_changed(host: str, form: str) -> None:
    with ExitStack() as stack:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        door = stack.enter_context(socket.create_server((host, 0), family=family))
        pairs = []
        for _ in range(2):
            near = stack.enter_context(socket.create_connection(door.getsockname()[:2]))
            pairs.append((near, stack.enter_context(door.accept()[0])))
        for one in (end for pair in pairs for end in pair):
            one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 10))
        (near, far), others = pairs[0], pairs[1]
        here, there = (form.format(*end.getsockname()[:2]) for end in (near, far))
        assert relax(here, there) == 1
        assert not lingers(near) and all(map(lingers, (far, *others)))
        near.send(b"it is open")
        assert far.recv(99) == b"it is open"


def test_a_socket_that_was_seen_is_left_out_until_its_descriptor_is_that_of_another() -> None:
    with socket.create_server(("127.0.0.1", 0)) as door:
        seen: set[int] = set()
        found = []
        for _ in range(3):
            with socket.create_connection(door.getsockname()) as near, door.accept()[0]:
                here, there = (f"tcp/127.0.0.1:{end[1]}" for end in (near.getsockname(), near.getpeername()))
                found += [relax(here, there, seen), relax(here, there, seen)]
                assert len(seen) == 1, "those that are closed are forgotten"
        assert found == [1, 0] * 3


@pytest.mark.parametrize(
    "place", ["udp/127.0.0.1:7447", "tcp/somewhere:7447", "tcp/1.2.3.4.5:6", "unixsock/x"]
)
def test_other_places_have_no_such_socket(place: str) -> None:
    assert relax(place, "tcp/127.0.0.1:7447") == 0


def test_each_session_is_so() -> None:
    """Zenoh opens the sockets. That they would wait is a fact of its version, and not asked here."""
    port = free_port()
    ros = RosSession({"ZENOH_CONFIG_OVERRIDE": f'connect/endpoints=["tcp/localhost:{port}"]'})
    place = f"tcp/127.0.0.1:{port}"
    with Network(listen=place).opened() as router:
        for network in (Network(connect=place), ros):
            with network.opened() as session:
                for link in (until(router.info.links)[0], until(session.info.links)[0]):
                    with ExitStack() as stack:
                        some = [stack.enter_context(one) for one in sockets_between(link.src, link.dst)]
                        until(lambda some=some: some and not any(map(lingers, some)))
            until(lambda: not router.info.links())


def test_a_system_without_the_folder_of_descriptors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unitylink.zenoh_sockets._DESCRIPTORS", "/dev/none")
    assert relax("tcp/127.0.0.1:1", "tcp/127.0.0.1:2") == 0
