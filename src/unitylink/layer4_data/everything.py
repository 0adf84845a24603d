# SPDX-License-Identifier: BSD-3-Clause
"""All values of a robot, for those who look: a page, a stream."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from unitylink.errors import BusError
from unitylink.layer3_hardware import MemoryProxy

from .publishing import Publisher
from .read_value import ReadValue
from .value import Value

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def publish_all(publisher: Publisher, link: Link, values: Iterable[Value[Any]], read_hz: float) -> None:
    """Plan the publishes of all values that can be looked at.

    The gateware sends items with PUBLISH. The PC reads the others at `read_hz`, and also set-points that the
    device lets it read. An item that a read would change is only heard.
    """
    for value in values:
        if isinstance(value, ReadValue):
            if value.publish is not None:
                publisher.add(value)
            elif value.pollable and value.hardware.repeatable_reads:
                publisher.demand(value, read_hz)
        elif value.writable and value.hardware.repeatable_reads and _reads(link, value):
            seen: ReadValue[Any] = ReadValue(
                value.path, MemoryProxy(link), value.address, quantity=value.quantity
            )
            publisher.demand(seen, read_hz)


def _reads(link: Link, value: Value[Any]) -> bool:
    """Tell whether the device lets a set-point be read."""
    try:
        link.read(value.address)
    except BusError:
        return False
    return True
