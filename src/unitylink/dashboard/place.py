# SPDX-License-Identifier: BSD-3-Clause
"""Where a dashboard is served, and by which names browsers may reach it."""

from __future__ import annotations

import ipaddress
import socket
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    from unitylink.server.tls_files import TlsFiles

EVERY_ADDRESS = ("0.0.0.0", "::")


@dataclass(frozen=True)
class Place:
    """An address to listen on. Port 0 takes a free one.

    `names` are further names of this machine, as URLs have them. With `tls` all is encrypted.

    >>> Place().scheme, Place("192.168.1.7", 80).exposed
    ('http', True)
    """

    host: str = "127.0.0.1"
    port: int = 0
    names: tuple[str, ...] = ()
    tls: TlsFiles | None = None
    option: str = field(default="--listen", repr=False)  # of the command line, for errors

    @property
    def scheme(self) -> str:
        return "https" if self.tls else "http"

    @property
    def exposed(self) -> bool:
        """Whether other machines reach it."""
        return not is_loopback(self.host)

    def url(self, port: int) -> str:
        """Return the URL, with the port that was taken."""
        host = "localhost" if self.host in EVERY_ADDRESS else self.host
        return f"{self.scheme}://{written(host)}:{port}"

    def hosts(self, port: int) -> Iterator[str]:
        """Yield what the header Host of a request may say."""
        names = {self.host, *self.names}
        if not self.exposed or self.host in EVERY_ADDRESS:
            names |= {"localhost", "127.0.0.1", "::1"}
        if self.host in EVERY_ADDRESS:
            names.add(socket.gethostname())
        standard = {"http": 80, "https": 443}[self.scheme]
        for name in names:
            yield f"{written(name)}:{port}"
            if port == standard:
                yield written(name)


def read_place(
    listen: str,
    names: tuple[str, ...] = (),
    tls: TlsFiles | None = None,
    *,
    option: str = "--listen",
) -> Place:
    """Return the place that `[HOST:]PORT` means.

    Raises UnityLinkError, which names the `option`, if it means none.

    >>> read_place("8080"), read_place("[::1]:0").host
    (Place(host='127.0.0.1', port=8080, names=(), tls=None), '::1')
    """
    host, _, port = listen.rpartition(":")
    if not (port.isascii() and port.isdecimal()) or int(port) > 65535:
        raise UnityLinkError(f"{option} {listen}: expected [HOST:]PORT with a port from 0 to 65535")
    return Place(host.strip("[]") or "127.0.0.1", int(port), names, tls, option)


def is_loopback(host: str) -> bool:
    """Tell whether only this machine reaches an address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def written(host: str) -> str:
    """Return a host as URLs have it.

    >>> written("::1")
    '[::1]'
    """
    return f"[{host}]" if ":" in host else host
