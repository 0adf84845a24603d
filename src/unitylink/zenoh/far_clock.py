# SPDX-License-Identifier: BSD-3-Clause
"""The clock of a bridge, as a client knows it. No I/O, and no clock of its own.

Both clocks are monotonic, so a jump of the wall clock changes nothing. What the client knows comes from
questions: asked at one moment of its own clock, told a moment of the bridge's, heard at another of its own.
"""

from __future__ import annotations

DRIFT = 200e-6  # how much two crystals differ at most


class FarClock:
    """Turns times of a client into times of its bridge, and back.

    >>> clock = FarClock()
    >>> clock.learn(asked_ns=1_000, told_ns=50_000, heard_ns=3_000)
    >>> clock.deadline(now_ns=3_000, ttl_ns=10_000_000), clock.here(50_000)
    (10048000, 2000)
    """

    def __init__(self) -> None:
        self._known = False
        self._told_ns = self._heard_ns = self._asked_ns = 0  # of the answer that has come back fastest
        self._there = (0, 0)  # when it was asked and told, of the question that has gone there fastest

    def learn(self, asked_ns: int, told_ns: int, heard_ns: int) -> None:
        """Take an answer, if it says more than what is known.

        One that was held up on one way may still say much by the other.
        """
        if not self._known or told_ns <= self.latest(asked_ns):
            self._there = asked_ns, told_ns
        if not self._known or told_ns >= self._least(heard_ns):
            self._known = True
            self._asked_ns, self._told_ns, self._heard_ns = asked_ns, told_ns, heard_ns

    def deadline(self, now_ns: int, ttl_ns: int) -> int:
        """Return a moment of the bridge's clock that is at most `ttl_ns` after now, whatever the delays were.

        It is earlier by up to the round trip of the question.
        """
        return self._least(now_ns) + int(ttl_ns * (1 - DRIFT))

    def latest(self, now_ns: int) -> int:
        """Return a moment that the bridge's clock has not passed now: it was asked before it answered.

        It is later by up to the round trip of the question.
        """
        asked_ns, told_ns = self._there
        since_ns = now_ns - asked_ns
        return told_ns + since_ns + int(abs(since_ns) * DRIFT) + 1

    def here(self, far_ns: int) -> int:
        """Return when that was by the client's clock. It is wrong by up to half a round trip."""
        return far_ns - self._told_ns + (self._asked_ns + self._heard_ns) // 2

    def _least(self, now_ns: int) -> int:
        """Return a moment that the bridge's clock has passed now: when it answered, it showed `told_ns`."""
        since_ns = now_ns - self._heard_ns
        return self._told_ns + int(since_ns * (1 - DRIFT))
