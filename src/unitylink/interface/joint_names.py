# SPDX-License-Identifier: BSD-3-Clause
"""By which names the joint of a robot's model (URDF, MJCF) may be called in a spec."""

from __future__ import annotations

import re
from collections.abc import Iterator

from unitylink.spec.model import Instance


def names_of(root: Instance) -> dict[str, set[str]]:
    """Return for each item the names by which a joint may be called."""
    found: dict[str, set[str]] = {}
    for instance in _instances(root):
        part = {
            plain(instance.path),
            plain(instance.path.rpartition(".")[2]),
            plain(instance.display or ""),
        }
        for element in instance.elements:
            own = {plain(element.path), plain(element.name), plain(element.display or "")}
            found[element.path] = (own | (part if instance is not root else set())) - {""}
    return found


def _instances(root: Instance) -> Iterator[Instance]:
    yield root
    for below in root.instances:
        yield from _instances(below)


def plain(name: str) -> str:
    """Return a name without what differs between models of robots and specs.

    >>> plain("leg[2].Hip"), plain("shoulder_joint")
    ('leg_2_hip', 'shoulder')
    """
    text = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    return text.removesuffix("_joint").removeprefix("joint_") or text
