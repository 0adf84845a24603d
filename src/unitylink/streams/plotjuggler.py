# SPDX-License-Identifier: BSD-3-Clause
"""Samples as JSON in UDP packets, which the UDP server of PlotJuggler takes."""

from __future__ import annotations

import logging
import socket
from collections.abc import Sequence
from typing import TYPE_CHECKING

from unitylink.errors import LinkNotFound

from .topic import Batches, Topic, View

if TYPE_CHECKING:
    from unitylink.server.scopes import Rights

MOST_HZ = 1000.0  # packets a second of each topic
_log = logging.getLogger("unitylink.streams")


class PlotJuggler:
    """Sends each sample of what `rights` allow to HOST:PORT. `left_out` counts packets that could not go.

    A packet is `{"timestamp": 1764000000.25, "arm": {"j1": {"angle": 12.5}}}`, with the seconds since 1970.
    Enumerations are numbers, because PlotJuggler draws numbers. Raises LinkNotFound if there is no such host.
    """

    def __init__(self, robot: str, host: str, port: int, rights: Rights) -> None:
        self._robot, self._rights = robot, rights
        self.left_out = 0
        try:
            family, _, _, _, to = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, socket.SOCK_DGRAM)
            self._socket.connect(to)  # so that the kernel tells if nobody listens
        except OSError as error:
            raise LinkNotFound(f"--plotjuggler {host}:{port}: {error.strerror or error}") from error
        self._socket.setblocking(False)
        self._views: dict[Topic, View] = {}

    def begin(self, topics: Sequence[Topic], _: object) -> None:
        self._views = {topic: view for topic in topics if (view := topic.view(self._rights)) is not None}

    def take(self, batches: Batches) -> None:
        for topic, batch in batches.items():
            if (view := self._views.get(topic)) is not None:
                for time_s, row in batch.thinned(MOST_HZ):
                    text = view.text(view.numbers(row))
                    self._send(f'{{"timestamp":{time_s!r},"{self._robot}":{text}}}'.encode())

    def _send(self, packet: bytes) -> None:
        try:
            self._socket.send(packet)
        except OSError as error:  # nobody listens, the buffer is full, or the packet is too long
            if not self.left_out:
                _log.warning("a packet for PlotJuggler could not be sent: %s", error.strerror)
            self.left_out += 1

    def away(self, why: str) -> None:
        """Nothing is sent then, so the curves end."""

    def close(self) -> None:
        self._socket.close()
