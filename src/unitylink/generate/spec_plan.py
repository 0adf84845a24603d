# SPDX-License-Identifier: BSD-3-Clause
"""What all artefacts of a spec share: the spec, its gateware, and the plans made from both."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar, Union, cast

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec.model import Spec

# the gateware: all of it, or only the fields that differ
Chosen = Union[BoardConfiguration, Mapping[str, Any], None]
R = TypeVar("R")


class SpecPlan:
    """A spec on its way to files. Each plan is made at its first use, and later artefacts get the same one.

    `configuration` is the gateware of the VHDL, or only the fields that differ from the spec's.

    >>> from unitylink.spec import compile_text
    >>> plan = SpecPlan(compile_text("public lamp() { @led = 0x10: WRITE(); }", "lamp.ul").spec)
    >>> def words(plan: SpecPlan) -> list[str]:
    ...     return [path for path, _ in plan.spec.walk()]
    >>> plan.part(words), plan.part(words) is plan.part(words)
    (['led'], True)
    """

    def __init__(self, spec: Spec, configuration: Chosen = None) -> None:
        self.spec = spec
        self.configuration = configuration
        self._parts: dict[Callable[[SpecPlan], Any], Any] = {}

    def part(self, planner: Callable[[SpecPlan], R]) -> R:
        """Return `planner(self)`, which is called only once. The caller must not change the result."""
        if planner not in self._parts:
            self._parts[planner] = planner(self)
        return cast(R, self._parts[planner])
