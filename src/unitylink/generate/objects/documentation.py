# SPDX-License-Identifier: BSD-3-Clause
"""What generated files say about values and parts, in every language with typed objects."""

from __future__ import annotations

from collections.abc import Sequence

from unitylink import protocol
from unitylink.spec.model import Element, Instance
from unitylink.values import Quantity, format_value, member_text

PLACES_SHOWN = 6  # the most expansions that a docstring names; the address table has all


def value_facts(element: Element, quantity: Quantity, here: Sequence[Element]) -> str:
    """Return the sentence about a value: access, type, unit, limits, publishing, address."""
    facts = [element.access, str(quantity.type.text)]
    if element.checked:
        facts.append("checksummed")
    if quantity.unit:
        facts.append(f"in {quantity.unit}")
    if quantity.minimum is not None or quantity.maximum is not None:
        low, high = ("" if end is None else format_value(end) for end in (quantity.minimum, quantity.maximum))
        between = f"from {low} to {high}" if low and high else f"at least {low}" if low else f"at most {high}"
        facts.append(f"{between}{', saturating' if quantity.overflow == 'saturate' else ''}")
    for name in ("initial", "safe"):
        if getattr(quantity, name) is not None:
            facts.append(f"{name} {member_text(quantity.type, getattr(quantity, name))}")
    publish = element.publish
    if publish is not None and publish.trigger != "rate":
        facts.append(f"published on {publish.event or publish.trigger}")
    elif publish is not None:
        who = "by the gateware" if publish.mode == 1 else "by polling"
        base_hz = round(publish.rate_hz * publish.divisor) if publish.rate_hz else protocol.BASE_HZ_DEFAULT
        rate = f"{base_hz / publish.divisor:g} Hz of {base_hz} Hz"
        facts.append(f"published {who} at the base rate / {publish.divisor} ({rate})")
    if publish is not None and publish.group:
        facts.append(f"in the snapshot {publish.group}")
    return f"{', '.join(facts)}: {places([f'{e.path} at 0x{e.address:03X}{called(e)}' for e in here])}."


def places(texts: Sequence[str]) -> str:
    """Return texts with commas between. If there are many, return the first few."""
    more = len(texts) - PLACES_SHOWN
    few = texts if more <= 1 else [*texts[:PLACES_SHOWN], f"... ({len(texts)} in all)"]
    return ", ".join(few)


def shown(instance: Instance) -> str:
    return f"`{instance.path}`{called(instance)}"


def called(item: Instance | Element) -> str:
    return f" ({item.display})" if item.display != item.path else ""


def sentences(*texts: str) -> str:
    """Join texts of a spec and of ours. Each one ends as a sentence does.

    >>> sentences("a queue", "", "The constructor `samples`.")
    'a queue. The constructor `samples`.'
    """
    told = [text.strip() for text in texts if text.strip()]
    return " ".join(text if text[-1] in ".!?:;" else f"{text}." for text in told)
