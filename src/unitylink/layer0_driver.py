# SPDX-License-Identifier: BSD-3-Clause
"""Layer 0 used alone: a byte pipe to a device over a serial port, TCP, UDP or an open descriptor.

    from unitylink.layer0_driver import Driver

    with Driver("tcp://127.0.0.1:5555") as driver:
        driver.send(b"#RLC\\n")
        print(driver.receive(timeout_s=1.0))

Nothing is checked, repeated or understood here. The layers above do that.
"""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

from unitylink import _native
from unitylink.errors import LinkTimeout

if TYPE_CHECKING:
    from typing_extensions import Self


class Driver:
    """One open port, made from a link URL. Only the URL's place and `baud` matter here.

    Raises UrlError, LinkNotFound, LinkBusy, LinkTimeout, LinkClosed, and LinkError if a permission is
    missing.
    """

    def __init__(self, url: str, *, timeout_s: float = 1.0) -> None:
        """Open `url`. `timeout_s` limits the connection of TCP."""
        self.url = url
        self._native = _native.open_driver(url, timeout_s)

    def send(self, data: bytes, *, timeout_s: float = 1.0) -> None:
        """Send all of `data`.

        Raises LinkTimeout, which says how much was sent, if the other side does not take all.
        """
        count = self._native.send(data, timeout_s)
        if count < len(data):
            text = f"{self.url} took {count} of {len(data)} bytes in {timeout_s} s"
            raise LinkTimeout(text, elapsed_s=timeout_s)

    def receive(self, *, timeout_s: float = 1.0) -> bytes:
        """Return what has come, after `timeout_s` at the latest.

        It is b"" if nothing has come. Raises LinkClosed at the end.
        """
        return self._native.receive(timeout_s)

    def close(self) -> None:
        """Close the port. Calling it twice does no harm."""
        self._native.close()

    def fileno(self) -> int:
        """Return the descriptor, for select and asyncio. Return -1 after close()."""
        return self._native.descriptor

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
