# SPDX-License-Identifier: BSD-3-Clause
"""A program that waits ends at its signal, whenever it comes."""

from __future__ import annotations

import os
import signal
import threading

from unitylink.program import stopped_by_signals


def test_a_signal_that_comes_while_the_event_is_locked_does_not_block() -> None:
    """The main thread runs the handler. Within `wait`, it holds the event's lock."""
    with stopped_by_signals() as stop:
        with stop._cond:  # type: ignore[attr-defined]
            for _ in range(2):
                os.kill(os.getpid(), signal.SIGTERM)
        assert stop.wait(20)
    assert not [one for one in threading.enumerate() if one.name == "unitylink signals"]
