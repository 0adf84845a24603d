# SPDX-License-Identifier: BSD-3-Clause
"""A JSON file whose values know their places. A wrong one is an error that names the place."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..failure import Failure


class Node:
    """A value of the file and its place, such as `plugins[3].pins.step`.

    Keys that are asked for count as taken. `left` yields the others.
    """

    def __init__(self, file: str, place: str, value: Any) -> None:
        self.file, self.place, self.value = file, place, value
        self._inner: dict[str, Node] = {}
        self._taken: set[str] = set()

    def get(self, key: str) -> Node | None:
        """Return the member `key` of an object. None: it is absent, null or empty."""
        self._taken.add(key)
        if key not in self._inner:
            place = f"{self.place}.{key}" if self.place else key
            self._inner[key] = Node(self.file, place, self.object().get(key))
        found = self._inner[key]
        return None if found.value in (None, "", [], {}) else found

    def object(self) -> dict[str, Any]:
        """Return the members of an object."""
        if not isinstance(self.value, dict):
            raise self.wrong("an object { } is expected")
        return self.value

    def members(self) -> Iterator[tuple[str, Node]]:
        """Yield the members of an object that are not empty."""
        for key in self.object():
            if (found := self.get(key)) is not None:
                yield key, found

    def rows(self) -> list[Node]:
        """Return the elements of a list."""
        if not isinstance(self.value, list):
            raise self.wrong("a list [ ] is expected")
        return [Node(self.file, f"{self.place}[{i}]", value) for i, value in enumerate(self.value)]

    def text(self, key: str, default: str = "") -> str:
        """Return a text. A number counts as one, because pins are often numbers."""
        found = self.get(key)
        if found is None:
            return default
        if isinstance(found.value, bool) or not isinstance(found.value, (str, int)):
            raise found.wrong("a text is expected")
        return str(found.value).strip()

    def give_back(self, key: str) -> None:
        """Count `key` as not taken."""
        self._taken.discard(key)

    def number(self, key: str, default: float | None = None) -> float | None:
        """Return a number, also one that is written as a text."""
        found = self.get(key)
        if found is None:
            return default
        try:
            number = math.nan if isinstance(found.value, bool) else float(found.value)
        except (TypeError, ValueError, OverflowError):
            number = math.nan
        if not math.isfinite(number):
            raise found.wrong("a number is expected")
        return number

    def flag(self, key: str) -> bool:
        """Return true or false. An absent one is false."""
        found = self.get(key)
        if found is not None and not isinstance(found.value, bool):
            raise found.wrong("true or false is expected")
        return found is not None and bool(found.value)

    def left(self) -> Iterator[Node]:
        """Yield what nobody has asked for, from the outside to the inside."""
        for key in self.object():
            inner = self._inner.get(key)
            if key not in self._taken:
                self.get(key)
                yield self._inner[key]
            elif inner is not None and isinstance(inner.value, dict):
                yield from inner.left()

    def wrong(self, why: str, remedy: str = "") -> Failure:
        """Return the error that this value is."""
        shown = json.dumps(self.value)
        shown = shown if len(shown) <= 40 else f"{shown[:37]}..."
        return Failure(f"{self.file}: {self.place or 'the file'}: {why}, not {shown}", remedy)


def read_document(path: str) -> Node:
    """Return the contents of a JSON file. Raises Failure with the place of the mistake."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise Failure(f"{path}: {error.strerror}") from None
    try:
        return Node(path, "", json.loads(data.decode(), object_pairs_hook=_unique, parse_constant=_refused))
    except UnicodeDecodeError as error:
        raise Failure(f"{path}: byte {error.start} is not UTF-8") from None
    except json.JSONDecodeError as error:
        raise Failure(f"{path}:{error.lineno}:{error.colno}: no JSON: {error.msg}") from None
    except ValueError as error:  # of the two functions below, and of a number with thousands of digits
        raise Failure(f"{path}: {error}") from None
    except RecursionError:
        raise Failure(f"{path}: its lists and objects are nested too deeply") from None


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{twice!r} stands twice in one object")
    return found


def _refused(text: str) -> Any:
    raise ValueError(f"{text} is no number of JSON")
