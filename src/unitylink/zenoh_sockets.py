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

_LOCATOR = re.compile(r"(?:tcp|tls)/\[?([0-9A-Fa-f.:]+)\]?:(\d+)(?:[?#].*)?")
_NO_LINGER = struct.pack("ii", 0, 0)
_DESCRIPTORS = "/dev/fd"
_End = tuple[ipaddress.IPv4Address | ipaddress.IPv6Address, int]


def close_without_waiting(session: zenoh.Session) -> None:
    """Let each socket of a session, those that come later too, be closed at once.

    The system still sends what was given to it before.
    """
    session.info.declare_link_events_listener(_heard, history=True)


def _heard(event: zenoh.LinkEvent) -> None:
    import zenoh

    if event.kind == zenoh.SampleKind.PUT:
        relax(event.link.src, event.link.dst)


def relax(here: str, there: str) -> int:
    """Change the sockets of this process between two locators. Return how many there are."""
    found = 0
    for one in sockets_between(here, there):
        with one, contextlib.suppress(OSError):
            one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _NO_LINGER)
            found += 1
    return found


def sockets_between(here: str, there: str) -> Iterator[socket.socket]:
    """Yield a copy of each socket of this process between two locators. The caller closes it."""
    ends = _end(here), _end(there)
    if None in ends:
        return
    try:
        names = os.listdir(_DESCRIPTORS)
    except OSError:  # a system without this folder, such as Windows: its sockets stay as they are
        return
    for name in names:
        with contextlib.suppress(OSError):  # it is closed meanwhile, or is no socket with two ends
            if not stat.S_ISSOCK(os.fstat(int(name)).st_mode):
                continue
            one = socket.socket(fileno=os.dup(int(name)))
            try:
                inside = one.family in {socket.AF_INET, socket.AF_INET6}
                mine = inside and (_place(one.getsockname()), _place(one.getpeername())) == ends
            except OSError:
                mine = False
            if mine:
                yield one
            else:
                one.close()


def _end(locator: str) -> _End | None:
    """Return address and port of a locator. None: it is not of TCP."""
    parts = _LOCATOR.fullmatch(locator)
    if parts is None:
        return None
    try:
        return _place((parts[1], int(parts[2])))
    except ValueError:
        return None


def _place(name: tuple[str, int] | tuple[str, int, int, int]) -> _End:
    address = ipaddress.ip_address(name[0].partition("%")[0])
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address), name[1]
