# SPDX-License-Identifier: BSD-3-Clause
"""Which values are published together: the compiler's tables of subscription groups, one table for each
device.

Hardware publishes of one device with the same trigger, rate and group name form one group and one snapshot.
Groups are numbered in the order of their first element. The number is also that of the gateware's group and
of its event line. So gateware, twin and PC agree without any exchange.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar

from ..model import CYCLE, Device, Element, Instance, Link, Publish, SubscriptionGroup
from ..ring import rings_of

_Key = tuple[str, int, str, str]  # (trigger, divisor, event, name)
_Value = TypeVar("_Value")


def devices(roots: tuple[Instance, ...], links: Mapping[str, Link]) -> tuple[Device, ...]:
    """Return the devices of a spec in the order of the text.

    `links` has the key "" for bindings that name no link.
    """
    found: dict[tuple[str, str | None], tuple[Link, dict[_Key, list[Element]]]] = {}
    for root in roots:
        for element in root.walk():
            binding = element.link
            link = links[binding.link if binding.link in links else ""]
            _, table = found.setdefault((root.name, binding.comm), (link, {}))
            publish = element.publish
            if publish is not None and publish.mode == 1:
                table.setdefault(key_of(publish), []).append(element)
    cycles_hz = _cycles_hz(roots)
    return tuple(
        Device(
            root,
            comm,
            link,
            tuple(
                _group(number, key, table[key], cycles_hz.get((root, comm)))
                for number, key in enumerate(table)
            ),
        )
        for (root, comm), (link, table) in found.items()
    )


def _cycles_hz(roots: tuple[Instance, ...]) -> dict[tuple[str, str | None], float]:
    """Return how often the ring of a device cycles, for each device with one."""
    found = {}
    for root in roots:
        for comm in {element.link.comm for element in root.walk() if element.link.kind == "tosnet"}:
            found[root.name, comm] = 1 / rings_of(root, comm)[0].cycle_s
    return found


def split(values: Iterable[_Value], words_of: Callable[[_Value], int], most: int) -> list[tuple[_Value, ...]]:
    """Divide values into the gateware's groups of at most `most` words.

    They are filled in order, and no value is divided.

    >>> split(["a", "b", "c"], lambda value: 2, 5)
    [('a', 'b'), ('c',)]
    """
    parts: list[list[_Value]] = []
    room = 0
    for value in values:
        words = words_of(value)
        if words > room:
            parts.append([])
            room = most
        parts[-1].append(value)
        room -= words
    return [tuple(part) for part in parts]


def key_of(publish: Publish) -> _Key:
    """Return the facts that publishes of one group share."""
    return publish.trigger, publish.divisor, publish.event, publish.group


def _group(number: int, key: _Key, elements: list[Element], cycle_hz: float | None) -> SubscriptionGroup:
    trigger, divisor, event, name = key
    first = elements[0].publish
    assert first is not None  # its publish put it into the table
    if not name:
        name = f"{first.rate_hz:g} Hz" if trigger == "rate" else f"on {event or trigger}"
    rate_hz = cycle_hz if (trigger, event) == ("event", CYCLE) else first.rate_hz
    return SubscriptionGroup(number, name, trigger, divisor, rate_hz, event, tuple(elements))
