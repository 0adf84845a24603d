# SPDX-License-Identifier: BSD-3-Clause
"""A link to a virtual board in steps that begins anew, in its place."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from unitylink.errors import UnityLinkError

from .line import Line

_TRACE = re.compile(r"(?:^|(?<=&))(trace=[^&]*?)(\.[^./&]*)?(?=&|$)")

Action = Callable[[], None]


class LinkReset(Line):
    """The part of a `Link` that is about its start (docs/lockstep.md)."""

    board: Any
    _begin: Callable[[str], None]
    _end: Action
    close: Action
    check_alive: Action

    def _remember_options(self, url: str) -> None:
        self._options = url.partition("?")[2]
        self._resets = 0
        self._on_reset: list[Callable[[], Action]] = []

    def reset(self, seed: int | None = None) -> None:
        """Begin anew: board, plant and link are as those that have just been made. It is for boards in steps.

        Objects of the spec stay, and what they publish goes on. Subscriptions and exchange groups of this
        link end. The capture of the second session of `trace=a.pcapng` is `a-2.pcapng`. A plant with
        `seed(number)` gets the seed, or the one of the URL (docs/lockstep.md).

        Raises UnityLinkError: on hardware, if time passes by itself, or if the plant cannot be put back.
        """
        if self.board is None:
            raise UnityLinkError(f"{self.url}: only a virtual board can begin anew; hardware is where it is")
        self.board.check_resets()
        self.check_alive()
        afterwards = [action() for action in self._on_reset]
        self._generations = self.generation + 1
        self._end()
        try:
            self.board.reset(seed)
            self._resets += 1
            self._begin(f"{self.board.url}?{_numbered(self._options, self._resets + 1)}")
        except BaseException:
            self.close()
            raise
        for action in afterwards:
            action()

    def call_on_reset(self, action: Callable[[], Action]) -> None:
        """Call `action` before each reset. What it returns is called when the link is there again."""
        if action not in self._on_reset:
            self._on_reset.append(action)


def _numbered(options: str, session: int) -> str:
    """Return the options of a URL with the capture of a later session."""
    return _TRACE.sub(rf"\1-{session}\2", options)
