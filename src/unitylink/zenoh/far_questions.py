# SPDX-License-Identifier: BSD-3-Clause
"""Questions to a bridge on Zenoh, at its keys: asked once, or again until somebody answers."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from unitylink.errors import UnityLinkError

from .failures import decode_failure

if TYPE_CHECKING:
    import zenoh

    from .keys import Keys

PAUSE_S = 0.02  # before a bridge is asked again that was not there


class FarQuestions:
    """Asks, from any thread, and waits. `broken(why)` makes the error of a session that fails."""

    def __init__(self, session: zenoh.Session, keys: Keys, broken: Callable[[str], UnityLinkError]) -> None:
        self._session, self._keys, self._broken = session, keys, broken
        self._here = threading.local()

    def once(
        self, key: str, data: bytes, timeout_s: float, *, urgent: bool = False
    ) -> bytes | UnityLinkError | None:
        """Ask once. Return the answer, the error that was answered, or None if there was no answer."""
        import zenoh

        self._here.reached = False
        try:
            replies = self._session.get(
                key,
                payload=data,
                timeout=timeout_s,
                priority=zenoh.Priority.REAL_TIME if urgent else zenoh.Priority.INTERACTIVE_HIGH,
                express=True,
                # the first answer is taken as it comes, and not when the bridge has said that it was the last
                consolidation=zenoh.ConsolidationMode.NONE,
            )
            for reply in replies:
                if reply.ok is not None:
                    return bytes(reply.ok.payload.to_bytes())
                told = reply.err.payload.to_bytes() if reply.err is not None else b""
                self._here.reached = True
                if told[:1] == b"{":
                    return decode_failure(told)
        except zenoh.ZError as error:
            return self._broken(str(error))
        return None

    @property
    def reached(self) -> bool:
        """Whether somebody was there who got the last question of this thread."""
        return bool(getattr(self._here, "reached", False))

    def insist(
        self, what: str, data: bytes = b"", *, each_s: float, within_s: float, urgent: bool = False
    ) -> bytes | None:
        """Ask at a fixed key until there is an answer, which it is no harm to do twice.

        Nobody may be there for a moment: after the return of a router, keys come one after the other. Raises
        the error that is answered. None: there was no answer.
        """
        until_s = time.monotonic() + within_s
        while (left_s := until_s - time.monotonic()) > 0:
            answer = self.once(self._keys.fixed(what), data, min(each_s, left_s), urgent=urgent)
            if isinstance(answer, bytes):
                return answer
            if answer is not None:
                raise answer
            time.sleep(PAUSE_S)
        return None
