# SPDX-License-Identifier: BSD-3-Clause
"""What a plant was before it was attached, so that its board can begin anew."""

from __future__ import annotations

import copy
from typing import Any

from unitylink.errors import UnityLinkError


class PlantStart:
    """A copy of the attributes of a plant. One with a method `reset()` puts itself back."""

    def __init__(self, plant: Any) -> None:
        self._plant = plant
        self._attributes: dict[str, Any] | None = None
        self._problem: Exception | None = None
        if not hasattr(plant, "reset"):
            try:
                self._attributes = copy.deepcopy(vars(plant))
            except Exception as error:  # it matters only if somebody wants to reset
                self._problem = error

    def check(self) -> None:
        """Raise UnityLinkError if the plant cannot be put back."""
        if self._problem is not None:
            name = type(self._plant).__name__
            raise UnityLinkError(
                f"plant {name} cannot be put back, because it cannot be copied ({self._problem}); give it a "
                "method reset()"
            ) from self._problem

    def made(self, seed: int | None) -> Any:
        """Return the plant as it was, with a seed if it takes one."""
        plant = self._plant
        if self._attributes is None:
            plant.reset()
        else:
            vars(plant).clear()
            vars(plant).update(copy.deepcopy(self._attributes))
        if seed is not None and hasattr(plant, "seed"):  # others are the same each time
            plant.seed(seed)
        return plant
