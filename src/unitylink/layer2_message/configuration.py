# SPDX-License-Identifier: BSD-3-Clause
"""What a device reports about itself, and what a link has counted."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Configuration:
    """What the device reports about itself: widths, groups, publishing.

    If the device cannot report it, the URL gives it.
    """

    address_bytes: int
    data_bytes: int
    read_many: int
    """Words in one read-many message; 0 where the gateware has none."""
    publish_mode: int
    """0 none, 1 requests before publishing, 2 publishing before requests."""
    base_hz: int
    """Frequency of the base strobe. A subscription with divisor n publishes base_hz / n times a second."""
    groups: int
    group_size: int
    """Addresses in a group, as the device says. See usable_group_size."""
    rate_bytes: int
    discovered: bool
    """True if the device reported it, False if the URL did."""
    usable_group_size: int = 0
    """group_size - 1 on 2012 gateware, where a full group never stops publishing."""

    @property
    def data_bits(self) -> int:
        """Width of a word."""
        return 8 * self.data_bytes

    @property
    def address_bits(self) -> int:
        """Width of an address, in whole bytes."""
        return 8 * self.address_bytes


@dataclass(frozen=True)
class Statistics:
    """What a link has counted since it was opened."""

    requests: int
    replies: int
    device_errors: int
    retries: int
    timeouts: int
    fences: int
    checksum_errors: int
    malformed_messages: int
    datalink_errors: int
    stale_replies: int
    garbage_bytes: int
    publishes: int
    unclaimed_publishes: int
    mismatched_publishes: int
    overruns: int
    bytes_sent: int
    bytes_received: int
    posts: int
    """Posts that were sent: writes without a reply (framed protocol)."""
    missing_publishes: int
    """Gaps in the sequence of publishes: lost on the way (framed protocol)."""
    sessions: int
    """Sessions that this link has opened. More than one: the device was reset, had another host, or the line
    was lost."""
    restarts: int
    """Sessions that the device had lost: it was reset, or another host took it (framed protocol)."""
    reconnections: int
    """Times the line was lost and came back (`reconnect=1`)."""
