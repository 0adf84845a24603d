# SPDX-License-Identifier: BSD-3-Clause
"""What the generics of a component cannot be.

The range of one generic stands in its VHDL. `@limit(value, least=…, most=…)` is for what no range can say:
a parameter beside another one, or beside the clock of the design. The clock is known when a board is chosen,
so `@limit(clock_hz, least=…)` is kept until then (`interface/components.py`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction

from ..text.syntax import AnnotationNode, Argument, Name
from ..units import unit
from .evaluate import Evaluator, Quantity, Value
from .vhdl_generics import limits_of

_CLOCK = "clock_hz"
_CLOCK_MOST_HZ = (1 << 31) - 1  # the largest number of VHDL


def check_ranges(
    entity: str, sources: list[str], given: list[tuple[Argument, str, int]], evaluator: Evaluator
) -> None:
    """Report each number that the generic does not take. That of `clock_hz` is the design's clock."""
    limits = limits_of(entity, sources)
    for argument, name, value in given:
        low, high = limits.get(name.lower(), (value, value))
        if name != _CLOCK and not low <= value <= high:
            message = f"generic `{name}` of `{entity}` is {value:,}"
            hint = f"it is a number from {low:,} to {high:,}"
            evaluator.reporter.report("UL049", argument.start, argument.end, message, hint)


def is_limit(node: AnnotationNode) -> bool:
    """Has a `@limit` one value, and `least`, `most` or both? For the clock there is only `least`."""
    values = [one for one in node.arguments if one.key is None]
    keys = [one.key.text for one in node.arguments if one.key is not None]
    known = ("least",) if len(values) == 1 and is_clock(values[0]) else ("least", "most")
    return len(values) == 1 and bool(keys) and len(set(keys)) == len(keys) and set(keys) <= set(known)


def check_limit(node: AnnotationNode, evaluator: Evaluator, names: Mapping[str, Value]) -> int:
    """Report a value that is beyond its `@limit`. Return the least clock that it asks for in Hz, or 0."""
    (subject,) = (one for one in node.arguments if one.key is None)
    bounds = {one.key.text: one for one in node.arguments if one.key is not None}
    if is_clock(subject):
        least = evaluator.value(bounds["least"], names)
        least_hz = math.ceil(least) if isinstance(least, (int, Fraction)) else 0
        if least_hz > _CLOCK_MOST_HZ:
            message = f"it needs a clock of at least {least_hz:,} Hz"
            hint = f"no clock has more than {_CLOCK_MOST_HZ:,} Hz; choose a lower rate"
            bound = bounds["least"]
            evaluator.reporter.report("UL049", bound.parts[0].start, bound.end, message, hint)
        return least_hz
    value = evaluator.value(subject, names)
    for key, bound in bounds.items():
        limit = evaluator.value(bound, names)
        beyond = _difference(value, limit)
        if beyond is not None and (beyond < 0 if key == "least" else beyond > 0):
            text = evaluator.reporter.sources.text
            message = f"`{text(subject.start, subject.end)}` is {_said(value)}"
            hint = f"it is at {key} {_said(limit)}"
            if not bound.literal:
                hint += f", which is `{text(bound.parts[0].start, bound.end)}`"
            evaluator.reporter.report("UL049", subject.start, subject.end, message, hint)
            break
    return 0


def is_clock(argument: Argument) -> bool:
    """Is this the clock of the design, whose number no text knows?"""
    (first, *others) = argument.parts
    return not others and isinstance(first, Name) and first.text == _CLOCK


def _difference(value: Value | None, limit: Value | None) -> Fraction | None:
    """Return value - limit. Return None if one is no number, or if they do not measure the same.

    A limit of 0 is one of all quantities.
    """
    if isinstance(value, Quantity) and limit == 0:
        return Fraction(value.value)
    if isinstance(value, Quantity) and isinstance(limit, Quantity):
        return value.value - limit.value if value.dimension == limit.dimension else None
    if isinstance(value, (int, Fraction)) and isinstance(limit, (int, Fraction)):
        return Fraction(value) - limit
    return None


def _said(value: Value | None) -> str:
    if isinstance(value, Quantity):
        written = unit(value.unit)
        factor, offset = (written.factor, written.offset) if written else (Fraction(1), Fraction(0))
        return f"{float((value.value - offset) / factor):g} {value.unit}".rstrip()
    if isinstance(value, Fraction):
        return f"{float(value):g}"
    return f"{value:,}" if isinstance(value, int) else str(value)
