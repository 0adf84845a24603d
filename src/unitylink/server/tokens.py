# SPDX-License-Identifier: BSD-3-Clause
"""Tokens: how a user of a server says who he is. `token_file` reads a file of them."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from unitylink.errors import UnityLinkError, UnknownName
from unitylink.spec.model import Instance

from .scopes import Rights
from .subtree import known

LEAST = 16  # characters of a token that somebody has chosen


@dataclass(frozen=True)
class User:
    """A user that a token stands for. `expires_s` is in s since 1970 in UTC, or None for never.

    `place` is where a file says what he may.
    """

    name: str
    rights: Rights
    expires_s: float | None = None
    place: str = ""


def new_token() -> str:
    """Return a fresh token: 256 random bits as 43 letters, digits, - and _."""
    return secrets.token_urlsafe(32)


def chosen_token(token: str) -> str:
    """Return a token that somebody has chosen. Raises UnityLinkError if it is easy to guess, or no token.

    >>> chosen_token("correct-horse-battery-staple")
    'correct-horse-battery-staple'
    """
    if not token.isascii() or not token.isprintable() or " " in token:
        raise UnityLinkError("the token is not one word of printable ASCII characters")
    if len(token) < LEAST:
        raise UnityLinkError(f"the token has {len(token)} characters; it needs {LEAST}, or others guess it")
    return token


def digest(token: str) -> str:
    """Return what a token file holds of a token.

    >>> digest("test")
    '9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08'
    """
    return hashlib.sha256(token.encode("utf-8", "surrogatepass")).hexdigest()


class Tokens:
    """The tokens that a server accepts.

    >>> tokens = Tokens([(digest("secret"), User("ana", Rights.of(["read"])))])
    >>> tokens.user("secret", now_s=0.0).name, tokens.user("guess", now_s=0.0)
    ('ana', None)
    """

    def __init__(self, entries: Iterable[tuple[str, User]]) -> None:
        self._entries = tuple(entries)

    def user(self, token: str, now_s: float) -> User | None:
        """Return the user of a token, or None if it is unknown or has expired at `now_s` (s since 1970).

        The time that it takes does not tell which token is nearly right.
        """
        found = None
        shown = digest(token)
        for expected, user in self._entries:
            if hmac.compare_digest(expected, shown):
                found = user
        if found is None or (found.expires_s is not None and now_s >= found.expires_s):
            return None
        return found

    def names(self) -> tuple[str, ...]:
        """Return the names of the users."""
        return tuple(user.name for _, user in self._entries)

    def vain_scopes(self, root: Instance) -> Iterator[str]:
        """Yield a warning for each scope of a part that this robot does not have: it allows nothing.

        That is no error, because several robots may share a file of tokens.
        """
        for user in (user for _, user in self._entries):
            for scope in user.rights.scopes:
                try:
                    known(root, scope.part)
                except UnknownName as error:
                    yield f"{user.place or user.name}: `{scope}` allows nothing: {error}"

    def with_user(self, token: str, user: User) -> Tokens:
        """Return the same with one more user."""
        return Tokens((*self._entries, (digest(token), user)))

    def __len__(self) -> int:
        return len(self._entries)
