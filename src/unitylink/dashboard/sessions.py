# SPDX-License-Identifier: BSD-3-Clause
"""Who has logged in with a browser. A cookie stands for the session, so the token is sent only once."""

from __future__ import annotations

import hashlib
import secrets
from dataclasses import dataclass

from unitylink.server.gate import Client

IDLE_S = 12 * 3600.0  # a session that nobody has used for so long ends
MOST = 1000  # sessions; then the one that was not used for the longest time ends


@dataclass
class Session:
    """A user's browser. `token` opens further connections of the same user."""

    client: Client
    token: str
    used_s: float


class Sessions:
    """All sessions, by the secret in the cookie. Times are in s of a clock that does not jump."""

    def __init__(self) -> None:
        self._sessions: dict[str, Session] = {}

    def open(self, client: Client, token: str, now_s: float) -> tuple[str, list[Session]]:
        """Begin a session. Return its secret, and the sessions that end for it."""
        ended = self.expire(now_s)
        while len(self._sessions) >= MOST:
            oldest = min(self._sessions, key=lambda key: self._sessions[key].used_s)
            ended.append(self._sessions.pop(oldest))
        secret = secrets.token_urlsafe(32)
        self._sessions[_key(secret)] = Session(client, token, now_s)
        return secret, ended

    def find(self, secret: str, now_s: float) -> Session | None:
        """Return the session of a secret, and note that it is used."""
        session = self._sessions.get(_key(secret))
        if session is None or now_s - session.used_s > IDLE_S:
            return None
        session.used_s = now_s
        return session

    def close(self, secret: str) -> Session | None:
        """End a session. Return it."""
        return self._sessions.pop(_key(secret), None)

    def expire(self, now_s: float) -> list[Session]:
        """End the sessions that nobody uses. Return them."""
        late = [key for key, one in self._sessions.items() if now_s - one.used_s > IDLE_S]
        return [self._sessions.pop(key) for key in late]


def _key(secret: str) -> str:
    """A digest, so that the time of a look-up tells nothing of the secret."""
    return hashlib.sha256(secret.encode("utf-8", "replace")).hexdigest()
