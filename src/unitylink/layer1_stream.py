# SPDX-License-Identifier: BSD-3-Clause
"""Layer 1 used alone: the classic ASCII protocol as text, without a port or a clock.

>>> ClassicEncoder(checked=True).encode("R", bytes([0x12]))
b'$R:12*58\\n'
>>> ClassicDecoder(data_bytes=4).feed(b"$S_R:40de1212*2d\\n?f4\\n")
[Reply(head='$', letters='S_R', data=b'@\\xde\\x12\\x12', fields=''), DatalinkError(code=244)]

Hex digits of a device may be upper or lower case. Anything else that does not follow the protocol exactly
gives no value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Union

from unitylink import _native
from unitylink.errors import ValueRangeError
from unitylink.protocol import CRC8_POLYNOMIAL


@dataclass(frozen=True)
class Reply:
    """A whole reply.

    If it has a checksum, it is right. `fields` is the text of a CNF, which has no `data`.
    """

    head: str
    letters: str
    data: bytes
    fields: str = ""


@dataclass(frozen=True)
class Publish:
    """A publish. `count` is the number in its label. `words` are those that it really held."""

    checked: bool
    group: int
    count: int
    words: tuple[int, ...]


@dataclass(frozen=True)
class ApplicationError:
    """The device refused a request, perhaps after a part of the reply. `error` is its E_xxx."""

    head: str
    letters: str
    data: bytes
    error: str


@dataclass(frozen=True)
class DatalinkError:
    """The device could not read a message. `code` is 0xF0 and up."""

    code: int


@dataclass(frozen=True)
class BadMessage:
    """A message that must not be believed. `reason` is "malformed" or "bad_checksum"."""

    head: str
    reason: str


@dataclass(frozen=True)
class Busy:
    """The board serves another program."""


@dataclass(frozen=True)
class Garbage:
    """Bytes that belong to no message."""

    count: int


Event = Union[Reply, Publish, ApplicationError, DatalinkError, BadMessage, Busy, Garbage]


class ClassicEncoder:
    """Converts requests to text.

    `polynomial` is that of the CRC-8. None stands for the byte XOR that some gateware has.
    """

    def __init__(self, *, checked: bool = False, polynomial: int | None = CRC8_POLYNOMIAL) -> None:
        self.checked = checked
        self.polynomial = _byte(polynomial)

    def encode(self, command: str, data: bytes = b"") -> bytes:
        """Return the message of `command` (letters A-Z) with `data`.

        Raises ValueRangeError for other letters.
        """
        if not ((command.isascii() and command.isalpha()) or command == ""):
            raise ValueRangeError(f"a command is made of the letters A to Z, not {command!r}")
        return _native.encode_request(command, data, self.checked, self.polynomial)


class ClassicDecoder:
    """Converts bytes from a device, in any chunks, to events.

    `data_bytes` is the width of its words, or 0 while it is unknown.
    """

    def __init__(self, *, data_bytes: int = 4, polynomial: int | None = CRC8_POLYNOMIAL) -> None:
        if data_bytes not in range(5):
            raise ValueRangeError(f"words have 1 to 4 bytes (0: not known), not {data_bytes}")
        self._native = _native.NativeDecoder(data_bytes, _byte(polynomial))

    def feed(self, data: bytes) -> list[Event]:
        """Return the events that are complete with `data`. They may begin in earlier bytes."""
        return [_event(*event) for event in self._native.feed(data)]


def _byte(polynomial: int | None) -> int | None:
    if polynomial is not None and not 0 < polynomial < 256:
        raise ValueRangeError(f"a CRC-8 polynomial is 1 to 255, not {polynomial}")
    return polynomial


def _event(kind: str, *parts: object) -> Event:
    if kind == "publish":
        return Publish(*parts)  # type: ignore[arg-type]
    if kind == "garbage":
        return Garbage(*parts)  # type: ignore[arg-type]
    head, letters, data, error, code, fields = parts
    if kind == "reply":
        return Reply(str(head), str(letters), data, str(fields))  # type: ignore[arg-type]
    if kind == "application_error":
        return ApplicationError(str(head), str(letters), data, str(error))  # type: ignore[arg-type]
    if kind == "datalink_error":
        return DatalinkError(code)  # type: ignore[arg-type]
    return Busy() if kind == "busy" else BadMessage(str(head), kind)
