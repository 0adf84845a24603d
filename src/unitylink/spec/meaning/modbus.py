# SPDX-License-Identifier: BSD-3-Clause
"""The words of `bus_sequencer.vhd` that read and write registers over Modbus RTU.

The CRC is not in them: `modbus_master_line.vhd` adds it, and checks that of a reply.
"""

from __future__ import annotations

from .sequence_words import CHECK, CONTROL, FIRST, KEEP, LANE, LAST, RECEIVE

_OUTPUT = 0x8000
_TAKE = 0x0400  # the output is taken with this byte
_SKIP = CONTROL | 4 << 11  # unless the output was written


def read_words(unit: int, function: int, first: int, words: int, size: int, *, low_first: bool) -> list[int]:
    """Return the words that read values of `size` bytes from the register `first` on.

    A register has its high byte first. `low_first` is for values of two registers.
    """
    count = words * size // 2
    lanes = [1, 0, 3, 2] if low_first else [3, 2, 1, 0]
    value = [RECEIVE | KEEP | lane * LANE for lane in lanes if lane < size]
    value[-1] |= 1  # the next byte belongs to the next value
    return _frame(
        [unit, function, *_bytes(first), *_bytes(count)], [unit, function, 2 * count], value * words
    )


def write_words(unit: int, function: int, register: int, value: list[int]) -> list[int]:
    """Return the words that write a register, by the function 6 or 16. `value` are the words of its bytes."""
    head = [unit, function, *_bytes(register)]
    if function == 6:
        return _frame([*head, *value], head, [RECEIVE] * 2)
    return _frame([*head, 0, 1, 2, *value], [*head, 0, 1], [])


def output_words(unit: int, function: int, register: int, output: int, place: int) -> list[int]:
    """Return the words that write a register with an output, if the bus has set it. They stand at `place`."""
    frame = write_words(unit, function, register, [_OUTPUT | _TAKE | LANE | output, _OUTPUT | output])
    return [_SKIP | output << 8 | (place + 1 + len(frame)) & 0xFF, *frame]


def constant(value: int) -> list[int]:
    """Return the words of the bytes of a constant."""
    return _bytes(value)


def _bytes(value: int) -> list[int]:
    return [value >> 8, value & 0xFF]


def _frame(sent: list[int], checked: list[int], received: list[int]) -> list[int]:
    words = [*sent, *(CHECK | RECEIVE | byte for byte in checked), *received]
    words[0] |= FIRST
    words[-1] |= LAST
    return words
