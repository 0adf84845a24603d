# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the numbers that callers give. Anything else raises ValueRangeError before anything is sent."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from contextlib import suppress

from unitylink.errors import ValueRangeError, shown


def whole(what: str, value: object) -> int:
    """Return a whole number. One of numpy's is accepted, too. `what` is its name in the error.

    >>> whole("fifo: limit", 1.5)
    Traceback (most recent call last):
    unitylink.errors.ValueRangeError: fifo: limit: 1.5 is not a whole number
    """
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ValueRangeError(f"{what}: {shown(value)} is not a whole number") from None


def wholes(what: str, values: Iterable[object]) -> list[int]:
    """Return the whole numbers of a sequence. A text is no sequence of numbers."""
    try:
        if isinstance(values, (str, bytes)):
            raise TypeError
        given = list(values)
    except TypeError:
        raise ValueRangeError(f"{what}: {shown(values)} is not a sequence of whole numbers") from None
    try:
        return list(map(operator.index, given))  # type: ignore[arg-type]
    except TypeError:  # which one is it?
        return [whole(what, value) for value in given]


def positive(what: str, value: object) -> float:
    """Return a real number of at least 0: a time in s, a rate in Hz."""
    number = math.nan
    if not getattr(value, "ndim", 0) and hasattr(value, "__float__"):
        with suppress(TypeError, ValueError, OverflowError):
            number = float(value)
    if not 0 <= number < math.inf:
        raise ValueRangeError(f"{what}: {shown(value)} is not a number from 0 on")
    return number


def at(address: int) -> str:
    """Return an address in the form that errors show."""
    return f"{address:#x}" if address.bit_length() <= 64 else shown(address)
