# SPDX-License-Identifier: BSD-3-Clause
"""A file of tokens: the TOML text, and its mistakes, each with its line and its remedy.

It holds only digests, so whoever reads it cannot log in with it. A token has 256 random bits, so a plain
digest is enough.

    [[token]]
    name = "ana"
    sha256 = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
    scopes = ["read", "write j1.*"]
    expires = 2027-01-31
"""

from __future__ import annotations

import datetime
import os
import re
import stat
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from unitylink.errors import UnityLinkError

from .scopes import Rights
from .tokens import Tokens, User

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_KEYS = ("name", "sha256", "scopes", "expires")
_NAME = re.compile(r"[\w.@-]{1,64}")  # printable in logs, metrics and pages without quoting
_DIGEST = re.compile(r"[0-9a-f]{64}")
_HEAD = re.compile(r"\s*\[\[\s*[\"']?token[\"']?\s*\]\]")


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
    lines = text.split("\n")
    if surplus := sorted(set(data) - {"token"}):
        place = _Place(path, lines, range(len(lines))).of(surplus[0])
        raise UnityLinkError(f"{place}: {surplus[0]} is unknown; a token file has [[token]] alone")
    entries = data.get("token", [])
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise UnityLinkError(f"{path}: token is no list; begin each token with [[token]]")
    if not entries:
        raise UnityLinkError(f"{path}: there is no [[token]] in it, so nobody could log in")
    places = _places(path, lines, len(entries))
    made = [_entry(place, entry) for place, entry in zip(places, entries, strict=True)]
    for key, texts in (("name", [user.name for _, user in made]), ("sha256", [one for one, _ in made])):
        for number, one in enumerate(texts):
            if one in texts[:number]:
                raise UnityLinkError(f"{places[number].of(key)}: two tokens have the {key} {one}; remove one")
    return Tokens(made)


@dataclass(frozen=True)
class _Place:
    """Where an entry is: in `rows` of `lines`, which begin at 0. `entry` is what it is called."""

    path: str
    lines: list[str]
    rows: range
    entry: str = ""

    def of(self, key: str) -> str:
        """Return where a key is, for an error. If no line begins with it, that is where the entry begins."""
        begin = re.compile(rf"\s*\[*\s*[\"']?{re.escape(key)}(?![\w-])")
        rows = [row for row in self.rows if begin.match(self.lines[row])] or self.rows[:1]
        where = [f"{self.path}, line {rows[0] + 1}" if rows else self.path]
        return ": ".join(where + [self.entry] * bool(self.entry))


def _places(path: str, lines: list[str], entries: int) -> list[_Place]:
    """Return where each entry is. Who writes `token = [{...}]` is told no lines, only which entry it is."""
    heads = [row for row, line in enumerate(lines) if _HEAD.match(line)]
    if len(heads) != entries:
        return [_Place(path, lines, range(0), f"token {number}") for number in range(1, entries + 1)]
    ends = [*heads[1:], len(lines)]
    return [
        _Place(path, lines, range(head, end), f"token {number}")
        for number, (head, end) in enumerate(zip(heads, ends, strict=True), 1)
    ]


def _entry(place: _Place, data: dict[str, Any]) -> tuple[str, User]:
    if surplus := sorted(set(data) - set(_KEYS)):
        raise UnityLinkError(f"{place.of(surplus[0])}: {surplus[0]} is unknown; expected {', '.join(_KEYS)}")
    name = data.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise UnityLinkError(
            f"{place.of('name')}: name is {name!r}; expected 1 to 64 letters, digits, and any of . @ - _"
        )
    place = replace(place, entry=f"{place.entry} ({name})")
    sha256 = data.get("sha256")
    if not isinstance(sha256, str) or not _DIGEST.fullmatch(sha256):
        remedy = f"`unitylink token {name}` makes a token and prints this entry"
        raise UnityLinkError(f"{place.of('sha256')}: sha256 is no digest; {remedy}")
    scopes, where = data.get("scopes"), place.of("scopes")
    if not isinstance(scopes, list) or not scopes or not all(isinstance(one, str) for one in scopes):
        raise UnityLinkError(f'{where}: scopes is no list of texts; expected for example ["read"]')
    try:
        rights = Rights.of(scopes)
    except UnityLinkError as error:
        raise UnityLinkError(f"{where}: {error}") from error
    return sha256, User(name, rights, _expiry(place, data.get("expires")), where)


def _expiry(place: _Place, value: object) -> float | None:
    """Return the moment at which a token ends, in s since 1970. A day ends where it begins in UTC."""
    if value is None:
        return None
    if isinstance(value, datetime.datetime):
        moment = value if value.tzinfo else value.replace(tzinfo=datetime.timezone.utc)
    elif isinstance(value, datetime.date):
        moment = datetime.datetime.combine(value, datetime.time(), datetime.timezone.utc)
    else:
        raise UnityLinkError(
            f"{place.of('expires')}: expires is {value!r}; expected a day, such as 2027-01-31"
        )
    return moment.timestamp()
