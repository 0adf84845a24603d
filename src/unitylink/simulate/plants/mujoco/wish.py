# SPDX-License-Identifier: BSD-3-Clause
"""What the spec, or the TOML beside a model, says about the place of a value."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Element, Instance, Spec
from unitylink.spec.units import unit

ANNOTATION = "mujoco"
PLACES = ("joint", "actuator", "sensor")
KEYS = (*PLACES, "unit", "scale", "sign", "zero")


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
        """Return it with what is said closer to the value. Raises UnityLinkError for what cannot be."""
        _check(said, by)
        made = replace(self, **said)
        if any(key in said for key in PLACES):
            made = replace(made, by=by, own=own, **{key: said.get(key, "") for key in PLACES})
        return made


def wishes(spec: Spec, values: Mapping[str, Any], file: str) -> dict[str, Wish]:
    """Return the wish for each value, by path. The TOML's `values` come after what the spec says.

    Raises UnityLinkError for a key that there is not, and for a name in `values` that no value has.
    """
    found: dict[str, Wish] = {}
    patterns = [(key, _pattern(key), said) for key, said in values.items()]
    used: set[str] = set()
    names: set[str] = set()
    for root in spec.roots:
        for element, noted, above in _of_spec(root, Wish(), ()):
            wish = noted
            names.update((element.path, *above))
            for key, pattern, said in patterns:
                own = pattern.fullmatch(element.path) is not None
                if own or any(pattern.fullmatch(part) for part in above):
                    used.add(key)
                    by = f'{file}, values."{key}"'
                    if not isinstance(said, Mapping):
                        raise UnityLinkError(f'{by}: it is {said!r}; write {{ joint = "…", … }}')
                    wish = wish.with_further(said, by, own and "*" not in key)
            if wish.unit and element.unit:
                raise UnityLinkError(
                    f"{element.path}: it has the unit {element.unit} in the spec; leave the unit "
                    f"{wish.unit} out in {file}"
                )
            found[element.path] = wish
    for key in values:
        if key not in used:
            near = ", ".join(get_close_matches(key, sorted(names), 3, 0.3)) or "none"
            raise UnityLinkError(
                f'{file}, values."{key}": the spec has no value or part of this name; nearest: {near}'
            )
    return found


def _of_spec(
    instance: Instance, wish: Wish, above: tuple[str, ...]
) -> Iterator[tuple[Element, Wish, tuple[str, ...]]]:
    """Yield each value with its annotations, and the paths of the parts around it."""
    wish = _annotated(instance, wish, own=False)
    for member in instance.members:
        if isinstance(member, Element):
            yield member, _annotated(member, wish, own=True), above
        elif isinstance(member, Instance):
            yield from _of_spec(member, wish, (*above, member.path))


def _annotated(item: Element | Instance, wish: Wish, *, own: bool) -> Wish:
    for annotation in item.annotations:
        if annotation.name == ANNOTATION:
            by = f"@{ANNOTATION} of {item.path or item.name}"
            if annotation.values:
                raise UnityLinkError(
                    f"{by}: {annotation.values[0]!r} has no key; there are {', '.join(KEYS)}"
                )
            wish = wish.with_further(dict(annotation.options), by, own)
    return wish


def _pattern(key: str) -> re.Pattern[str]:
    """Return a pattern for paths, in which `*` stands for any text."""
    return re.compile(".*".join(re.escape(text) for text in key.split("*")))


def _check(said: Mapping[str, Any], by: str) -> None:
    for key, value in said.items():
        if key not in KEYS:
            near = ", ".join(get_close_matches(key, KEYS, 1, 0.3)) or ", ".join(KEYS)
            raise UnityLinkError(f"{by}: there is no key {key!r}; nearest: {near}")
        if key in (*PLACES, "unit"):
            if not isinstance(value, str) or not value:
                raise UnityLinkError(f"{by}: {key} is {value!r}; it must be a text")
        elif isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise UnityLinkError(f"{by}: {key} is {value!r}; it must be a number")
    if "sensor" in said and ("joint" in said or "actuator" in said):
        raise UnityLinkError(f"{by}: it names a sensor and something else; name one")
    if said.get("sign", 1) not in (1, -1):
        raise UnityLinkError(f"{by}: sign is {said['sign']}; it must be 1 or -1")
    if said.get("scale", 1) == 0:
        raise UnityLinkError(f"{by}: scale is 0; it must be what one count of the value is")
    if "unit" in said and unit(said["unit"]) is None:
        raise UnityLinkError(f"{by}: there is no unit {said['unit']!r}; some are deg, rad/s, mm, N m")
