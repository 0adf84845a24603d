# SPDX-License-Identifier: BSD-3-Clause
"""Layer 2: requests and publishes as words at addresses. It handles everything that can go wrong on the way.

    from unitylink import connect

    with connect("tcp://127.0.0.1:5555") as link:
        link.write(0x20, 0xDEADBEEF, repeat=True)
        print(hex(link.read(0x20)), link.read_many([0x20, 0x21]))
        with link.subscribe([0x20, 0x21], divisor=10) as positions:
            positions.wait(1.0)
            times_s, values = positions.drain()

Values are raw unsigned words. Names, signs and units belong to layer 4.
"""

from __future__ import annotations

from .batch import Batch, Pending
from .configuration import Configuration, Statistics
from .device import Clock, DeadMan, Description, Health
from .events import LinkEvent
from .exchange_group import ExchangeGroup
from .link import Link
from .native_link import Times, Words, check_url
from .send_limit import sent_before
from .subscription import PublishCallback, Subscription

__all__ = [
    "Batch",
    "Clock",
    "Configuration",
    "DeadMan",
    "Description",
    "ExchangeGroup",
    "Health",
    "Link",
    "LinkEvent",
    "Pending",
    "PublishCallback",
    "Statistics",
    "Subscription",
    "Times",
    "Words",
    "check_url",
    "sent_before",
]
