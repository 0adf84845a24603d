# SPDX-License-Identifier: BSD-3-Clause
"""The thread that calls callbacks."""

from __future__ import annotations

import logging
import threading
import time
import warnings
from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING, Protocol

from unitylink.errors import LinkError

if TYPE_CHECKING:
    from unitylink._native import NativeLink


_PATIENCE_NS = 200_000_000
STUCK_S = 5.0  # at the end the thread waits no longer than this for one call

_log = logging.getLogger("unitylink.link")
_here = threading.local()


def called_back() -> bool:
    """Whether this code runs in a callback, of any link."""
    return getattr(_here, "calls", False)


class Deliverable(Protocol):
    """A subscription, as the callback thread sees it."""

    gather_s: float  # how long a publish may wait; inf sets no limit of its own
    told: int  # number of calls begun

    @property
    def ended(self) -> bool:
        """Whether nothing more will come."""

    def deliver(self) -> None:
        """Fetch the publishes that have come, and call back for each."""

    def hush(self) -> None:
        """Call the callback no more."""


class CallbackThread:
    """The thread of a link that calls callbacks. It exists while a subscription has a callback."""

    def __init__(self, native: NativeLink) -> None:
        self._native = native
        self._subscriptions: tuple[Deliverable, ...] = ()
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None

    def add(self, subscription: Deliverable) -> None:
        with self._changed:
            if subscription not in self._subscriptions:
                self._subscriptions = (*self._subscriptions, subscription)
            if self._native.in_steps:  # then deliver_here() calls, so that each run is the same
                return
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._run, name="unitylink callbacks", daemon=True)
                self._thread.start()

    def remove(self, subscription: Deliverable) -> None:
        with self._changed:
            self._subscriptions = tuple(other for other in self._subscriptions if other is not subscription)
            self._changed.notify_all()

    def deliver_here(self) -> None:
        """Call the callbacks in this thread. It is for a link whose time goes in steps."""
        if not self._subscriptions or not self._native.in_steps or called_back():
            return
        _here.calls = True
        try:
            for subscription in self._subscriptions:
                subscription.deliver()
                if subscription.ended:
                    self.remove(subscription)
        finally:
            _here.calls = False

    def finish(self, subscription: Deliverable) -> None:
        """Wait until the callback has had every publish of a subscription that has ended.

        A call that takes longer than STUCK_S is not waited for. It gives a RuntimeWarning.
        """
        self.deliver_here()
        self._wait_for(lambda: self._thread is None or subscription not in self._subscriptions)

    def disown(self) -> None:
        """Forget the thread and the lock that it may have held. A forked child does not have that thread."""
        self._subscriptions = ()
        self._changed = threading.Condition()
        self._thread = None

    def stop(self) -> None:
        """Wait until the callbacks have had everything that came before the link ended.

        Within a callback, let the thread end after it instead.

        A call that takes longer than STUCK_S is not waited for. It gives a RuntimeWarning.
        """
        self.deliver_here()
        thread = self._thread
        if thread is threading.current_thread():
            for subscription in self._subscriptions:
                subscription.hush()
        elif thread is not None:
            if self._wait_for(lambda: self._thread is not thread):
                thread.join()
            else:
                for subscription in self._subscriptions:
                    subscription.hush()

    def _wait_for(self, done: Callable[[], bool]) -> bool:
        """Wait as long as callbacks return. If one does not return, warn and return False."""
        with self._changed:
            self._changed.notify_all()  # the thread may have nothing to do
            before = -1
            while not self._changed.wait_for(done, STUCK_S):
                told = sum(subscription.told for subscription in self._subscriptions)
                if told == before:
                    stuck = " or ".join(map(repr, self._subscriptions))
                    text = (
                        f"a callback of {stuck} has not returned for {STUCK_S:g} s; "
                        "close() no longer waits for it"
                    )
                    warnings.warn(text, RuntimeWarning, stacklevel=4)
                    return False
                before = told
        return True

    def _run(self) -> None:
        _here.calls = True
        try:
            self._serve()
        finally:
            with self._changed:
                if self._thread is threading.current_thread():
                    self._thread = None
                self._changed.notify_all()
        try:
            self._native.check_alive()
        except LinkError as error:
            _log.error("no more callbacks: %s", error)

    def _serve(self) -> None:
        seen = 0
        for subscription in self._subscriptions:
            subscription.deliver()  # called first, because no publish wakes the thread for it
        round_s = time.monotonic()
        while True:
            before, seen = seen, self._native.wait_publishes(seen, _PATIENCE_NS)
            over = seen == before and self._native.closed  # after news at the end, there is one more round
            subscriptions = self._subscriptions
            for subscription in subscriptions:
                subscription.deliver()
            for subscription in [each for each in subscriptions if each.ended]:
                subscription.deliver()  # the subscription has ended, so nothing more can come
                self.remove(subscription)
            last_s, round_s = round_s, time.monotonic()
            rest_s = self._rest_s()
            if round_s - last_s > 2 * rest_s:
                rest_s = 0.0  # publishes come so rarely that a rest would gather none
            if over or rest_s or not self._subscriptions:
                with self._changed:
                    if over or not self._subscriptions:
                        self._thread = None
                        return
                    self._rest(self._rest_s())

    def _rest_s(self) -> float:
        shortest = min([each.gather_s for each in self._subscriptions], default=0.0)
        return 0.0 if shortest == inf else shortest

    def _rest(self, most_s: float) -> None:
        self._changed.wait(most_s)  # closing a subscription wakes this wait
