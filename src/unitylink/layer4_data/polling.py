# SPDX-License-Identifier: BSD-3-Clause
"""Publishing without the gateware: the PC reads at a rate, in a thread of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from unitylink.errors import LinkClosed, LinkError, UnityLinkError

from .listeners import logger

if TYPE_CHECKING:
    from .publication import PublishPlan


class Poller:
    """Read a plan's words at its rate and deliver them. A read that fails is counted as lost.

    The first failure is logged, and so is the first success after it. A poll that is too late is skipped and
    counted. It is not made up for. The time of a poll is the middle of the read.
    """

    def __init__(self, plan: PublishPlan, deliver: Callable[[float, Sequence[int]], None]) -> None:
        self.lost = 0
        if plan.link.in_steps:
            raise UnityLinkError(
                f"{plan.values[0].path} has no PUBLISH, so it is polled, and with time=lockstep no time "
                "passes by itself; read it after each step, or give it a PUBLISH"
            )
        self._plan = plan
        self._deliver = deliver
        self._stop = threading.Event()
        name = f"unitylink-poll-{plan.values[0].path}"
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        if self._thread is not threading.current_thread():  # a callback may stop the publishing that calls it
            self._thread.join()

    def _run(self) -> None:
        link, addresses = self._plan.link, self._plan.addresses
        atomic = 1 < len(addresses) <= link.configuration.read_many
        checked, period_s = self._plan.checked, 1 / self._plan.rate_hz
        failed = 0  # polls that have failed since the last one that worked
        due = time.monotonic()
        while not self._stop.wait(max(0.0, due - time.monotonic())):
            started = link.now_s()
            try:
                words = link.read_many(
                    addresses, atomic=atomic, checked=checked, repeat=self._plan.repeatable
                ).tolist()
            except LinkClosed as error:
                logger.error("%s: polling ends: %s", self._plan.values[0].path, error)
                return
            except LinkError as error:
                self.lost += 1
                failed += 1
                if failed == 1:
                    logger.warning("%s: %s", self._plan.values[0].path, error)
            else:
                if failed:
                    logger.warning("%s: polled again, %d failed", self._plan.values[0].path, failed)
                    failed = 0
                self._deliver((started + link.now_s()) / 2, words)
            due += period_s
            late = int((time.monotonic() - due) / period_s)
            if late > 0:
                self.lost += late
                due += late * period_s
