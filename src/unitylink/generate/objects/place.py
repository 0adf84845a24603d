# SPDX-License-Identifier: BSD-3-Clause
"""An expansion of a constructor, and where its values are in the robot's table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from unitylink.spec.model import Element, Instance

from .facts import RobotFacts


@dataclass(frozen=True)
class Place:
    """An expansion: the robot, the instance, and the place of its first value in the robot's table."""

    facts: RobotFacts
    instance: Instance
    first: int

    @cached_property
    def positions(self) -> dict[str, int]:
        """The path of each value -> its place, counted from the first."""
        return {element.path: position for position, element in enumerate(self.instance.walk())}

    @cached_property
    def firsts(self) -> dict[str, int]:
        """The path of each part -> the place of its first value, counted from the first."""
        return {part.path: first - self.first for part, first in self.parts()}

    def parts(self) -> Iterator[tuple[Instance, int]]:
        """Yield the parts, with the place of the first value of each in the robot's table."""
        at = self.first
        for member in self.instance.members:
            if isinstance(member, Instance):
                yield member, at
                at += sum(1 for _ in member.walk())
            elif isinstance(member, Element):
                at += 1

    def takes(self, element: Element, *, sampled: bool) -> bool:
        """Return whether a set of inputs (`sampled`) or of outputs has this value."""
        return self.facts.sampled(element) if sampled else self.facts.commanded(element)
