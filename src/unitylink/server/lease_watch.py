# SPDX-License-Identifier: BSD-3-Clause
"""Tells a running program that another user wants what it writes, so that it may hand it over."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterator
from typing import Any

from unitylink.errors import UnityLinkError

from .questions import ask_server
from .subtree import WHOLE, overlap

LOOK_S = 1.0  # a wish stands for 60 s

Wanted = Callable[[str, str], object]
_log = logging.getLogger(__name__)


class LeaseWatch:
    """Asks the server of a serve:// URL once a second, in a thread, until `close` or the end of the `with`.

    `wanted(part, user)` is called in that thread, once for each wish for a part whose lease the user of this
    program's token has. What it raises is logged. Without it, a warning is logged for each wish.

        def hand_over(part, user):
            arm.hold()
            ask_server(url, "give", part, user)

        with LeaseWatch(url, hand_over):
            work()

    Raises UnityLinkError if the server does not answer at the begin. Later the watch waits until it does.
    """

    def __init__(self, url: str, wanted: Wanted | None = None, *, look_s: float = LOOK_S) -> None:
        self.url = url
        self._wanted = wanted if wanted is not None else _warn
        self._look_s = look_s
        self._closed = threading.Event()
        found = set(_wishes(ask_server(url, "status")))
        self._thread = threading.Thread(target=self._watch, args=(found,), name="lease watch", daemon=True)
        self._thread.start()

    def __enter__(self) -> LeaseWatch:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the watch. It may wait for an answer of the server before."""
        self._closed.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _watch(self, found: set[tuple[str, str]]) -> None:
        told: set[tuple[str, str]] = set()
        while True:
            for wish in sorted(found - told):
                self._tell(*wish)
            told = found
            if self._closed.wait(self._look_s):
                return
            try:
                found = set(_wishes(ask_server(self.url, "status")))
            except UnityLinkError:  # the server is away; the link of the program says so
                continue

    def _tell(self, part: str, user: str) -> None:
        try:
            self._wanted(part, user)
        except Exception:
            _log.exception("the program could not be told that %s wants %s", user, part)


def _wishes(status: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the part and the user of each wish for what the asking user holds.

    >>> arm = {"leases": [{"part": "j1", "holder": "ana", "ending": ""}],
    ...        "wishes": [{"part": "*", "user": "ben", "kept": False}]}
    >>> list(_wishes({"you": "ana", "robots": [arm]})), list(_wishes({"you": "cem", "robots": [arm]}))
    ([('*', 'ben')], [])
    """
    for robot in status["robots"]:
        mine = [
            one["part"] for one in robot["leases"] if one["holder"] == status["you"] and not one["ending"]
        ]
        for wish in robot["wishes"]:
            others = not wish["kept"] and wish["user"] != status["you"]
            if others and any(overlap(_part(one), _part(wish["part"])) for one in mine):
                yield wish["part"], wish["user"]


def _part(shown: str) -> str:
    return WHOLE if shown == "*" else shown


def _warn(part: str, user: str) -> None:
    what = "the whole robot" if part == "*" else part
    _log.warning("%s wants to write %s; `unitylink lease URL give` hands it over", user, what)
