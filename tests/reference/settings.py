# SPDX-License-Identifier: BSD-3-Clause
"""The generics of a reference device."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink import protocol as p


@dataclass(frozen=True)
class Settings:
    """The generics of the device."""

    a: int = 2
    d: int = 4
    credit: int = 512
    request_max: int = 250
    reply_max: int = 250
    window: int = 8
    cache: int = 16
    features: int = 0x1F
    spec_hash: int = 0x0123456789ABCDEF
    groups: int = 4
    group_size: int = 16
    exchanges: int = 2
    exchange_size: int = 16
    clock_hz: int = 50_000_000
    base_hz: int = 1000
    gateware_version: int = 0x00010000
    build: int = 0
    safe: tuple[tuple[int, int], ...] = ()
    lists: bool = True  # without lists, groups or exchange groups, requests for them are invalid

    def description(self) -> dict[int, int]:
        """Return the control registers that describe these settings."""
        return {
            p.CONTROL_MAGIC: p.CONTROL_VALUE_MAGIC,
            p.CONTROL_VERSION: p.FRAME_VERSION << 16,
            p.CONTROL_GATEWARE_VERSION: self.gateware_version,
            p.CONTROL_BUILD: self.build,
            p.CONTROL_WIDTHS: 8 * self.a << 16 | 8 * self.d,
            p.CONTROL_CLOCK_HZ: self.clock_hz,
            p.CONTROL_BASE_HZ: self.base_hz,
            p.CONTROL_FEATURES: self.features,
            p.CONTROL_REQUEST_CREDIT: self.credit,
            p.CONTROL_FRAME_LIMITS: self.request_max << 16 | self.reply_max,
            p.CONTROL_WINDOW: self.window << 16 | self.cache,
            p.CONTROL_GROUPS: self.groups << 16 | self.group_size,
            p.CONTROL_EXCHANGES: self.exchanges << 16 | self.exchange_size,
            p.CONTROL_SPEC_HASH_HIGH: self.spec_hash >> 32,
            p.CONTROL_SPEC_HASH_LOW: self.spec_hash & 0xFFFFFFFF,
        }
