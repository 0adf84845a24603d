# SPDX-License-Identifier: BSD-3-Clause
"""The thread that calls callbacks."""

from __future__ import annotations

import logging
import threading
import time
from typing import Protocol

from unitylink.errors import LinkError

from .engine import Engine

_PATIENCE_NS = 200_000_000

_log = logging.getLogger("unitylink.link")


class Deliverable(Protocol):
    """A subscription, as the callback thread sees it."""

    gather_s: float  # how long what has come may wait

    def deliver(self) -> None:
        """Fetch what has come and call back for each."""


class CallbackThread:
    """One thread per link that calls callbacks; it lives while a subscription has one."""

    def __init__(self, native: Engine) -> None:
        self._native = native
        self._subscriptions: tuple[Deliverable, ...] = ()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def add(self, subscription: Deliverable) -> None:
        with self._lock:
            if subscription not in self._subscriptions:
                self._subscriptions = (*self._subscriptions, subscription)
            if self._thread is None or not self._thread.is_alive():
                self._thread = threading.Thread(target=self._run, name="unitylink callbacks", daemon=True)
                self._thread.start()

    def remove(self, subscription: Deliverable) -> None:
        with self._lock:
            self._subscriptions = tuple(other for other in self._subscriptions if other is not subscription)

    def disown(self) -> None:
        """Forget the thread, which a forked child does not have, and the lock that it may have held."""
        self._subscriptions = ()
        self._lock = threading.Lock()
        self._thread = None

    def stop(self) -> None:
        thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join()

    def _run(self) -> None:
        seen = 0
        while True:
            seen = self._native.wait_publishes(seen, _PATIENCE_NS)
            subscriptions = self._subscriptions
            for subscription in subscriptions:
                subscription.deliver()
            if rest_s := min((each.gather_s for each in subscriptions), default=0.0):
                time.sleep(rest_s)
            with self._lock:
                if self._native.closed or not self._subscriptions:
                    self._thread = None
                    break
        try:
            self._native.check_alive()
        except LinkError as error:
            _log.error("no more callbacks: %s", error)
