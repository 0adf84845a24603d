# SPDX-License-Identifier: BSD-3-Clause
"""The scrambler of TosNet's wire: each byte of a packet is XORed with a byte of a shift register."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

SEED = 0x55  # of the register that gives the seeds, at the reset


def following(state: int) -> int:
    """Return the next state: a shift to the right, with the XOR of the two low bits as the new top bit.

    >>> [hex(following(state)) for state in (0x55, 0xAA, 0x01)]
    ['0xaa', '0xd5', '0x80']
    """
    return state >> 1 | ((state ^ state >> 1) & 1) << 7


def masks(seed: int) -> Iterator[int]:
    """Yield what the bytes of a packet are XORed with. A register of zeros gives FF."""
    state = seed
    while True:
        yield state or 0xFF
        state = following(state)


def scrambled(data: Sequence[int], seed: int) -> bytes:
    """Scramble bytes, or restore scrambled ones.

    >>> scrambled(scrambled(b"TosNet", 0x55), 0x55)
    b'TosNet'
    """
    return bytes(byte ^ mask for byte, mask in zip(data, masks(seed), strict=False))
