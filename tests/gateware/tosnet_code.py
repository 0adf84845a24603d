# SPDX-License-Identifier: BSD-3-Clause
"""The line code of TosNet's wire: 8b10b. A symbol is ten bits, with `a`, the first on the line, in bit 0."""

from __future__ import annotations

import re
from dataclasses import dataclass

# The published tables, in the order of the line (abcdei and fghj), behind a running disparity of -1.
_SIX = re.findall(
    "[01]{6}",
    """
    100111 011101 101101 110001 110101 101001 011001 111000 111001 100101 010101 110100 001101 101100 011100
    010111 011011 100011 010011 110010 001011 101010 011010 111010 110011 100110 010110 110110 001110 101110
    011110 101011
    """,
)
_FOUR = ["1011", "1001", "0101", "1100", "1101", "1010", "0110", "1110"]
_FOUR_OF_K = ["1011", "0110", "1010", "1100", "1101", "0101", "1001", "0111"]
_SIX_OF_K28 = "001111"
_ALTERNATE = "0111"  # instead of the last of _FOUR, where five equal bits in a row would become six
_ALTERNATE_FOR = {-1: (17, 18, 20), 1: (11, 13, 14)}

K28_1 = 0x3C  # the line at rest
K28_5 = 0xBC  # the start of a packet
CONTROLS = tuple(28 | y << 5 for y in range(8)) + tuple(x | 7 << 5 for x in (23, 27, 29, 30))
START = -1  # running disparity


@dataclass(frozen=True)
class Character:
    """What a symbol says: a data byte, or a control character (K)."""

    byte: int
    control: bool = False


def encode(byte: int, disparity: int, *, control: bool = False) -> tuple[int, int]:
    """Return the symbol of a byte, and the running disparity behind it.

    >>> encode(K28_5, -1, control=True), encode(K28_5, 1, control=True)
    ((380, 1), (643, -1))
    """
    if control and byte not in CONTROLS:
        raise ValueError(f"8b10b has no control character {byte:#04x}")
    x, y = byte & 31, byte >> 5
    six = _fitting(
        _SIX_OF_K28 if control and x == 28 else _SIX[x], disparity, balanced=not control and x == 7
    )
    disparity += _sum(six)
    if control:
        four = _fitting(_FOUR_OF_K[y], disparity, balanced=True)
    elif y == 7 and x in _ALTERNATE_FOR[disparity]:
        four = _fitting(_ALTERNATE, disparity)
    else:
        four = _fitting(_FOUR[y], disparity, balanced=y == 3)
    return int((six + four)[::-1], 2), disparity + _sum(four)


def decode(symbol: int, disparity: int) -> tuple[Character, int] | None:
    """Return what a symbol says, and the running disparity behind it. None: no such symbol, or not here."""
    return _MEANING.get((symbol, disparity))


def bits(symbol: int) -> list[int]:
    """Return the bits of a symbol in the order of the line."""
    return [symbol >> place & 1 for place in range(10)]


def starts_packet(symbol: int) -> bool:
    """Tell whether ten bits are K28.5. A receiver takes its alignment from this alone."""
    return symbol in (encode(K28_5, -1, control=True)[0], encode(K28_5, 1, control=True)[0])


def _sum(group: str) -> int:
    return 2 * group.count("1") - len(group)


def _fitting(group: str, disparity: int, *, balanced: bool = False) -> str:
    """Return the group, or its complement where the running disparity asks for it.

    `balanced` groups have as many ones as zeros, and are complemented nevertheless.
    """
    if disparity > 0 and (balanced or _sum(group)):
        return group.translate(str.maketrans("01", "10"))
    return group


def _meaning() -> dict[tuple[int, int], tuple[Character, int]]:
    found: dict[tuple[int, int], tuple[Character, int]] = {}
    for disparity in (-1, 1):
        for byte in range(256):
            symbol, behind = encode(byte, disparity)
            found[symbol, disparity] = Character(byte), behind
        for byte in CONTROLS:
            symbol, behind = encode(byte, disparity, control=True)
            found[symbol, disparity] = Character(byte, control=True), behind
    return found


_MEANING = _meaning()
