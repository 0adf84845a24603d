# SPDX-License-Identifier: BSD-3-Clause
"""From the PUBLISH of a text to modes, divisors, rates in Hz and events."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from unitylink.protocol import RATE_BYTES_MAX

from ..model import READS, Link, Publish
from ..text.syntax import ElementNode, Property, PublishNode, Step
from ..units import UNITS
from .evaluate import Evaluator, Quantity, Value
from .scope import ADDRESS_MAX

_DIVISOR_MAX = (1 << 8 * RATE_BYTES_MAX) - 1


def read_publish(
    node: ElementNode, one: Property, evaluator: Evaluator, names: Mapping[str, Value], link: Link
) -> Publish | None:
    """Return how an element publishes over `link`.

    Return None after a diagnostic, or if a name has no value.
    """
    publish = one.publish
    assert publish is not None  # the property is a PUBLISH
    reporter = evaluator.reporter
    if node.access not in READS:
        message = f"`{node.name.text}` is a {node.access}: only what the PC reads can be published"
        reporter.report("UL060", one.start, one.end, message, "remove PUBLISH, or make it a READ")
        return None
    group = publish.group.text if publish.group else ""
    if publish.event:
        event = _event(publish.event, evaluator, names)
        if event is None:
            return None
        if event == "change":
            return Publish(1, 0, None, "change", "", group)
        return Publish(1, 0, None, "event", event, group)
    if len(publish.rates) == 1:
        divisor = _divisor_of_rate(publish, evaluator, names, link)
        return None if divisor is None else Publish(1, divisor, link.base_hz / divisor, group=group)
    return _by_divisor(publish, evaluator, names, link, group)


def _event(steps: list[Step], evaluator: Evaluator, names: Mapping[str, Value]) -> str | None:
    """Return the path of an event. Return None after a diagnostic."""
    parts = []
    for step in steps:
        part = step.name.text
        if step.index is not None:
            number = evaluator.integer(step.index, names, "the index", 0, ADDRESS_MAX)
            if number is None:
                return None
            part += f"[{number}]"
        parts.append(part)
    return ".".join(parts)


def _by_divisor(
    publish: PublishNode, evaluator: Evaluator, names: Mapping[str, Value], link: Link, group: str
) -> Publish | None:
    reporter = evaluator.reporter
    first, second = publish.rates
    huge = 1 << 64
    mode = evaluator.integer(first, names, "the mode", -huge, huge)
    divisor = evaluator.integer(second, names, "the divisor", -huge, huge)
    if mode is None or divisor is None:
        return None
    if mode not in (1, 2):
        message = f"PUBLISH({mode},…) has no meaning: the first number is the mode, 1 or 2"
        hint = (
            "1 = hardware publish (the gateware sends), 2 = software publish (the PC polls); "
            "if a subscription group's number was meant: the compiler makes one for each rate: write 1"
        )
        reporter.report("UL061", first.start, first.end, message, hint)
    elif divisor <= 0:
        message = f"the divisor of the base publish frequency is {divisor}"
        hint = (
            "1 publishes at the base frequency (1000 Hz unless the gateware says otherwise), 10 at a "
            "tenth of it; to publish nothing remove PUBLISH"
        )
        reporter.report("UL062", second.start, second.end, message, hint)
    elif divisor > _DIVISOR_MAX:
        message = f"the divisor is larger than {_DIVISOR_MAX:,}"
        hint = f"the protocol sends it in at most {RATE_BYTES_MAX} bytes"
        reporter.report("UL063", second.start, second.end, message, hint)
    else:
        return Publish(mode, divisor, link.base_hz / divisor, group=group)
    return None


def _divisor_of_rate(
    publish: PublishNode, evaluator: Evaluator, names: Mapping[str, Value], link: Link
) -> int | None:
    """Return the divisor nearest to a rate. Rounding is reported."""
    reporter = evaluator.reporter
    (written,) = publish.rates
    given = evaluator.value(written, names)
    if isinstance(given, Quantity) and given.dimension == UNITS["s"].dimension and given.value > 0:
        message = "PUBLISH takes a rate, and this is a time"
        hint = f"as a rate it is `PUBLISH({float(1 / given.value):g} Hz)`"
        reporter.report("UL088", written.start, written.end, message, hint)
        return None
    rate = evaluator.quantity(written, names, "the rate of PUBLISH", UNITS["Hz"])
    if rate is None:
        return None
    if not 0 < rate <= link.base_hz:
        message = f"{float(rate):g} Hz cannot be published"
        hint = f"the base publish frequency is {link.base_hz} Hz: choose at most that, and more than 0"
        if rate > 0:
            hint += "; another base is declared by `link name (BASE_RATE=… Hz);`"
        reporter.report("UL101", written.start, written.end, message, hint)
        return None
    divisor = max(1, round(Fraction(link.base_hz) / rate))
    if divisor > _DIVISOR_MAX:
        message = f"{float(rate):g} Hz needs a divisor larger than {_DIVISOR_MAX:,}"
        hint = f"the protocol sends it in at most {RATE_BYTES_MAX} bytes"
        reporter.report("UL063", written.start, written.end, message, hint)
        return None
    reached = Fraction(link.base_hz, divisor)
    if reached != rate:
        message = f"{float(rate):g} Hz is rounded to {float(reached):g} Hz"
        hint = (
            f"rates are the base publish frequency divided by a whole number: {link.base_hz} Hz / {divisor}"
        )
        reporter.report("UL100", written.start, written.end, message, hint)
    return divisor
