# SPDX-License-Identifier: BSD-3-Clause
"""Scopes: what a token allows. `read`, `read j1.*`, `write j1.*`, `arm`, `admin`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Instance

from .subtree import WHOLE, contains, known, subtree

OF_A_PART = ("read", "write")  # these may name a subtree
OF_ALL = ("arm", "admin")


@dataclass(frozen=True)
class Scope:
    """One permission: an action, and the subtree for which it holds."""

    action: str
    part: str = WHOLE

    def __str__(self) -> str:
        return f"{self.action} {self.part}.*" if self.part else self.action


def scope(text: str) -> Scope:
    """Return the scope that a text says. Raises UnityLinkError with the remedy if it says none.

    >>> scope("write j1.*")
    Scope(action='write', part='j1')
    """
    words = text.split()
    if len(words) == 1 and words[0] in OF_A_PART + OF_ALL:
        return Scope(words[0])
    if len(words) == 2 and words[0] in OF_A_PART:
        return Scope(words[0], subtree(words[1]))
    raise UnityLinkError(
        f"{text!r} is no scope; say read, write (of a part of the robot: `write j1.*`), arm or admin"
    )


@dataclass(frozen=True)
class Rights:
    """What one user may do. `write` includes `read` of the same part. `admin` includes everything."""

    scopes: tuple[Scope, ...] = ()

    @classmethod
    def of(cls, texts: Iterable[str]) -> Rights:
        """Return the rights of several scopes.

        >>> rights = Rights.of(["read", "write j1"])
        >>> rights.allow("write", "j1.position"), rights.allow("write", "j2.position")
        (True, False)
        """
        return cls(tuple(dict.fromkeys(scope(text) for text in texts)))

    def allow(self, action: str, part: str = WHOLE) -> bool:
        """Tell whether `action` is allowed for the whole of `part`."""
        granting = {"read": ("read", "write", "admin"), "write": ("write", "admin")}
        actions = granting.get(action, (action, "admin"))
        return any(one.action in actions and contains(one.part, part) for one in self.scopes)

    def check(self, root: Instance) -> None:
        """Raises UnknownName, with the nearest name, if a scope names a part that the robot does not have."""
        for one in self.scopes:
            known(root, one.part)

    def parts(self, action: str) -> tuple[str, ...]:
        """Return the subtrees for which `action` is allowed. None of them is within another."""
        whole = [one for one in self.scopes if self.allow(action, one.part)]
        names = dict.fromkeys(one.part for one in whole)
        return tuple(
            name for name in names if not any(other != name and contains(other, name) for other in names)
        )

    def __str__(self) -> str:
        return ", ".join(map(str, self.scopes)) or "nothing"
