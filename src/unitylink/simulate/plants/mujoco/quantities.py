# SPDX-License-Identifier: BSD-3-Clause
"""The units of what a component counts, as the spec says them."""

from __future__ import annotations

from unitylink.spec.model import Element
from unitylink.spec.units import unit

from .part_wish import PartWish

_NO_UNITS = ("", "count")


def si_of_count(wish: PartWish, value: str, si_unit: str) -> float:
    """Return what one count of a value of a component is, in a unit of SI.

    It is that of the spec. If the value has no unit there, `unit` and `scale` of the wish say it. Raises
    UnityLinkError if nobody does, or if it is another quantity.
    """
    element = _element(wish, value)
    own = element.unit
    if own not in _NO_UNITS:
        if wish.get("unit") and "unit" in wish.own:
            raise wish.refused(f"{element.path} has the unit {own} in the spec; leave the unit out")
        found, scale = unit(own), float(element.scale)
    elif wish.get("unit") and wish.get("scale"):
        own = wish.get("unit")
        found, scale = unit(own), float(wish.get("scale")) * float(element.scale)
    else:
        entity = wish.instance.constructor
        raise wish.refused(
            f"{element.path} has no unit, so nobody knows what a count is; write {entity}(scale=0.001 "
            f'{si_unit}), or @mujoco(unit="{si_unit}", scale=0.001)'
        )
    wanted = unit(si_unit)
    if found is None:
        raise wish.refused(f"there is no unit {own!r}; some are deg, rad, mm, N")
    if wanted is None or found.dimension != wanted.dimension:
        raise wish.refused(f"{element.path} has {own}, and does not fit there: {si_unit}")
    return scale * float(found.factor / wanted.factor)


def factor_of(wish: PartWish, si_unit: str, otherwise: str) -> float:
    """Return the factor from the unit that is said, or another one, to SI."""
    said = wish.get("unit", otherwise)
    found, wanted = unit(said), unit(si_unit)
    if found is None or wanted is None or found.dimension != wanted.dimension:
        raise wish.refused(f"{said} does not fit there: {si_unit}")
    return float(found.factor / wanted.factor)


def value_unit(wish: PartWish, value: str) -> str:
    """Return the unit of a value of a component in the spec."""
    return _element(wish, value).unit


def value_offset(wish: PartWish, value: str) -> float:
    """Return what the count 0 of a value of a component is, in its unit."""
    return float(_element(wish, value).offset)


def ratio_of_counts(wish: PartWish, value: str, other: str) -> float:
    """Return what one count of a value is, in counts of another one of the same unit, or of its change."""
    return float(_element(wish, value).scale) / float(_element(wish, other).scale)


def _element(wish: PartWish, value: str) -> Element:
    for element in wish.instance.elements:
        if value in (element.name, element.array):
            return element
    raise wish.refused(f"it has no value {value!r} in this spec")
