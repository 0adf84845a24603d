# SPDX-License-Identifier: BSD-3-Clause
"""Ends connections of Zenoh sessions from which nobody reads, so that the sessions connect again.

If the time for an attempt to connect ends just when the attempt succeeds, Zenoh 1.10 keeps the half that
sends. It tells the router that the session lives, and the router refuses each further connection of that
session (MAX_LINKS), for ever. It happens to some of many robots that come back together on a busy machine.

How much a socket has received and what of it waits is known on Linux only. Elsewhere nothing is watched.
"""

from __future__ import annotations

import contextlib
import socket
import struct
import sys
import threading
import time
from collections.abc import Iterable

from unitylink.zenoh_sockets import Place, host_and_port, normal, sockets

LOOK_S = 0.5
UNREAD_S = 1.0  # who is silent for so long is gone for its router, so nothing whole is ended
_ESTABLISHED = 1
_INFO = struct.Struct("=B127xQ")  # of the kernel's tcp_info: tcpi_state, tcpi_bytes_received


class Watch:
    """Looks at the connections of this process to the places that `add` names."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._locators: set[str] = set()  # whose places are not known yet
        self._places: set[Place] = set()
        # Of each socket with something to read: how much was read before, and since when no more.
        self._unread: dict[int, tuple[int, float]] = {}
        self._thread: threading.Thread | None = None

    def add(self, locators: Iterable[str]) -> None:
        """Watch connections to some places from now on. To find them may take long: the thread does it."""
        with self._lock:
            self._locators.update(locators)
            alive = self._thread is not None and self._thread.is_alive()  # not after a fork
            if sys.platform == "linux" and not alive:
                self._thread = threading.Thread(target=self._run, name="zenoh watch", daemon=True)
                self._thread.start()

    def look(self, now_s: float) -> int:
        """Look at all connections. Return how many were ended."""
        with self._lock:
            new, self._locators = self._locators, set()
        self._places |= places_of(new)
        before, self._unread = self._unread, {}
        ended = 0
        for number, one in sockets(set()):
            with one, contextlib.suppress(OSError, struct.error):
                if normal(*one.getpeername()[:2]) not in self._places:
                    continue
                waiting = _waiting(one)
                state, received = _INFO.unpack(
                    one.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, _INFO.size)
                )
                if state != _ESTABLISHED or not waiting:
                    continue
                read = received - waiting
                was, since_s = before.get(number, (-1, now_s))
                self._unread[number] = read, (since_s if was == read else now_s)
                if was == read and now_s - since_s >= UNREAD_S:
                    one.shutdown(socket.SHUT_RDWR)
                    ended += 1
        return ended

    def _run(self) -> None:
        while True:
            time.sleep(LOOK_S)
            self.look(time.monotonic())


def places_of(locators: Iterable[str]) -> set[Place]:
    """Return where locators such as `tcp/arm.lab:7447` lead. One of another kind leads to none."""
    found: set[Place] = set()
    for locator in locators:
        if ends := host_and_port(locator):
            with contextlib.suppress(OSError, ValueError):  # Zenoh says what is wrong with it
                for answer in socket.getaddrinfo(*ends, type=socket.SOCK_STREAM):
                    found.add(normal(str(answer[4][0]), ends[1]))
    return found


def _waiting(one: socket.socket) -> int:
    import fcntl
    import termios

    return int(struct.unpack("i", fcntl.ioctl(one, termios.FIONREAD, b"\0" * 4))[0])


WATCH = Watch()
