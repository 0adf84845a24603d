# SPDX-License-Identifier: BSD-3-Clause
"""What the spec, or the TOML beside a model, says about the place of a value."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Any, Union

from unitylink.errors import UnityLinkError
from unitylink.interface.joint_names import plain
from unitylink.spec.model import Element, Instance, Spec
from unitylink.spec.units import unit

from .part_wish import KEYS as PART_KEYS
from .part_wish import PLACES, PartWish, check_said

ANNOTATION = "mujoco"
KEYS = (*PLACES, "unit", "scale", "sign", "zero")
Told = tuple[Mapping[str, Any], str]  # what is said, and by whom


@dataclass(frozen=True)
class Wish:
    """The place of a value by name, and its conversion beyond what the spec says.

    `sign` -1 turns the other way. `zero` is the value that it has when the joint of the model is at 0, in its
    own unit. `unit` and `scale` are of a value without a unit. `by` says who names the place, and `own` if
    this is said of the value itself; else it is said of all values of a part, and some may not fit.
    """

    joint: str = ""
    actuator: str = ""
    sensor: str = ""
    unit: str = ""
    scale: float = 1.0
    sign: int = 1
    zero: float = 0.0
    by: str = ""
    own: bool = False

    def place(self, written: bool) -> tuple[str, str]:
        """Return what is named for a value that the PC writes, or reads, and its name; else ("", "")."""
        for kind in ("actuator", "joint") if written else ("sensor", "joint"):
            if getattr(self, kind):
                return kind, getattr(self, kind)
        return "", ""

    def with_further(self, said: Mapping[str, Any], by: str, own: bool) -> Wish:
        """Return it with what is said closer to the value. Raises UnityLinkError for what cannot be.

        What is said of a part may be for the components in it, and then says nothing here.
        """
        check_said(said, by, KEYS if own else PART_KEYS)
        made = replace(self, **{key: value for key, value in said.items() if key in KEYS})
        if any(key in said for key in PLACES):
            made = replace(made, by=by, own=own, **{key: said.get(key, "") for key in PLACES})
        if made.unit and unit(made.unit) is None:
            raise UnityLinkError(f"{by}: there is no unit {made.unit!r}; some are deg, rad/s, mm, N m")
        return made


@dataclass
class Wishes:
    """What is said about values, by path, and about components. One with several channels has several."""

    values: dict[str, Wish] = field(default_factory=dict)
    parts: list[PartWish] = field(default_factory=list)


class _Inside:
    """A place in the spec: what the parts around it say, and the paths and names of these parts."""

    def __init__(self, told: tuple[Told, ...] = (), paths: tuple[str, ...] = ()) -> None:
        self.told, self.paths = told, paths

    def within(self, instance: Instance) -> _Inside:
        told = (*self.told, *_annotations(instance))
        return _Inside(told, (*self.paths, instance.path) if instance.path else self.paths)


def wishes(spec: Spec, values: Mapping[str, Any], file: str) -> Wishes:
    """Return the wishes for values and components. The TOML's `values` come after what the spec says.

    Raises UnityLinkError for a key that there is not, and for a name in `values` that nothing has.
    """
    found, noted = Wishes(), _Noted(values, file)
    for root in spec.roots:
        board_path = f"{root.name}." if len(spec.roots) > 1 else ""
        for item, inside in _items(root, _Inside()):
            if isinstance(item, Element):
                found.values[item.path] = _of_value(item, inside, noted)
            else:
                found.parts += _of_component(item, inside, noted, board_path + item.path)
    noted.check_used()
    return found


def _items(instance: Instance, inside: _Inside) -> Iterator[tuple[Union[Element, Instance], _Inside]]:
    """Yield each value and each component. The values of a component are its own."""
    if instance.component is not None:
        yield instance, inside
        return
    within = inside.within(instance)
    for member in instance.members:
        if isinstance(member, Element):
            yield member, within
        elif isinstance(member, Instance):
            yield from _items(member, within)


def _of_value(element: Element, inside: _Inside, noted: _Noted) -> Wish:
    wish = Wish()
    for said, by in inside.told:
        wish = wish.with_further(said, by, own=False)
    for said, by in _annotations(element):
        wish = wish.with_further(said, by, own=True)
    for told, by, exact in noted.about(element.path, inside.paths):
        if not isinstance(told, Mapping):
            raise UnityLinkError(f'{by}: it is {told!r}; write {{ joint = "…", … }}')
        wish = wish.with_further(told, by, exact)
    if wish.unit and element.unit:
        raise UnityLinkError(
            f"{element.path}: it has the unit {element.unit} in the spec; leave the unit {wish.unit} out"
        )
    return wish


def _of_component(instance: Instance, inside: _Inside, noted: _Noted, path: str) -> list[PartWish]:
    around = inside.paths[-1] if inside.paths else ""
    texts = [instance.path, instance.name, instance.display, around, around.rpartition(".")[2]]
    common = PartWish(path, instance, frozenset(plain(text) for text in texts if text))
    for said, by in inside.told:
        check_said(said, by)
        common = common.with_further(said, by, own=False)
    own = list(_annotations(instance))
    for said, by in own:
        check_said(said, by)
    found = [common.with_further(said, by, own=True) for said, by in own] or [common]
    for told, by, exact in noted.about(instance.path, inside.paths):
        several = told if isinstance(told, list) else [told]
        for said in several:
            if not isinstance(said, Mapping):
                raise UnityLinkError(f'{by}: it is {told!r}; write {{ joint = "…", … }}')
            check_said(said, by)
        if isinstance(told, list):  # a table for each channel
            found = [common.with_further(said, by, exact) for said in several]
        else:
            found = [one.with_further(told, by, exact) for one in found]
    return found


class _Noted:
    """The table `values` of the TOML."""

    def __init__(self, values: Mapping[str, Any], file: str) -> None:
        self._file = file
        self._patterns = [(key, _pattern(key), told) for key, told in values.items()]
        self._used: set[str] = set()
        self._names: set[str] = set()

    def about(self, path: str, above: tuple[str, ...]) -> Iterator[tuple[Any, str, bool]]:
        """Yield what is said about it, by whom, and whether that names it alone."""
        self._names.update((path, *above))
        for key, pattern, told in self._patterns:
            own = pattern.fullmatch(path) is not None
            if own or any(pattern.fullmatch(part) for part in above):
                self._used.add(key)
                yield told, f'{self._file}, values."{key}"', own and "*" not in key

    def check_used(self) -> None:
        """Raise UnityLinkError for a key that is the name of nothing."""
        for key, _, _ in self._patterns:
            if key not in self._used:
                near = ", ".join(get_close_matches(key, sorted(self._names), 3, 0.3)) or "none"
                raise UnityLinkError(
                    f'{self._file}, values."{key}": the spec has no value or part of this name; '
                    f"nearest: {near}"
                )


def _annotations(item: Union[Element, Instance]) -> Iterator[Told]:
    for annotation in item.annotations:
        if annotation.name == ANNOTATION:
            by = f"@{ANNOTATION} of {item.path or item.name}"
            if annotation.values:
                keys = KEYS if isinstance(item, Element) else PART_KEYS
                raise UnityLinkError(
                    f"{by}: {annotation.values[0]!r} has no key; there are {', '.join(keys)}"
                )
            yield dict(annotation.options), by


def _pattern(key: str) -> re.Pattern[str]:
    """Return a pattern for paths, in which `*` stands for any text."""
    return re.compile(".*".join(re.escape(text) for text in key.split("*")))
