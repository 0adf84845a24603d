# SPDX-License-Identifier: BSD-3-Clause
"""Tokens: how a user of a server says who he is.

A token file is TOML. It holds only digests, so whoever reads it cannot log in with it. A token has 256 random
bits, so a plain digest is enough.

    [[token]]
    name = "ana"
    sha256 = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
    scopes = ["read", "write j1.*"]
    expires = 2027-01-31
"""

from __future__ import annotations

import datetime
import hashlib
import hmac
import os
import re
import secrets
import stat
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unitylink.errors import UnityLinkError

from .scopes import Rights

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LEAST = 16  # characters of a token that somebody has chosen
_KEYS = ("name", "sha256", "scopes", "expires")
_NAME = re.compile(r"[\w.@-]{1,64}")  # printable in logs, metrics and pages without quoting
_DIGEST = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True)
class User:
    """A user that a token stands for. `expires_s` is in s since 1970 in UTC, or None for never."""

    name: str
    rights: Rights
    expires_s: float | None = None


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

    def with_user(self, token: str, user: User) -> Tokens:
        """Return the same with one more user."""
        return Tokens((*self._entries, (digest(token), user)))

    def __len__(self) -> int:
        return len(self._entries)


def load_tokens(path: str | Path) -> Tokens:
    """Return the tokens of a file. Raises UnityLinkError with the place and the remedy.

    A file that other users of the machine may write is refused.
    """
    file = Path(path)
    try:
        with file.open("rb") as stream:
            if os.fstat(stream.fileno()).st_mode & (stat.S_IWGRP | stat.S_IWOTH):
                raise UnityLinkError(
                    f"{path}: other users of this machine may write it; run chmod go-w {path}"
                )
            text = stream.read().decode("utf-8")
    except OSError as error:
        remedy = f"`unitylink token NAME read --file {path}` makes one"
        raise UnityLinkError(f"{path}: {error.strerror or error}; {remedy}") from error
    except ValueError as error:
        raise UnityLinkError(f"{path}: {error}") from error
    return parse_tokens(text, str(path))


def parse_tokens(text: str, path: str) -> Tokens:
    """Return the tokens of the text of a file. `path` names it in errors."""
    try:
        data: dict[str, Any] = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise UnityLinkError(f"{path}: {error}") from error
    if surplus := sorted(set(data) - {"token"}):
        raise UnityLinkError(f"{path}: {surplus[0]} is unknown; a token file has [[token]] alone")
    entries = data.get("token", [])
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise UnityLinkError(f"{path}: token is no list; begin each token with [[token]]")
    if not entries:
        raise UnityLinkError(f"{path}: there is no [[token]] in it, so nobody could log in")
    made = [_entry(f"{path}: token {number}", entry) for number, entry in enumerate(entries, 1)]
    for kind, texts in (("name", [user.name for _, user in made]), ("sha256", [one for one, _ in made])):
        if twice := next((text for text in texts if texts.count(text) > 1), None):
            raise UnityLinkError(f"{path}: two tokens have the {kind} {twice}")
    return Tokens(made)


def _entry(place: str, data: dict[str, Any]) -> tuple[str, User]:
    if surplus := sorted(set(data) - set(_KEYS)):
        raise UnityLinkError(f"{place}: {surplus[0]} is unknown; expected {', '.join(_KEYS)}")
    name = data.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise UnityLinkError(
            f"{place}: name is {name!r}; expected 1 to 64 letters, digits, and any of . @ - _"
        )
    place = f"{place} ({name})"
    sha256 = data.get("sha256")
    if not isinstance(sha256, str) or not _DIGEST.fullmatch(sha256):
        raise UnityLinkError(
            f"{place}: sha256 is no digest; `unitylink token {name}` makes a token and prints this entry"
        )
    scopes = data.get("scopes")
    if not isinstance(scopes, list) or not scopes or not all(isinstance(one, str) for one in scopes):
        raise UnityLinkError(f'{place}: scopes is no list of texts; expected for example ["read"]')
    try:
        rights = Rights.of(scopes)
    except UnityLinkError as error:
        raise UnityLinkError(f"{place}: {error}") from error
    return sha256, User(name, rights, _expiry(place, data.get("expires")))


def _expiry(place: str, value: object) -> float | None:
    """Return the moment at which a token ends, in s since 1970. A day ends where it begins in UTC."""
    if value is None:
        return None
    if isinstance(value, datetime.datetime):
        moment = value if value.tzinfo else value.replace(tzinfo=datetime.timezone.utc)
    elif isinstance(value, datetime.date):
        moment = datetime.datetime.combine(value, datetime.time(), datetime.timezone.utc)
    else:
        raise UnityLinkError(f"{place}: expires is {value!r}; expected a day, such as 2027-01-31")
    return moment.timestamp()
