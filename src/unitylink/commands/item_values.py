# SPDX-License-Identifier: BSD-3-Clause
"""Items as layer-4 values that can be read and published."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from unitylink.errors import ValueRangeError
from unitylink.layer3_hardware import MemoryProxy
from unitylink.layer4_data import Publisher, ReadClearValue, ReadValue
from unitylink.values import Quantity

from .names import Item

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def item_values(
    link: Link, items: Sequence[Item], publisher: Publisher | None = None
) -> dict[str, ReadValue[Any]]:
    """Make a value of each item.

    Unlike the tree of the spec, it can also read WRITE items and bare addresses.

    The items' addresses are already absolute, so plain memory reaches all of them. Raises BindingError for an
    item of the spec beyond the device's address bus, and ValueRangeError for such a bare address.
    """
    check_bare(link, items)
    memory = MemoryProxy(link)
    publisher = publisher if publisher is not None else Publisher()
    values: dict[str, ReadValue[Any]] = {}
    for item in items:
        element = item.element
        if element is None:
            values[item.name] = ReadValue(item.name, memory, item.address, publisher=publisher)
            continue
        kind = ReadValue if element.access != "READCLEAR" else ReadClearValue
        values[item.name] = kind(
            item.name,
            memory,
            item.address,
            quantity=Quantity.of(element),
            words=None if element.type.bus else element.words,
            checked=element.checked,
            publish=element.publish,
            line=item.line,
            publisher=publisher,
        )
    return values


def check_bare(link: Link, items: Sequence[Item]) -> None:
    """Raise ValueRangeError for a bare address beyond the device's address bus."""
    bits = link.configuration.address_bits
    for item in items:
        if item.element is None and item.address >> bits:
            raise ValueRangeError(f"{item.name} is beyond the {bits} bits of the address bus of {link.url}")
