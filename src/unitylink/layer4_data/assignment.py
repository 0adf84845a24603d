# SPDX-License-Identifier: BSD-3-Clause
"""The error for an assignment to an object of a robot. Python would replace the object and write nothing."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NoReturn

from unitylink.errors import AssignmentError, shown

from .html import values_html
from .value import Value

_METHODS = {"WRITE": "write", "READWRITE": "write", "PULSE": "pulse", "W1C": "clear"}


def refuse(path: str, held: object, value: object) -> NoReturn:
    """Raise AssignmentError for `path = value`. It names the method that writes.

    >>> refuse("j1.pos_sp", robot.j1.pos_sp, 3)  # doctest: +SKIP
    Traceback (most recent call last):
    unitylink.errors.AssignmentError: j1.pos_sp cannot be replaced by 3; write it: j1.pos_sp.write(3)
    """
    text = shown(value)
    if isinstance(held, Value):
        method = _METHODS.get(held.access)
        remedy = f"write it: {path}.{method}({text})" if method else f"it is a {held.access}: {path}.read()"
    elif isinstance(held, tuple):
        remedy = f"it is an array: write its parts, such as {path}[0]"
    elif callable(getattr(held, "write", None)):
        remedy = f"write its values: {path}.write(...)"
    else:
        remedy = "write a value of it by the value's own methods"
    raise AssignmentError(f"{path} cannot be replaced by {text}; {remedy}")


class Array(tuple[Any, ...]):
    """The members of an array of the spec: a tuple whose error says how to write a member."""

    path: str

    def __new__(cls, path: str, parts: Iterable[Any]) -> Array:
        """`path` is its name in errors."""
        array = super().__new__(cls, parts)
        array.path = path
        return array

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the values of all members."""
        members = ((part,) if isinstance(part, Value) else part for part in self)
        return values_html(self.path, (value for part in members for value in part))

    def __setitem__(self, index: int, value: object) -> None:
        """Refuse the assignment, because a write was probably meant."""
        refuse(f"{self.path}[{index!r}]", self[index] if isinstance(index, int) else self, value)
