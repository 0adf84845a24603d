# SPDX-License-Identifier: BSD-3-Clause
"""pcapng files with the bytes of a link: the part of the format that our captures need.

Source of the layouts: IETF draft-ietf-opsawg-pcapng. Link type USER0 (147); each packet tells its direction
in the option epb_flags. The native core writes the same (`native/src/layer0_driver/capture.cpp`).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, BinaryIO

from unitylink.errors import UnityLinkError
from unitylink.output_file import create_output

if TYPE_CHECKING:
    from typing_extensions import Self

SENT = "sent"
RECEIVED = "received"
LINK_TYPE_USER0 = 147

_SECTION, _INTERFACE, _PACKET = 0x0A0D0D0A, 1, 6
_MAGIC = 0x1A2B3C4D
_END, _COMMENT, _APPLICATION, _RESOLUTION, _FLAGS = 0, 1, 4, 9, 2
_DIRECTIONS = {1: RECEIVED, 2: SENT}
_BLOCK_BYTES_MAX = 1 << 24  # a larger length is an error
_CHUNK_BYTES = 1 << 16


@dataclass(frozen=True)
class Packet:
    """Bytes that went over the wire together.

    `time_s` counts from 1970. `direction` is "sent" (by the PC) or "received".
    """

    time_s: float
    direction: str
    data: bytes
    comment: str = ""


class CaptureTruncated(UnityLinkError):
    """The capture ends within a packet. All packets before it have been returned."""


def read_packets(path: str | Path) -> Iterator[Packet]:
    """Yield the packets of a capture in their order.

    Raises UnityLinkError, which names the byte, if the file is not a capture of a link. Raises
    CaptureTruncated at the end of a capture that was cut off.
    """
    try:
        with open(path, "rb") as stream:
            yield from _packets(stream, str(path))
    except OSError as error:
        raise UnityLinkError(f"{path}: {error.strerror or error}") from error


def _packets(stream: BinaryIO, name: str) -> Iterator[Packet]:
    order = ""
    ticks_per_s: list[float] = []  # one for each interface
    offset = 0
    while head := stream.read(8):
        if len(head) < 8:
            raise CaptureTruncated(f"{name}: cut off at byte {offset}; what stood before it was read")
        if head[:4] == b"\n\r\r\n":
            magic = stream.read(4)
            order = {b"\x4d\x3c\x2b\x1a": "<", b"\x1a\x2b\x3c\x4d": ">"}.get(magic, "")
            if not order:
                raise UnityLinkError(f"{name}: not a pcapng file (byte order mark at byte {offset + 8})")
            ticks_per_s = []
        else:
            magic = b""
        if not order:
            raise UnityLinkError(f"{name}: not a pcapng file; make one with ?trace=FILE on a link's URL")
        kind, length = struct.unpack(order + "II", head)
        if length % 4 or not 12 + len(magic) <= length <= _BLOCK_BYTES_MAX:
            raise UnityLinkError(f"{name}: damaged at byte {offset}: a block of {length} bytes")
        body = magic + stream.read(length - 12 - len(magic))
        tail = stream.read(4)
        if len(body) + len(tail) < length - 8:
            raise CaptureTruncated(f"{name}: cut off at byte {offset}; what stood before it was read")
        if tail != head[4:]:
            raise UnityLinkError(f"{name}: damaged at byte {offset}: the lengths of a block differ")
        try:
            if kind == _INTERFACE:
                ticks_per_s.append(_resolution(order, body, name))
            elif kind == _PACKET:
                yield _packet(order, body, ticks_per_s)
        except (struct.error, IndexError) as error:
            raise UnityLinkError(f"{name}: damaged at byte {offset}: {error}") from error
        offset += length


def _resolution(order: str, body: bytes, name: str) -> float:
    link_type = struct.unpack_from(order + "H", body)[0]
    if link_type != LINK_TYPE_USER0:
        raise UnityLinkError(
            f"{name}: link type {link_type} is not a capture of a link, which is {LINK_TYPE_USER0}"
        )
    code = _options(order, body[8:]).get(_RESOLUTION, b"\x06")[0]
    return 2.0 ** (code & 127) if code & 128 else 10.0**code


def _packet(order: str, body: bytes, ticks_per_s: list[float]) -> Packet:
    interface, high, low, captured, _ = struct.unpack_from(order + "IIIII", body)
    if captured > len(body) - 20:
        raise struct.error(f"a packet of {captured} bytes in a block of {len(body)}")
    options = _options(order, body[20 + (captured + 3) // 4 * 4 :])
    flags = struct.unpack(order + "I", options[_FLAGS])[0] if _FLAGS in options else 0
    return Packet(
        time_s=(high << 32 | low) / ticks_per_s[interface],
        direction=_DIRECTIONS.get(flags & 3, RECEIVED),
        data=body[20 : 20 + captured],
        comment=options.get(_COMMENT, b"").decode("utf-8", "replace"),
    )


def _options(order: str, data: bytes) -> dict[int, bytes]:
    found: dict[int, bytes] = {}
    while len(data) >= 4:
        code, length = struct.unpack_from(order + "HH", data)
        if code == _END:
            break
        found[code] = data[4 : 4 + length]
        data = data[4 + (length + 3) // 4 * 4 :]
    return found


class PcapngWriter:
    """Write packets to a capture, as a context manager. With `force` it replaces an existing file.

        with PcapngWriter("out.pcapng") as writer:
            writer.write(Packet(time_s=0.0, direction="sent", data=b"#RLC\\n"))

    Raises UnityLinkError if the file exists or cannot be written. If it ends early, the file is valid up to
    there.
    """

    def __init__(self, path: str | Path, *, force: bool = False) -> None:
        self.path = path
        self._stream = open(create_output(path, force=force), "wb")  # noqa: SIM115  # closed by close()
        section = struct.pack("<IHHq", _MAGIC, 1, 0, -1) + _option(_APPLICATION, b"unitylink") + _option(_END)
        interface = struct.pack("<HHI", LINK_TYPE_USER0, 0, 0) + _option(_RESOLUTION, b"\x09") + _option(_END)
        self._write(_block(_SECTION, section) + _block(_INTERFACE, interface))

    def write(self, packet: Packet) -> None:
        """Add a packet."""
        ns = round(packet.time_s * 1e9)
        body = struct.pack("<IIIII", 0, ns >> 32, ns & 0xFFFFFFFF, len(packet.data), len(packet.data))
        body += packet.data + bytes(-len(packet.data) % 4)
        body += _option(_FLAGS, struct.pack("<I", 2 if packet.direction == SENT else 1))
        if packet.comment:
            body += _option(_COMMENT, packet.comment.encode("utf-8")[:1000])
        self._write(_block(_PACKET, body + _option(_END)))

    def close(self) -> None:
        """Write what is buffered and close the file."""
        try:
            self._stream.close()
        except OSError as error:
            raise UnityLinkError(f"{self.path}: {error.strerror or error}") from error

    def _write(self, data: bytes) -> None:
        try:
            self._stream.write(data)
        except OSError as error:
            raise UnityLinkError(f"{self.path}: {error.strerror or error}") from error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _option(code: int, value: bytes = b"") -> bytes:
    return struct.pack("<HH", code, len(value)) + value + bytes(-len(value) % 4)


def _block(kind: int, body: bytes) -> bytes:
    return struct.pack("<II", kind, len(body) + 12) + body + struct.pack("<I", len(body) + 12)
