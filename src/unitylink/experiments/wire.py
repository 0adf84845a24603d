# SPDX-License-Identifier: BSD-3-Clause
"""A wire that counts and spoils, as a process: `python -m unitylink.experiments.wire PTY`.

Prints the path of its own pty, and carries bytes between that and PTY. A line on standard input each:
"bytes" answers with the bytes to and from the device since last asked, "freeze" keeps all that the device
says, "thaw" lets it through again, "flip" inverts the lowest bit of the middle byte of what it says next.
"""

from __future__ import annotations

import os
import pty
import select
import sys
import tty

_CHUNK = 4096


class Wire:
    """Carries bytes from one descriptor to the other."""

    def __init__(self, host: int, device: int) -> None:
        self.host, self.device = host, device
        self.to_device = self.to_host = 0
        self.frozen = self.flipping = False

    def from_host(self) -> None:
        data = os.read(self.host, _CHUNK)
        self.to_device += len(data)
        os.write(self.device, data)

    def from_device(self) -> None:
        data = bytearray(os.read(self.device, _CHUNK))
        if self.frozen:
            return
        self.to_host += len(data)
        if self.flipping:
            data[len(data) // 2] ^= 1
            self.flipping = False
        os.write(self.host, data)

    def obey(self, command: str) -> str:
        """Do what a line says, and return the answer.

        >>> Wire(0, 1).obey("bytes")
        '0 0'
        """
        if command == "bytes":
            told = f"{self.to_device} {self.to_host}"
            self.to_device = self.to_host = 0
            return told
        if command == "flip":
            self.flipping = True
        elif command in ("freeze", "thaw"):
            self.frozen = command == "freeze"
        else:
            return f"no command {command!r}"
        return "ok"


def main() -> None:
    """Carry until standard input ends."""
    host, own_end = pty.openpty()  # the second stays open, so that a client may come and go
    device = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)
    for descriptor in (own_end, device):
        tty.setraw(descriptor)
    wire = Wire(host, device)
    print(os.ttyname(own_end), flush=True)
    while True:
        ready, _, _ = select.select([host, device, sys.stdin], [], [])
        if sys.stdin in ready:
            line = sys.stdin.readline()
            if not line:
                return
            print(wire.obey(line.strip()), flush=True)
        if host in ready:
            wire.from_host()
        if device in ready:
            wire.from_device()


if __name__ == "__main__":
    main()
