# SPDX-License-Identifier: BSD-3-Clause
"""A moment from which on nothing is sent, for values whose time is over then."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from unitylink._native import NativeLink

T = TypeVar("T")


def sent_before(moment_ns: int, act: Callable[[], T]) -> T:
    """Return what `act` returns. What it asks of a link is not sent at or after `moment_ns`, nor sent again.

    The moment is one of `time.monotonic_ns`. The core looks at the clock when it gives bytes to the line, so
    it does not matter where this thread or process was held up before. It counts for calls that wait for
    their answer, by this thread, of links with the framed protocol.

    What was not sent raises LinkTimeout, and what was sent and not answered by then OutcomeUnknown.

    >>> import time
    >>> sent_before(time.monotonic_ns() + 10**9, lambda: 5)
    5
    """
    before_ns = NativeLink.limit_sending(moment_ns)
    try:
        return act()
    finally:
        NativeLink.limit_sending(before_ns)
