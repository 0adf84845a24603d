# SPDX-License-Identifier: BSD-3-Clause
"""The times of a TosNet ring: bytes of a cycle, its length, and when each node's strobe comes."""

from __future__ import annotations

from collections.abc import Sequence

from gateware.tosnet_packets import Node

BYTE_US = 0.8  # ten bits at 12.5 Mbit/s
HOP_US = 6.0
HOP_CLOCKS = 300  # at 50 MHz
REST_BYTES = 18  # K28.5, the seed, the command, the asynchronous block, and the check
REGISTER_PAIR_BYTES = 32  # OUT and IN


def cycle_bytes(ring: Sequence[Node]) -> int:
    """Return the bytes of a DATA packet on the line.

    >>> cycle_bytes([Node(1, 1), Node(2, 1)])
    82
    """
    return REST_BYTES + REGISTER_PAIR_BYTES * sum(len(node.registers) for node in ring)


def cycle_us(ring: Sequence[Node]) -> float:
    """Return the length of a cycle as the reference estimates it."""
    return BYTE_US * cycle_bytes(ring) + HOP_US * len(ring)


def strobe_clocks(nodes: int, address: int) -> int:
    """Return the clocks from the end of the DATA packet at a node to its strobe.

    The strobes of all nodes come at the same moment.

    >>> [strobe_clocks(5, address) for address in range(5)]
    [0, 1200, 900, 600, 300]
    """
    return (nodes - address) * HOP_CLOCKS if address else 0
