# SPDX-License-Identifier: BSD-3-Clause
"""A part of a robot, by name: `""` is the whole robot, `j1` is the joint with everything below it."""

from __future__ import annotations

import re

from unitylink.errors import UnknownName
from unitylink.spec.model import Element, Instance
from unitylink.spec.report.suggest import nearest

_NAME = re.compile(r"\w+(\[\d+\])?(\.\w+(\[\d+\])?)*")
WHOLE = ""  # the subtree that is the whole robot


def subtree(text: str) -> str:
    """Return the subtree that a text names. `j1`, `j1.*` are the same, and so are `*` and the whole robot.

    Raises UnknownName if the text is no name.

    >>> subtree("j1.*"), subtree("*"), subtree("j[2].gain")
    ('j1', '', 'j[2].gain')
    """
    name = text.strip()
    if name in ("*", WHOLE):
        return WHOLE
    name = name.removesuffix(".*")
    if not _NAME.fullmatch(name):
        raise UnknownName(
            f"{text!r} names no part of a robot; write a name of the spec, such as j1 or j1.*, or * for all"
        )
    return name


def contains(outer: str, inner: str) -> bool:
    """Tell whether the subtree `outer` has `inner` in it, or is the same.

    An array contains its members: `j` contains `j[2]`.

    >>> contains("j1", "j1.position"), contains("j1", "j10"), contains("j", "j[2].gain"), contains("", "j1")
    (True, False, True, True)
    """
    return not outer or inner == outer or (inner.startswith(outer) and inner[len(outer)] in ".[")


def overlap(one: str, other: str) -> bool:
    """Tell whether two subtrees have a part in common."""
    return contains(one, other) or contains(other, one)


def shown(name: str) -> str:
    """Return a subtree as texts for people show it.

    >>> shown("j1"), shown("")
    ('j1', 'the whole robot')
    """
    return name or "the whole robot"


def known(root: Instance, name: str) -> str:
    """Return `name` if the robot has this part. Raises UnknownName with the nearest name if it does not."""
    names = _names(root)
    if name in names:
        return name
    near = nearest(name, names)
    raise UnknownName(f"the robot has no part {name!r}" + (f"; did you mean {near}?" if near else ""))


def _names(root: Instance) -> dict[str, None]:
    """Return the path of every instance, array and element, in source order."""
    names: dict[str, None] = {WHOLE: None}

    def collect(instance: Instance) -> None:
        for member in instance.members:
            if not isinstance(member, (Instance, Element)):
                continue
            if member.array:
                names[member.path.removesuffix(f"[{member.index}]")] = None
            names[member.path] = None
            if isinstance(member, Instance):
                collect(member)

    collect(root)
    return names
