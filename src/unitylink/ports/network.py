# SPDX-License-Identifier: BSD-3-Clause
"""Boards on the network: those that answer a broadcast, and named hosts."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import suppress

from .probe import request

PORT = 5555


def broadcast(
    *, port: int = PORT, address: str = "255.255.255.255", wait_s: float = 0.5
) -> Iterator[tuple[str, bytes]]:
    """Ask the local networks for configurations. Yield (udp:// URL, answer) of each board.

    It yields nothing if the machine has no network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        asking.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        try:
            asking.sendto(request(), (address, port))
        except OSError:
            return
        end_s = time.monotonic() + wait_s
        seen = set()
        while (left_s := end_s - time.monotonic()) > 0:
            asking.settimeout(left_s)
            with suppress(OSError):
                answer, (host, from_port) = asking.recvfrom(4096)
                if b"CNF" in answer and (host, from_port) not in seen:
                    seen.add((host, from_port))
                    yield f"udp://{host}:{from_port}", answer
