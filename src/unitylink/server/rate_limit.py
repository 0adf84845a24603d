# SPDX-License-Identifier: BSD-3-Clause
"""How many requests a client, or a user with all clients, may make: buckets that fill up steadily."""

from __future__ import annotations


class RateLimit:
    """A bucket. It holds `burst` requests at most, and `rate_hz` more come each second.

    >>> limit = RateLimit(rate_hz=10.0, burst=2)
    >>> [limit.allow(now_s=0.0) for _ in range(3)], limit.allow(now_s=0.1)
    ([True, True, False], True)
    """

    def __init__(self, rate_hz: float, burst: int) -> None:
        self.rate_hz, self.burst = rate_hz, burst
        self.refused = 0
        self._level = float(burst)
        self._at_s: float | None = None

    def allow(self, now_s: float, cost: float = 1.0) -> bool:
        """Take `cost` out of the bucket, or count a refusal and return False."""
        if self._at_s is not None:
            self._level = min(float(self.burst), self._level + max(0.0, now_s - self._at_s) * self.rate_hz)
        self._at_s = now_s
        if self._level + 1e-9 < cost:
            self.refused += 1
            return False
        self._level -= cost
        return True

    def wait_s(self, cost: float = 1.0) -> float:
        """Return how long a client has to wait after a refusal until `cost` is there."""
        return max(0.0, (cost - self._level) / self.rate_hz)


CONNECTIONS = 4  # all connections of a user may ask as much as so many that each use their limit


class SharedLimit:
    """A bucket for each user, beside those of the connections. Users have the names of tokens: few.

    >>> limits = SharedLimit(rate_hz=10.0, burst=1)
    >>> [limits.of("ana").allow(now_s=0.0) for _ in range(5)], limits.of("ben").allow(now_s=0.0)
    ([True, True, True, True, False], True)
    """

    def __init__(self, rate_hz: float, burst: int) -> None:
        self._rate_hz, self._burst = CONNECTIONS * rate_hz, CONNECTIONS * burst
        self._limits: dict[str, RateLimit] = {}

    def of(self, user: str) -> RateLimit:
        return self._limits.setdefault(user, RateLimit(self._rate_hz, self._burst))
