# SPDX-License-Identifier: BSD-3-Clause
"""The sockets of servers in Python. They drop a client that takes nothing any more."""

from __future__ import annotations

import socket

from unitylink.errors import UnityLinkError

UNREAD_MS = 4000  # ms after which a client that takes nothing is gone
HANDSHAKE_S = 4.0  # s that the handshake of TLS may take
BUFFER_BYTES = 64 * 1024  # what the kernel keeps for such a client


def listen(host: str, port: int, option: str = "--listen") -> socket.socket:
    """Return a listening socket. Port 0 takes a free one.

    Raises UnityLinkError if that cannot be. It names the `option` that asked for it.
    """
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        opened = socket.socket(family, socket.SOCK_STREAM)
    except OSError as error:
        raise UnityLinkError(f"{option} {host}:{port}: {error.strerror or error}") from error
    try:
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # both are inherited by each connection
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER_BYTES)
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux
            opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNREAD_MS)
        opened.bind((host, port))
        opened.listen(128)
        opened.setblocking(False)
    except OSError as error:
        opened.close()
        raise UnityLinkError(f"{option} {host}:{port}: {error.strerror}; choose another port") from error
    return opened
