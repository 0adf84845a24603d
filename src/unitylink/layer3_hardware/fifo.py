# SPDX-License-Identifier: BSD-3-Clause
"""A FIFO in the gateware.

A read of its data word pops, and a write to it pushes. So neither is ever repeated.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from unitylink.errors import BusError, DeviceMismatch, ValueRangeError, shown

from .arguments import whole, wholes
from .proxy import HardwareProxy

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from unitylink.layer2_message import Link

DATA, COUNT, SPACE = 0, 1, 2  # relative addresses
WORDS_MOST = 2**16  # in each direction: the largest depth of `fifo_slave`
# the most that one read-many can carry; the link splits it further if the gateware takes less
BLOCK_WORDS = 255


@dataclass(frozen=True)
class FifoStatus:
    """How many words wait for the PC, and how many more fit into the gateware."""

    count: int
    space: int

    @property
    def empty(self) -> bool:
        return self.count == 0

    @property
    def full(self) -> bool:
        return self.space == 0


class FifoProxy(HardwareProxy):
    """Give access to a FIFO with one queue each way: +0 data (a read pops, a write pushes), +1 words to read,
    +2 room.

    A lost reply to a pop may have taken a word with it. So nothing is repeated, and the error says what is
    unknown. A pop from an empty FIFO and a push into a full one are bus errors.

    >>> samples = FifoProxy(link, base=0x200)     # doctest: +SKIP
    >>> samples.pop_many(limit=100)               # what is there, at most 100  # doctest: +SKIP
    array([17, 18, 21], dtype=uint32)
    """

    kind = "fifo"
    repeatable_reads = False
    repeatable_writes = False

    def __init__(self, link: Link, base: int = 0) -> None:
        super().__init__(link, base, words=3)

    def status(self) -> FifoStatus:
        """Read both counters, which has no side effect."""
        count, space = self.link.read_many([self.base + COUNT, self.base + SPACE], repeat=True)
        return FifoStatus(int(count), int(space))

    def pop(self, *, timeout_s: float | None = None) -> int:
        """Take the oldest word. Raises BusError if there is none."""
        try:
            return self.read(DATA, timeout_s=timeout_s)
        except BusError as error:
            raise BusError(
                f"fifo at {self.base:#06x}: nothing to pop ({error.message}); look at status().count first",
                address=self.base,
            ) from error

    def pop_many(self, limit: int, *, timeout_s: float | None = None) -> NDArray[np.uint32]:
        """Take at most `limit` of the waiting words, oldest first.

        Raises DeviceMismatch if the device counts more words than a FIFO can hold. Then there is no FIFO at
        that address.
        """
        limit = whole("fifo: limit", limit)
        if limit < 0:
            raise ValueRangeError(f"fifo: cannot take {shown(limit)} words")
        left = min(limit, self._counted(COUNT))
        blocks = [np.zeros(0, np.uint32)]
        while left:
            block = min(left, BLOCK_WORDS)
            blocks.append(self.read_many([DATA] * block, timeout_s=timeout_s))
            left -= block
        return np.concatenate(blocks)

    def push(self, word: int, *, timeout_s: float | None = None) -> None:
        """Append one word. Raises BusError if there is no room."""
        try:
            self.write(DATA, word, timeout_s=timeout_s)
        except BusError as error:
            raise BusError(
                f"fifo at {self.base:#06x}: no room to push ({error.message}); look at status().space first",
                address=self.base,
            ) from error

    def push_many(self, words: Iterable[int], *, timeout_s: float | None = None) -> None:
        """Append words in order.

        Raises ValueRangeError before the first word is sent if there is no room for all.
        """
        batch = wholes("fifo: words", words)
        self._check_words(batch)
        space = self._counted(SPACE)
        if len(batch) > space:
            raise ValueRangeError(
                f"fifo at {self.base:#06x}: {len(batch)} words do not fit, it has room for {space}"
            )
        self.write_many([DATA] * len(batch), batch, timeout_s=timeout_s)

    def _counted(self, register: int) -> int:
        """Return one of the counters.

        A number that no FIFO can have is refused, because popping so many words would take hours.
        """
        count = int(self.link.read(self.base + register))
        if count > WORDS_MOST:
            raise DeviceMismatch(
                f"there is no FIFO at {self.base:#06x}: the word at {self.base + register:#06x} is {count:,}"
                f", and a FIFO holds at most {WORDS_MOST:,} words"
            )
        return count
