# SPDX-License-Identifier: BSD-3-Clause
"""Plain memory and registers: a read has no side effect, writing a word twice does no harm."""

from __future__ import annotations

from .proxy import HardwareProxy


class MemoryProxy(HardwareProxy):
    """Give access to plain memory at `base`; the link may repeat reads and writes after a lost reply.

    Registers where a write *does* something (a counter to clear, a FIFO, a commit) are not plain memory.
    """

    kind = "memory"
    repeatable_writes = True
