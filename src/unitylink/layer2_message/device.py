# SPDX-License-Identifier: BSD-3-Clause
"""What a framed device reports about itself: its description, its counters, its clock."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from unitylink.errors import DeviceMismatch
from unitylink.protocol import CONTROL_ARM, CONTROL_DEADMAN_TICKS, CONTROL_FRAMES

if TYPE_CHECKING:
    from unitylink._native import NativeLink

    from .native_link import Words

_log = logging.getLogger("unitylink.link")


@dataclass(frozen=True)
class Description:
    """What the gateware reports about itself (docs/protocol.md, section 6)."""

    version: int
    """Version of the protocol: major in the upper half, minor in the lower."""
    gateware_version: int
    build: int
    clock_hz: int
    features: int
    """The bits FEATURE_… of unitylink.protocol."""
    credit: int
    """How many bytes of requests may be unanswered."""
    request_max: int
    """Bytes of the longest payload of a request."""
    reply_max: int
    window: int
    """How many requests may be unanswered."""
    cache: int
    """How many bytes of a reply are kept for a repeat."""
    exchanges: int
    exchange_size: int
    spec_hash: int
    """The wire hash of the spec that the gateware was built from (`unitylink.interface.wire_hash`). 0: it
    does not know."""


@dataclass(frozen=True)
class Health:
    """The device's own counters since its reset. Each stops at 2^32 - 1."""

    frames: int
    discarded_check: int
    """Frames with a wrong check: noise on the line."""
    discarded_kind: int
    discarded_session: int
    """Frames that came while no session was open."""
    discarded_stale: int
    discarded_long: int
    duplicates: int
    """Requests that came again. Each was executed once."""
    posts: int
    posts_ahead: int
    posts_old: int
    post_errors: int
    bus_errors: int
    bus_timeouts: int
    publishes: int
    publish_overruns: int
    receive_overruns: int
    refused: int
    """Writes that were denied after a dead-man."""
    deadman_trips: int

    @classmethod
    def count(cls) -> int:
        """The number of counters. Each counter is one register, in the order of the fields."""
        return len(fields(cls))

    @classmethod
    def read(cls, read_control: Callable[[int, int], Words], reply_max: int) -> Health:
        """Read them from a device whose replies have up to `reply_max` bytes."""
        most = max(1, (reply_max - 4) // 4)
        words: list[int] = []
        while len(words) < cls.count():
            count = min(most, cls.count() - len(words))
            words += read_control(CONTROL_FRAMES + len(words), count).tolist()
        return cls(*words)


@dataclass(frozen=True)
class DeadMan:
    """The state of the dead-man, which watches whether the host is alive (docs/protocol.md, section 6)."""

    tripped: bool
    """Whether it has tripped: the outputs are safe, and nothing is written before `Link.arm`."""
    running: bool
    silence_s: float
    """The silence after which it trips. 0 if it does not run."""

    @classmethod
    def read(cls, read_control: Callable[[int, int], Words], base_hz: int) -> DeadMan:
        """Read it from a device. A tick of the dead-man is a period of its base rate."""
        state, ticks = (int(read_control(address, 1)[0]) for address in (CONTROL_ARM, CONTROL_DEADMAN_TICKS))
        return cls(tripped=bool(state & 1), running=bool(state & 2), silence_s=ticks / base_hz)


@dataclass(frozen=True)
class Clock:
    """The device's clock converted to the host's time, by a line through readings of that clock."""

    period_ns: float
    """The duration of one clock of the device, by the host's clock."""
    drift_ppm: float
    """How much longer that is than the device says."""
    uncertainty_ns: float
    """How wrong a time stamp can be: half of the quickest round trip."""


def told_notice(engine: NativeLink, url: str) -> str:
    """Return why `engine` speaks the classic protocol without a request for it, and warn."""
    if engine.notice:
        _log.warning("%s: %s", url, engine.notice)
    return engine.notice


def checked_spec(engine: NativeLink, url: str, spec: str, hashes: Sequence[int]) -> str:
    """Check that the gateware was built from `spec`, which has one of `hashes`. Return why this is unknown.

    Return "" if it was built from it. If it was not, raise DeviceMismatch. With `spec_hash=any` in the URL,
    only log it.
    """
    try:
        unverified = engine.check_spec(spec, hashes)
    except DeviceMismatch as error:
        raise DeviceMismatch(f"{url}: {error.message}") from None
    if "spec_hash=any" in unverified:
        _log.warning("%s: %s", url, unverified)
    return unverified
