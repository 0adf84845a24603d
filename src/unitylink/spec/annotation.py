# SPDX-License-Identifier: BSD-3-Clause
"""Free notes in a spec, such as `@ros(type="JointState")`. Every generator gets them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Union

AnnotationValue = Union[int, float, str, bool]


@dataclass(frozen=True)
class Annotation:
    """`@name(values, key=value)`. `values` are those without a key.

    >>> Annotation("ros", (), (("type", "JointState"),)).get("type")
    'JointState'
    """

    name: str
    values: tuple[AnnotationValue, ...] = ()
    options: tuple[tuple[str, AnnotationValue], ...] = ()

    def get(self, key: str, default: AnnotationValue | None = None) -> AnnotationValue | None:
        """Return the value of an option, or `default`."""
        return next((value for name, value in self.options if name == key), default)
