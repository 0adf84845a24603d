# SPDX-License-Identifier: BSD-3-Clause
"""The stop key works in the thread that reads the keyboard, so a screen that hangs cannot hold it up."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from textual.events import Key

if TYPE_CHECKING:
    from textual.driver import Driver
    from textual.message import Message


def with_stop_key(driver: type[Driver], stop: Callable[[], None]) -> type[Driver]:
    """Return the driver of a terminal that calls `stop` at once when the space bar is pressed."""

    class StopDriver(driver):  # type: ignore[misc, valid-type]
        def process_message(self, message: Message) -> None:
            if isinstance(message, Key) and message.key == "space":
                stop()
            super().process_message(message)

    return StopDriver
