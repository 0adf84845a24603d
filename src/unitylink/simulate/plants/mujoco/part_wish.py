# SPDX-License-Identifier: BSD-3-Clause
"""What the spec, or the TOML beside a model, says about the joint of a component."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Any

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Instance

TEXTS = ("joint", "actuator", "sensor", "unit", "motor", "gear", "servo", "stepper", "port")
WHOLE = ("channel", "reverse_channel", "microsteps")
NUMBERS = (
    "scale",
    "zero",
    "ratio",
    "supply_v",
    "below",
    "above",
    "hysteresis",
    "full_scale_a",
    "current_a",
    "efficiency",
    "turn_m",
)
PLACES = ("joint", "actuator", "sensor")
KEYS = (*TEXTS, *WHOLE, *NUMBERS, "sign", "closed_level")


@dataclass(frozen=True)
class PartWish:
    """What is said about a component, or about the part that it is in.

    `said` has the keys by name. `own` are those that are said of the component itself: each of them must have
    a meaning there. `path` is that of the component on the board, `names` are those that its joint may have.
    """

    path: str
    instance: Instance
    names: frozenset[str]
    said: Mapping[str, Any] = field(default_factory=dict)
    own: frozenset[str] = frozenset()
    by: str = ""

    def get(self, key: str, otherwise: Any = None) -> Any:
        """Return what is said under a key."""
        return self.said.get(key, otherwise)

    def with_further(self, said: Mapping[str, Any], by: str, own: bool) -> PartWish:
        """Return it with what is said closer to the component."""
        kept = dict(self.said)
        if any(key in said for key in PLACES):
            kept = {key: value for key, value in kept.items() if key not in PLACES}
        more = frozenset(said) if own else frozenset()
        return replace(self, said={**kept, **said}, own=self.own | more, by=by)

    def check_keys(self, meant: Sequence[str]) -> None:
        """Raise UnityLinkError if something is said of the component itself that has no meaning there."""
        for key in sorted(self.own - set(meant)):
            assert self.instance.component is not None
            raise self.refused(
                f"{key} says nothing about a {self.instance.component.entity}; there are {', '.join(meant)}"
            )

    def refused(self, problem: str) -> UnityLinkError:
        """Return the error for a problem, with who has said what leads to it."""
        return UnityLinkError(f"{self.path}: {self.by}{': ' if self.by else ''}{problem}")


def check_said(said: Mapping[str, Any], by: str, keys: Iterable[str] = KEYS) -> None:
    """Raise UnityLinkError for a key that there is not, and for a value that it cannot have."""
    for key, value in said.items():
        if key not in keys:
            near = ", ".join(get_close_matches(key, keys, 1, 0.3)) or ", ".join(keys)
            raise UnityLinkError(f"{by}: there is no key {key!r}; nearest: {near}")
        if key in TEXTS:
            if not isinstance(value, str) or not value:
                raise UnityLinkError(f"{by}: {key} is {value!r}; it must be a text")
        elif isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise UnityLinkError(f"{by}: {key} is {value!r}; it must be a number")
        elif key in WHOLE and (value != int(value) or value < 0):
            raise UnityLinkError(f"{by}: {key} is {value!r}; it must be a whole number from 0")
    if "sensor" in said and ("joint" in said or "actuator" in said):
        raise UnityLinkError(f"{by}: it names a sensor and something else; name one")
    if said.get("sign", 1) not in (1, -1):
        raise UnityLinkError(f"{by}: sign is {said['sign']}; it must be 1 or -1")
    if said.get("closed_level", 1) not in (0, 1):
        raise UnityLinkError(f"{by}: closed_level is {said['closed_level']}; it must be 0 or 1")
    for key in ("ratio", "efficiency", "turn_m", "supply_v", "full_scale_a", "microsteps", "current_a"):
        if said.get(key, 1) <= 0:
            raise UnityLinkError(f"{by}: {key} is {said[key]}; it must be above 0")
    if said.get("scale", 1) == 0:
        raise UnityLinkError(f"{by}: scale is 0; it must be what one count of the value is")
