# SPDX-License-Identifier: BSD-3-Clause
"""The state of a virtual board and its plant, from which another board goes on (docs/lockstep.md)."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from unitylink.errors import UnityLinkError
from unitylink.interface.components import placed_components
from unitylink.spec.model import Spec

from .registers import Registers

_SAVED_LINKS = ("memory", "tosnet")
_VALUES = ("READ", "WRITE", "READWRITE", "READCLEAR", "W1C")


class _Mark:
    """What stands for an object of the board in the state of its plant."""


_REGISTERS, _COMPONENTS = _Mark(), _Mark()


@dataclass(frozen=True)
class BoardState:
    """Words, plant and the plant's clock. It may be used as often as you like. `Board.save` makes it."""

    words: Mapping[int, int]
    plant: object
    phase: tuple[int, int] | None  # clock of the plant's next step, and clocks until then


def saved_addresses(spec: Spec | None) -> list[int]:
    """Return the addresses of all words of a spec. Raise UnityLinkError if more than words has a state."""
    if spec is None:
        raise UnityLinkError("a board without a spec has no state to save, because its words are not known")
    for component in placed_components(spec):
        raise UnityLinkError(
            f"the state of a component is not saved yet, and this board has {component.entity} "
            f"at {component.base:#06x}; begin anew with reset() instead"
        )
    elements = [element for _, element in spec.walk()]
    for element in elements:
        if element.link.kind not in _SAVED_LINKS:
            raise UnityLinkError(
                f"{element.path} lies in a {element.link.kind}, whose state is not saved yet; "
                "begin anew with reset() instead"
            )
    return [address for element in elements if element.access in _VALUES for address in element.addresses]


def saved_plant(plant: Any, registers: Registers) -> object:
    """Return the state of a plant: what its method `save()` returns, or else a copy of its attributes."""
    if hasattr(plant, "save"):
        return plant.save()
    try:
        own = {id(registers): _REGISTERS, id(registers.components): _COMPONENTS}
        return copy.deepcopy(vars(plant), own)
    except Exception as error:
        name = type(plant).__name__
        raise UnityLinkError(
            f"the state of plant {name} cannot be copied ({error}); give it methods save() and restore(state)"
        ) from error


def restore_plant(plant: Any, state: object, registers: Registers) -> None:
    """Give a plant the state of another one. It is attached already."""
    if hasattr(plant, "restore"):
        plant.restore(state)
    elif isinstance(state, dict):
        own = {id(_REGISTERS): registers, id(_COMPONENTS): registers.components}
        vars(plant).update(copy.deepcopy(state, own))
