# SPDX-License-Identifier: BSD-3-Clause
"""Plain memory and registers. A read has no side effect, and writing a word twice does no harm."""

from __future__ import annotations

from .proxy import HardwareProxy


class MemoryProxy(HardwareProxy):
    """Plain memory at `base`. The link may repeat reads and writes after a lost reply.

    A register whose write has an effect (it clears a counter, pushes, commits) is not plain memory.
    """

    kind = "memory"
    repeatable_writes = True
