# SPDX-License-Identifier: BSD-3-Clause
"""Which value of a spec belongs to which number of a model: as a wish says, or by name, and by unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

from unitylink.errors import UnityLinkError
from unitylink.interface.joint_names import names_of, plain
from unitylink.spec.model import Element, Spec
from unitylink.spec.units import unit

from ...machine import MOTORS, DcMotorData
from ..si_words import SiWord
from . import places
from .couplings import Couplings
from .efforts import NO_EFFORT, Efforts
from .part_kinds import couple
from .places import Place
from .wish import Wish, Wishes, wishes


@dataclass(frozen=True)
class Bound:
    """A value, its place, and the conversion between both."""

    element: Element
    place: Place
    word: SiWord


@dataclass(frozen=True)
class Bindings:
    """What is shown, what is commanded, what components are at, and what belongs to nothing: `notes` of
    values, `free` of a model."""

    seen: tuple[Bound, ...]
    moved: tuple[Bound, ...]
    coupled: Couplings
    notes: tuple[str, ...]
    free: tuple[str, ...]


def bind(
    spec: Spec | None,
    model: Any,
    said: Mapping[str, Any],
    file: str,
    motors: Mapping[str, DcMotorData] | None = None,
) -> Bindings:
    """Find the place of each value, and of each component. `motors` are those that one can name.

    Raises UnityLinkError for what is said and cannot be, and if nothing belongs together.
    """
    found = wishes(spec, said, file) if spec else Wishes()
    wanted = found.values
    coupled = couple(found.parts, model, MOTORS if motors is None else motors)
    walked = [one for root in spec.roots for one in root.walk()] if spec else []
    elements = [one for one in walked if one.path in wanted]  # the others are those of components
    names = {path: found for root in (spec.roots if spec else ()) for path, found in names_of(root).items()}
    notes = list(coupled.notes)
    efforts = Efforts(model, {number for what, number in coupled.driven if what == "joint"})
    measured = [efforts.of(place) for place in places.measured(model)]
    commanded = list(places.commanded(model))
    read = [one for one in elements if not one.writable]
    written = [one for one in elements if one.writable and one.access != "PULSE"]
    of_read, of_written = (
        _Finder(measured, names, wanted, False, notes),
        _Finder(commanded, names, wanted, True, notes, taken=coupled.driven),
    )
    seen, moved = tuple(of_read.found(read)), tuple(of_written.found(written))
    if not seen and not moved and not coupled.drives and not coupled.senses:
        joints = ", ".join(place.name for place in measured if place.what == "position") or "none"
        values = ", ".join(one.path for one in elements[:8]) or "none"
        raise UnityLinkError(
            f"plant mujoco:{file}: no joint belongs to a value. Its joints: {joints}. Values of "
            f"the spec: {values}. They belong together by name and unit (docs/mujoco.md)"
        )
    free = (
        *of_read.free_places([one.path for one in read], coupled.shown),
        *of_written.free_places([one.path for one in written]),
    )
    return Bindings(seen, moved, coupled, tuple(notes), free)


class _Finder:
    """Finds the places of values that are all read, or all written."""

    def __init__(
        self,
        among: Sequence[Place],
        names: Mapping[str, set[str]],
        wanted: Mapping[str, Wish],
        written: bool,
        notes: list[str],
        *,
        taken: Mapping[tuple[str, int], str] = MappingProxyType({}),
    ) -> None:
        self._places = among
        self._names = names
        self._wanted = wanted
        self._written = written
        self._notes = notes
        self._taken = dict(taken)  # the path of the value, or of the component, there

    def found(self, elements: Sequence[Element]) -> Iterator[Bound]:
        """Yield each value that has a place. Those that are said come first. Note the others."""
        rest = []
        for element in elements:
            bound = self._as_said(element)
            if bound is None:
                rest.append(element)
            else:
                yield bound
        for element in rest:
            bound = self._by_name(element)
            if bound is not None:
                yield bound

    def _as_said(self, element: Element) -> Bound | None:
        wish = self._wanted[element.path]
        kind, name = wish.place(self._written)
        if not kind:
            if wish.own and wish.by:
                what = "the PC reads it; name a joint or a sensor"
                raise UnityLinkError(
                    f"{element.path}: {wish.by}: "
                    + ("the PC writes it; name a joint or an actuator" if self._written else what)
                )
            return None
        own = self._called(kind, name)
        if not own and kind == "joint" and self._written and not wish.own:
            return None  # a joint without an actuator has no place for what the PC writes
        if not own:
            there = sorted({_name_of(place, kind) for place in self._places} - {""})
            near = get_close_matches(name, there, 3, 0.3) or there[:3]
            what = (
                f"{kind} {name!r}" if kind != "joint" or not self._written else f"actuator at joint {name!r}"
            )
            raise UnityLinkError(
                f"{element.path}: {wish.by}: the model has no {what}; nearest: {', '.join(near) or 'none'}"
            )
        fitting = [place for place in own if _factor(element, place, wish.unit) is not None]
        free = [place for place in fitting if (place.what, place.index) not in self._taken]
        if fitting and not free and self._written:
            other = self._taken[fitting[0].what, fitting[0].index]
            raise UnityLinkError(
                f"{element.path}: {wish.by}: {other} commands the {fitting[0]} already; name another"
            )
        if fitting:
            place = (free or fitting)[0]
            return None if self._has_no_effort(element, place, wish) else self._made(element, place, wish)
        if wish.own:
            has = ", ".join(dict.fromkeys(str(place) for place in own))
            unit_there = wish.unit or element.unit or "no unit"
            raise UnityLinkError(
                f"{element.path}: {wish.by}: it has {unit_there} in {element.words} words, and does not fit "
                f"there: {has}"
            )
        return None

    def _called(self, kind: str, name: str) -> list[Place]:
        return [place for place in self._places if _name_of(place, kind) == name]

    def _by_name(self, element: Element) -> Bound | None:
        names, wish = self._names[element.path], self._wanted[element.path]
        fitting = [place for place in self._places if _factor(element, place, wish.unit) is not None]
        named = [place for place in fitting if plain(place.name) in names]
        named.sort(key=lambda place: place.what == NO_EFFORT)  # a sensor of this name has it
        has = wish.unit or element.unit
        if named:
            place = named[0]
            if self._has_no_effort(element, place, wish):
                return None
            if (place.what, place.index) not in self._taken:
                return self._made(element, place, wish)
            self._notes.append(
                f"{element.path} is left out, because {self._taken[place.what, place.index]} belongs to "
                f"{place.name}, too"
            )
        elif other := [p for p in self._places if plain(p.name) in names and p.what == "sensor"]:
            self._notes.append(
                f"{element.path} is left out: it has {has or 'no unit'}, and the sensor "
                f"{other[0].name} measures {other[0].unit or 'a number of one word'}"
            )
        elif fitting and has:
            near = get_close_matches(element.path, sorted({place.name for place in fitting}), 3, 0.3)
            self._notes.append(
                f"{element.path} belongs to nothing in the model; nearest: {', '.join(near) or 'none'}"
            )
        return None

    def _has_no_effort(self, element: Element, place: Place, wish: Wish) -> bool:
        """Is it the effort of a joint that nothing pushes? Note it. Raise UnityLinkError if it is wished."""
        if place.what != NO_EFFORT:
            return False
        problem = (
            f"joint {place.joint} has no actuator, and no component drives it, so its effort would read 0 "
            "for ever; give it a motor, or read a torque sensor"
        )
        if wish.own:
            raise UnityLinkError(f"{element.path}: {wish.by}: {problem}")
        self._notes.append(f"{element.path} is left out: {problem}")
        return True

    def _made(self, element: Element, place: Place, wish: Wish) -> Bound:
        self._taken.setdefault((place.what, place.index), element.path)
        factor = _factor(element, place, wish.unit)
        assert factor is not None  # it has been looked at before
        factor *= wish.scale
        if place.what == "limit":
            return Bound(element, place, SiWord(element, factor))
        kind = element.type.kind
        if (
            place.what in ("velocity", "effort", "push")
            and kind in ("uint", "ufixed")
            and element.offset >= 0
        ):
            return Bound(element, place, SiWord(element, factor, amount=True))  # it cannot be negative
        factor *= wish.sign
        zero = wish.zero / wish.scale if place.at_zero else 0.0
        return Bound(element, place, SiWord(element, factor, -factor * zero))

    def free_places(self, paths: list[str], shown: Iterable[tuple[str, int]] = ()) -> Iterator[str]:
        """Yield a note for each joint and actuator without a value, with the nearest of these paths."""
        told = {*self._taken, *shown}
        for place in self._places:
            key = place.what, place.index
            if place.what in ("position", "actuator") and place.name and key not in told:
                what = "shows the position of joint" if place.what == "position" else "drives the actuator"
                near = ", ".join(get_close_matches(place.name, paths, 3, 0.3)) or "none"
                yield f"no value {what} {place.name}; nearest: {near}"
            told.add(key)


def _name_of(place: Place, kind: str) -> str:
    """Return the name of a place as a joint, an actuator or a sensor, or "" if it is none."""
    if kind == "joint":
        return place.joint
    return place.name if place.what == kind or (kind, place.what) == ("actuator", "limit") else ""


def _factor(element: Element, place: Place, other_unit: str) -> float | None:
    """Return the factor from a value to SI, or None if it cannot be this number of the model."""
    own = unit(element.unit or other_unit)
    kind = element.type
    if (
        not kind.numeric
        or (kind.kind == "float" and kind.width != 32)
        or len(element.addresses) != 1
        or (own is not None and own.offset)
    ):
        return None
    if place.unit is None or (place.what == "sensor" and own is None):
        return float(own.factor) if own is not None else 1.0
    si = unit(place.unit)
    if own is None or si is None or own.dimension != si.dimension:
        return None
    return float(own.factor / si.factor)
