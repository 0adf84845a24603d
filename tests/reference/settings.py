# SPDX-License-Identifier: BSD-3-Clause
"""The generics of a reference device."""

from __future__ import annotations

from dataclasses import dataclass


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
    lists: bool = True  # without lists, groups or exchange groups their requests have no form
