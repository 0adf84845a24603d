# SPDX-License-Identifier: BSD-3-Clause
"""Double-buffered memory: the FPGA sees all words of a burst at once, or none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.errors import ValueRangeError, shown

from .arguments import at, whole
from .committed import CommittedProxy

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


class DoubleBufferProxy(CommittedProxy):
    """Give access to a double-buffered memory of `size` words: +0 to +size-1 are the bank, +size is the
    commit.

    A write goes to the hidden bank, a read comes from the visible one. A commit swaps the banks at once,
    without copying. CommittedProxy explains what follows from that.

    >>> table = DoubleBufferProxy(link, base=0x300, size=16)   # doctest: +SKIP
    >>> table.write_many(range(16), profile)   # the FPGA never sees half of it  # doctest: +SKIP
    """

    kind = "double buffer"

    def __init__(self, link: Link, base: int = 0, *, size: int) -> None:
        size = whole("double buffer: size", size)
        if size < 1:
            raise ValueRangeError(f"double buffer: size {shown(size)} is not positive")
        super().__init__(link, base, words=size + 1)
        self.size = size
        self.commit_address = size

    def commits(self) -> int:
        """Read how many commits the gateware has taken. After an OutcomeUnknown it tells what happened."""
        return self.link.read(self.base + self.size)

    def _check_output(self, address: int) -> None:
        if not 0 <= address < self.size:
            raise ValueRangeError(
                f"double buffer at {self.base:#06x}: {at(address)} is not in its {self.size} words"
                + ("; commit() commits" if address == self.size else "")
            )
