# SPDX-License-Identifier: BSD-3-Clause
"""A small classic device on one end of a socketpair, with hooks for faults. The twin is its model."""

from __future__ import annotations

import contextlib
import re
import socket
import threading
from collections.abc import Callable

REQUEST = re.compile(rb"^([#$])([A-Z]*)(?::([0-9A-F]*))?(?:\*([0-9A-F]{2}))?$")
CONFIGURATION = "01,04,20,02,03e8,02,10,02"


def crc8(data: bytes) -> int:
    remainder = 0
    for byte in data:
        remainder ^= byte
        for _ in range(8):
            remainder = (remainder << 1 ^ 0x107) & 0x1FF if remainder & 0x80 else remainder << 1
    return remainder


def message(head: str, letters: str, data: bytes = b"") -> bytes:
    text = head + letters + (":" + data.hex() if data else "")
    return (text + (f"*{crc8(letters.encode() + data):02x}" if head in "$&" else "") + "\n").encode()


class FakeDevice:
    """8-bit addresses, 32-bit words, 16 addresses a group.

    `intercept(command, data)` may answer in the device's place. Bytes are sent as they are, and b"" is
    silence. None means to go on as usual.
    """

    def __init__(self, *, banner: bytes = b"", configuration: str | None = CONFIGURATION) -> None:
        self.configuration = configuration
        self.memory = {address: 0x40DE0000 | address << 8 | address for address in range(256)}
        self.silent: set[int] = set()
        self.groups: dict[int, list[int]] = {}
        self.rates: dict[int, int] = {}
        self.log: list[str] = []
        self.intercept: Callable[[str, bytes], bytes | None] = lambda command, data: None
        self.host, self._socket = socket.socketpair()
        self._socket.sendall(banner)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def url(self, options: str = "timeout=0.5") -> str:
        """Return the URL to connect to. The link then owns the descriptor."""
        return f"fd:{self.host.detach()}?{options}"

    def send(self, data: bytes) -> None:
        self._socket.sendall(data)

    def publish(self, group: int, head: str = "&") -> None:
        words = [self.memory[address] for address in self.groups[group]]
        data = bytes([group, len(words)]) + b"".join(word.to_bytes(4, "big") for word in words)
        self.send(message(head, "PUB", data))

    def unplug(self) -> None:
        with contextlib.suppress(OSError):  # the host may already have left
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self.unplug()
        self._thread.join()
        self._socket.close()

    def _serve(self) -> None:
        with contextlib.suppress(OSError):  # the host left in the middle of a message
            self._serve_until_end()

    def _serve_until_end(self) -> None:
        buffer = b""
        while chunk := self._socket.recv(4096):
            buffer += chunk
            while b"\n" in buffer:
                line, buffer = buffer.split(b"\n", 1)
                line = line[max(line.rfind(b"#"), line.rfind(b"$"), 0) :]
                if found := REQUEST.match(line):
                    head, command, data, _ = found.groups()
                    decoded = bytes.fromhex((data or b"").decode())
                    reply = self._answer(head.decode(), command.decode(), decoded)
                    self._socket.sendall(reply)

    def _answer(self, head: str, command: str, data: bytes) -> bytes:
        self.log.append(command)
        if (answer := self.intercept(command, data)) is not None:
            return answer
        if command == "RLC" and self.configuration is not None:
            decoded = bytes.fromhex(self.configuration.replace(",", ""))
            tail = f"*{crc8(b'CNF' + decoded):02x}" if head == "$" else ""
            return f"{head}CNF:{self.configuration}{tail}\n".encode()
        if command == "R":
            if data[0] in self.silent:
                return f"{head}S_R:?E_BAT\n".encode()
            return message(head, "S_R", self.memory[data[0]].to_bytes(4, "big"))
        if command == "RM":
            words = b"".join(self.memory[address].to_bytes(4, "big") for address in data[1:])
            return message(head, "S_RM", words)
        if command == "W":
            self.memory[data[0]] = int.from_bytes(data[1:5], "big")
            return message(head, "S_W")
        if command == "WSA":
            self.groups[data[0]] = list(data[2:])
            return message(head, "S_WSA")
        if command == "WSR":
            self.rates[data[0]] = int.from_bytes(data[1:3], "big")
            return message(head, "S_WSR")
        if command in ("EPS", "EPC", "DPS", "WIC"):
            return message(head, "S_" + command)
        return f"{head}?E_ICC\n".encode()
