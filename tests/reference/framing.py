# SPDX-License-Identifier: BSD-3-Clause
"""Convert bytes to frames and back (docs/protocol.md, section 1)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from unitylink import protocol as p


class NotCobs(ValueError):
    """No COBS encoder could have made these bytes."""


def field(*fields: tuple[int, int]) -> bytes:
    """Return the fields of a payload, most significant byte first: (value, bytes).

    >>> field((1, 2), (0xAB, 1)).hex()
    '0001ab'
    """
    return b"".join(value.to_bytes(size, "big") for value, size in fields)


def crc(polynomial: int, start: int, data: bytes) -> int:
    """Return a reflected CRC without final XOR, computed bit by bit.

    >>> hex(crc(p.FRAME_CRC16_POLYNOMIAL, 0xFFFF, b"123456789"))
    '0x6f91'
    """
    for byte in data:
        start ^= byte
        for _ in range(8):
            start = start >> 1 ^ (polynomial if start & 1 else 0)
    return start


def cobs_encode(payload: bytes) -> bytes:
    """Encode, so that no zero byte is left.

    >>> cobs_encode(b"\\x11\\x00\\x22").hex()
    '02110222'
    """
    encoded = bytearray()
    pieces = payload.split(b"\0")
    for number, piece in enumerate(pieces, 1):
        whole, left = divmod(len(piece), 254)
        for index in range(whole):
            encoded += b"\xff" + piece[254 * index :][:254]
        # After a last block of 254 bytes comes nothing, not even an empty block.
        if left or not whole or number < len(pieces):
            encoded += bytes([left + 1]) + piece[254 * whole :]
    return bytes(encoded)


def cobs_decode(encoded: bytes) -> bytes:
    """Bring the zero bytes back. Raises `NotCobs` if a block is cut short or holds a zero.

    >>> cobs_decode(bytes.fromhex("02110222")).hex()
    '110022'
    """
    if not encoded:
        raise NotCobs("no block")
    payload = bytearray()
    while encoded:
        code = encoded[0]
        block, encoded = encoded[1:code], encoded[code:]
        if code == 0 or len(block) != code - 1 or 0 in block:
            raise NotCobs(f"code {code}")
        payload += block
        if encoded and code < 255:
            payload += b"\0"
    return bytes(payload)


def check_bytes(body: bytes, epoch: int, long: bool) -> bytes:
    """Return the check that follows kind and COBS bytes: seven bits in each byte, the low ones first."""
    if long:
        value, count = crc(p.FRAME_CRC32_POLYNOMIAL, epoch << 16 | epoch, body), p.FRAME_CRC32_BYTES
    else:
        value, count = crc(p.FRAME_CRC16_POLYNOMIAL, epoch, body), p.FRAME_CRC16_BYTES
    return bytes(0x80 | value >> 7 * index & 0x7F for index in range(count))


@dataclass(frozen=True)
class Frame:
    """One frame: its kind and its payload."""

    kind: int
    payload: bytes = b""

    def encode(self, epoch: int = p.FRAME_OPEN_EPOCH, always_long: bool = False) -> bytes:
        """Return the bytes on the wire, with the closing border.

        >>> Frame(p.REQUEST_KIND_HELLO, bytes([1, 1])).encode().hex()
        '80030101fa928300'
        """
        body = bytes([self.kind]) + cobs_encode(self.payload)
        return body + check_bytes(body, epoch, always_long or len(body) > p.FRAME_SHORT_MAX) + b"\0"

    @staticmethod
    def decode(between: bytes, epoch: int, always_long: bool = False) -> Frame | None:
        """Return the frame between two borders, or None if its check, its kind byte or its COBS blocks are
        wrong.
        """
        long = always_long or len(between) > p.FRAME_SHORT_MAX + p.FRAME_CRC16_BYTES
        size = len(between) - (p.FRAME_CRC32_BYTES if long else p.FRAME_CRC16_BYTES)
        body = between[: max(size, 0)]
        if size < 2 or (long and not always_long and size <= p.FRAME_SHORT_MAX) or not body[0] & 0x80:
            return None
        if between[size:] != check_bytes(body, epoch, long):
            return None
        try:
            return Frame(body[0], cobs_decode(body[1:]))
        except NotCobs:
            return None


class Borders:
    """Cuts a stream at its zero bytes, in whatever chunks it comes. Empty pieces are left out."""

    def __init__(self) -> None:
        self._begun = b""

    def feed(self, data: bytes) -> Iterator[bytes]:
        *whole, self._begun = (self._begun + data).split(b"\0")
        return (piece for piece in whole if piece)
