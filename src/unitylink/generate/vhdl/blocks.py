# SPDX-License-Identifier: BSD-3-Clause
"""How the words of a spec are placed on the bus: in blocks of registers, each of which is a slave."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from ..quoting import Vhdl
from .words import WordMap

WINDOW = 64  # so many neighbouring addresses may share a slave


@dataclass(frozen=True)
class Block:
    """A register slave with `words` addresses from `base` on.

    `words` is a power of two, and `base` is a multiple of it.
    """

    base: int
    words: int
    addresses: tuple[int, ...]  # the addresses that exist; the others are holes

    def writable(self, words: WordMap) -> Vhdl:
        """Return the generic of register_slave, with one character for each address."""
        exist = set(self.addresses)
        hole, kept, given = Vhdl("-"), Vhdl("1"), Vhdl("0")
        return Vhdl("").join(
            hole if address not in exist else kept if address in words.write else given
            for address in range(self.base, self.base + self.words)
        )


def blocks(addresses: Iterable[int], keep_out: Sequence[range] = ()) -> tuple[Block, ...]:
    """Divide addresses into blocks.

    An aligned power of two needs no adder to decode, and a hole needs no flip-flop.

    The words of one window of 64 addresses share a slave. Its size is the smallest power of two that holds
    them. No block overlaps `keep_out`, where other slaves answer.

    >>> [(hex(block.base), block.words) for block in blocks([0x10, 0x13, 0x12345])]
    [('0x10', 4), ('0x12345', 1)]
    """
    windows = groupby(sorted(addresses), lambda address: address // WINDOW)
    return tuple(block for _, inside in windows for block in _divide(tuple(inside), keep_out))


def _divide(addresses: tuple[int, ...], keep_out: Sequence[range]) -> Iterator[Block]:
    words = 1
    while addresses[0] // words != addresses[-1] // words:
        words *= 2
    base = addresses[0] // words * words
    if words > 1 and any(base < other.stop and other.start < base + words for other in keep_out):
        middle = base + words // 2
        near = [other for other in keep_out if base < other.stop and other.start < base + words]
        yield from _divide(tuple(address for address in addresses if address < middle), near)
        yield from _divide(tuple(address for address in addresses if address >= middle), near)
    else:
        yield Block(base, words, addresses)
