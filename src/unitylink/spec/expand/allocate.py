# SPDX-License-Identifier: BSD-3-Clause
"""Find room for blocks of addresses that the spec does not bind.

Each block gets a power of two of words, at a multiple of this number. It is the first free place in its
device, in the order of the text. So decoding it costs one comparison, and a block that is added at the end
moves no earlier one.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..meaning.scope import ADDRESS_MAX
from ..model import LinkBinding
from ..report.diagnostics import Reporter

_Device = tuple[str, "str | None"]


@dataclass(frozen=True)
class Block:
    """Consecutive words of one instance. `start` to `end` is the place in the text that asks for them."""

    root: str
    comm: str | None
    path: str
    first: int | None  # None if it is not bound
    words: int
    lowest: int  # the lowest address that it may have
    limit: int  # the first address that it may not have
    start: int
    end: int
    component: bool

    @property
    def device(self) -> _Device:
        return self.root, self.comm


class Occupied:
    """The addresses of a device that are taken, as ranges in rising order that do not touch."""

    def __init__(self) -> None:
        self._starts: list[int] = []
        self._ends: list[int] = []

    def take(self, first: int, words: int) -> None:
        """Mark `words` addresses from `first` on as taken."""
        end = first + words
        low = bisect_right(self._ends, first - 1)
        high = bisect_right(self._starts, end)
        if low < high:
            first, end = min(first, self._starts[low]), max(end, self._ends[high - 1])
        self._starts[low:high] = [first]
        self._ends[low:high] = [end]

    def room(self, words: int, lowest: int, limit: int) -> int | None:
        """Return the first free multiple of `words` from `lowest` on. All words must be below `limit`."""
        at = -(-lowest // words) * words
        position = bisect_right(self._ends, at)
        while position < len(self._starts) and self._starts[position] < at + words:
            at = -(-self._ends[position] // words) * words
            position = bisect_right(self._ends, at)
        return at if at + words <= limit else None


def allocate(
    blocks: Sequence[Block], taken: Iterable[tuple[_Device, int, int]], reporter: Reporter
) -> dict[tuple[str, str], int]:
    """Return (root, path) -> first address of every unbound block. `taken` has (device, first, words)."""
    devices: dict[_Device, Occupied] = {}
    for device, first, words in taken:
        devices.setdefault(device, Occupied()).take(first, words)
    for block in blocks:
        if block.first is not None:
            devices.setdefault(block.device, Occupied()).take(block.first, block.words)
    found: dict[tuple[str, str], int] = {}
    for block in blocks:
        if block.first is not None:
            continue
        words = 1 << max(0, block.words - 1).bit_length()
        occupied = devices.setdefault(block.device, Occupied())
        room = occupied.room(words, block.lowest, min(block.limit, ADDRESS_MAX + 1))
        if room is None:
            message = f"there is no room for the {block.words:,} words of `{block.path}`"
            hint = "bind it to an address, `@ 0x…`, or declare a wider ADDRESS for its link"
            reporter.report("UL056", block.start, block.end, message, hint)
            continue
        occupied.take(room, words)
        found[block.root, block.path] = room
    return found


def windows(links: Iterable[tuple[str, LinkBinding]]) -> list[tuple[_Device, int, int]]:
    """Return the windows of TosNet, FIFOs and double buffers, in which nothing else may be.

    `links` has the public constructor and the link of each element.
    """
    found = {((root, link.comm), link.base, link.words) for root, link in links if link.words}
    return sorted(found, key=str)
