# SPDX-License-Identifier: BSD-3-Clause
"""The sockets of a session, which Zenoh opens so that closing them may wait for 10 s.

A session closes the socket of a peer that is silent. If the peer is cut off, what was sent to it last cannot
arrive, and `close` waits for that (SO_LINGER). The threads that receive wait with it: there are two of them
for all peers of a process. So a router with two peers that are cut off served nobody for 10 s, and a client
did not read from its new connection. Zenoh has no setting for it.
"""

from __future__ import annotations

import contextlib
import ipaddress
import os
import re
import socket
import stat
import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import zenoh

_LOCATOR = re.compile(r"(?:tcp|tls)/([^?#]+):(\d+)(?:[?#].*)?")
_NO_LINGER = struct.pack("ii", 0, 0)
_DESCRIPTORS = "/dev/fd"
Place = tuple[ipaddress.IPv4Address | ipaddress.IPv6Address, int]


def close_without_waiting(session: zenoh.Session) -> None:
    """Let each socket of a session, those that come later too, be closed at once.

    The system still sends what was given to it before.
    """
    from zenoh import SampleKind

    seen: set[int] = set()

    def heard(event: zenoh.LinkEvent) -> None:
        if event.kind == SampleKind.PUT:
            relax(event.link.src, event.link.dst, seen)

    session.info.declare_link_events_listener(heard, history=True)


def relax(here: str, there: str, seen: set[int] | None = None) -> int:
    """Change the sockets of this process between two locators. Return how many there are.

    Those in `seen` are left out, and what is found comes to it. So a router with a hundred links looks at the
    new one only.
    """
    found = 0
    for one in sockets_between(here, there, seen):
        with one, contextlib.suppress(OSError):
            one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _NO_LINGER)
            found += 1
    return found


def sockets_between(here: str, there: str, seen: set[int] | None = None) -> Iterator[socket.socket]:
    """Yield a copy of each socket of this process between two locators. The caller closes it.

    `seen` has the numbers of those that were found before. They are left out.
    """
    ends = _end(here), _end(there)
    if None in ends:
        return
    seen = set() if seen is None else seen
    for number, one in sockets(seen):
        mine = False
        with contextlib.suppress(OSError):  # it has no two ends
            mine = (normal(*one.getsockname()[:2]), normal(*one.getpeername()[:2])) == ends
        if not mine:
            one.close()
            continue
        seen.add(number)
        yield one


def sockets(seen: set[int]) -> Iterator[tuple[int, socket.socket]]:
    """Yield a copy of each TCP socket of this process that is not in `seen`, and its number.

    The caller closes it. `seen` forgets those that are gone. The number is that of the socket, not of its
    descriptor, so a later socket has another one.
    """
    present: set[int] = set()
    try:
        names = os.listdir(_DESCRIPTORS)
    except OSError:  # a system without this folder, such as Windows
        return
    for name in names:
        with contextlib.suppress(OSError):  # it is closed meanwhile
            about = os.fstat(int(name))
            present.add(about.st_ino)
            if not stat.S_ISSOCK(about.st_mode) or about.st_ino in seen:
                continue
            one = socket.socket(fileno=os.dup(int(name)))
            if one.family in {socket.AF_INET, socket.AF_INET6} and one.type == socket.SOCK_STREAM:
                yield about.st_ino, one
            else:
                one.close()
    seen &= present


def normal(host: str, port: int) -> Place:
    """Return a place in one form: without the interface, and IPv4 as such."""
    address = ipaddress.ip_address(host.partition("%")[0])
    return (getattr(address, "ipv4_mapped", None) or address), port


def host_and_port(locator: str) -> tuple[str, int] | None:
    """Return host and port of a locator such as `tcp/arm.lab:7447`. None: it is not of TCP."""
    parts = _LOCATOR.fullmatch(locator)
    return (parts[1].strip("[]"), int(parts[2])) if parts else None


def _end(locator: str) -> Place | None:
    """Return address and port of a locator. None: it is not of TCP, or has a name."""
    try:
        return normal(*ends) if (ends := host_and_port(locator)) else None
    except ValueError:
        return None
