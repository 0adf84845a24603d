# SPDX-License-Identifier: BSD-3-Clause
"""The check of a TosNet packet: CRC-8 with the polynomial x^8 + x^6 + x^5 + x^2 + 1."""

from __future__ import annotations

from collections.abc import Iterable

POLYNOMIAL = 0x65


def crc8(data: Iterable[int]) -> int:
    """Return the check. It starts with 0, takes the top bit first, and ends without an XOR.

    >>> hex(crc8(b"123456789"))
    '0xdf'
    """
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ POLYNOMIAL if crc & 0x80 else crc << 1) & 0xFF
    return crc


def checked(data: Iterable[int]) -> bytes:
    """Return bytes with their check behind them."""
    text = bytes(data)
    return text + bytes([crc8(text)])


def poisoned(packet: Iterable[int]) -> bytes:
    """Return a packet as a node forwards it that has received it broken: with an inverted check."""
    text = bytes(packet)[:-1]
    return text + bytes([crc8(text) ^ 0xFF])
