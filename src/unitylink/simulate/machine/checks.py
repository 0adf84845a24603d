# SPDX-License-Identifier: BSD-3-Clause
"""What a figure of a datasheet may be. A wrong one is refused by its name, with what to do."""

from __future__ import annotations

import math
from numbers import Real

from unitylink.errors import ValueRangeError


def check_number(
    owner: str, name: str, value: float, *, least: float | None = None, remedy: str = ""
) -> float:
    """Return `value` as a float. Raise ValueRangeError unless it is a finite number from `least` on."""
    if not _is_number(value) or (least is not None and value < least):
        wanted = "a number" if least is None else f"a number from {least:g}"
        raise _refused(owner, name, value, wanted, remedy)
    return float(value)


def check_positive(owner: str, name: str, value: float, *, remedy: str = "") -> float:
    """Return `value` as a float. Raise ValueRangeError unless it is a finite number above 0."""
    if not _is_number(value) or value <= 0:
        raise _refused(owner, name, value, "a number above 0", remedy)
    return float(value)


def check_share(owner: str, name: str, value: float, *, above: bool = False, remedy: str = "") -> float:
    """Return `value` as a float. Raise ValueRangeError unless it is from 0 to 1, or `above` 0."""
    if not _is_number(value) or not 0 <= value <= 1 or (above and value == 0):
        raise _refused(owner, name, value, "above 0, up to 1" if above else "from 0 to 1", remedy)
    return float(value)


def check_whole(owner: str, name: str, value: int, *, least: int = 1, remedy: str = "") -> int:
    """Return `value`. Raise ValueRangeError unless it is a whole number from `least` on."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise _refused(owner, name, value, f"a whole number from {least}", remedy)
    return value


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


def _refused(owner: str, name: str, value: object, wanted: str, remedy: str) -> ValueRangeError:
    return ValueRangeError(
        f"{owner}: {name} is {value!r}; it must be {wanted}{'; ' if remedy else ''}{remedy}"
    )
