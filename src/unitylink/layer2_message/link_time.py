# SPDX-License-Identifier: BSD-3-Clause
"""The time of a link: real time, or that of the virtual boards of this process, which may go in steps."""

from __future__ import annotations

import time
from math import ceil
from typing import TYPE_CHECKING

from unitylink.errors import UnityLinkError, ValueRangeError

if TYPE_CHECKING:
    from unitylink._native import NativeLink

    from .callbacks import CallbackThread

MOST_STEP_S = 1e6
LOOK_NS = 100_000  # about a round trip on USB


class LinkTime:
    """The part of a `Link` that is about its time (docs/lockstep.md)."""

    url: str
    _native: NativeLink
    _callbacks: CallbackThread
    _stepped_ns: int  # when the last step ended

    def now_s(self) -> float:
        """Return the time by which publishes and deadlines are given: `time.monotonic()` on a real board.

        On a `sim:` or `rtl:` link it is robot time. It stands still while this machine is too busy to run the
        virtual boards of the process (docs/rtl-simulation.md).
        """
        return self._native.now_s()

    def sleep_until(self, time_s: float) -> None:
        """Sleep until `now_s()` is `time_s`. With this, a program keeps the pace of the robot.

        >>> due_s = link.now_s()                                             # doctest: +SKIP
        >>> for target in path:                                              # doctest: +SKIP
        ...     due_s += 0.02
        ...     link.sleep_until(due_s)
        ...     set_points.write(target)
        """
        if self.in_steps:
            self._pass_until(ceil(time_s * 1e9))
            return
        while (left_s := time_s - self.now_s()) > 0:
            time.sleep(left_s)

    @property
    def in_steps(self) -> bool:
        """Whether time passes only while a call waits (`time=lockstep`, docs/lockstep.md)."""
        return self._native.in_steps

    def check_time_passes(self, who: str) -> None:
        """Raise UnityLinkError if time goes in steps, because `who` makes none and would wait for ever."""
        if self.in_steps:
            raise UnityLinkError(
                f"{self.url}: {who} lets no time pass; leave out time=lockstep, which is for programs that "
                "call link.step() (docs/lockstep.md)"
            )

    def step(self, dt_s: float) -> None:
        """Let `dt_s` seconds pass. Boards, plants and links of the process advance so far, and stand still.

        A step ends `dt_s` after the end of the last one. So reads and writes in between, which take time as
        on a wire, do not add up. If they took longer than `dt_s`, the step begins now. Callbacks are called
        here.

        Raises UnityLinkError if time passes by itself, and LinkError if the link has ended.

        >>> link = connect("sim:arm.ul", time="lockstep")                    # doctest: +SKIP
        >>> for _ in range(1000):                                            # doctest: +SKIP
        ...     set_points.write(policy(positions.read()))
        ...     link.step(0.001)
        """
        if not self.in_steps:
            raise UnityLinkError(
                f"{self.url}: its time passes by itself; open it with time=lockstep, or use sleep_until"
            )
        if not 0 <= dt_s < MOST_STEP_S:
            raise ValueRangeError(f"a step of {dt_s} s; expected 0 to {MOST_STEP_S:g} s")
        self._stepped_ns = self._native.pass_step(self._stepped_ns, round(dt_s * 1e9))
        self._callbacks.deliver_here()

    def pause_between_looks(self) -> None:
        """Let a moment pass before a word is read again to see whether something has happened.

        Where time passes by itself, the round trip of a read is such a moment.
        """
        if self.in_steps:
            self._native.pass_until(self._native.now_ns + LOOK_NS)

    def _pass_until(self, until_ns: int) -> None:
        self._native.pass_until(until_ns)
        self._callbacks.deliver_here()
