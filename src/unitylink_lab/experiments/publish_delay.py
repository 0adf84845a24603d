# SPDX-License-Identifier: BSD-3-Clause
"""The time of a publish from the gateware to the program, for each event that makes the chip send."""

from __future__ import annotations

from dataclasses import dataclass, replace
from statistics import mean

from unitylink import protocol as p
from unitylink.layer1_stream import ClassicEncoder

from .exchange import READ_ADDRESS, frame
from .gateware import CLOCK_HZ, FRAMED, GATEWARES
from .link_parameters import LinkParameters
from .virtual_link import VirtualLink

SEND_IMMEDIATE = ("never", "publishes", "all")
WORDS = 4
_DURATION_S = 0.03
_FIRST = 2  # the answers to the requests delay this many publishes, which are left out


@dataclass(frozen=True)
class PublishDelay:
    """Delays of the publishes of one run, in seconds from the last byte out of the gateware."""

    gateware: str
    send_immediate: str
    publishes: int
    mean_s: float
    most_s: float


def publish_delay(link: LinkParameters, gateware: str, send_immediate: str) -> PublishDelay:
    """Publish WORDS words at the base frequency.

    It is 961 Hz, so they come at every time within a microframe.

    >>> from unitylink_lab.experiments.link_parameters import FT245_ASYNC
    >>> publish_delay(FT245_ASYNC, "2012", "all").most_s < 260e-6
    True
    """
    device = GATEWARES[gateware](publishing=True)
    wire = VirtualLink(replace(link, send_immediate=send_immediate), device)
    requests = framed_requests() if gateware == FRAMED else classic_requests()
    wire.send(b"".join(requests))
    wire.run_until(_DURATION_S)
    ends = (time_s for time_s, data in wire.received for byte in data if byte == device.terminator)
    # The last publishes may still be on their way.
    delays = [end_s - clock / CLOCK_HZ for end_s, clock in zip(ends, device.answered, strict=False)]
    del delays[: len(requests) + _FIRST]
    return PublishDelay(gateware, send_immediate, len(delays), mean(delays), max(delays))


def classic_requests() -> list[bytes]:
    """Return the requests that make a classic device publish."""
    encode = ClassicEncoder().encode
    return [
        encode(p.COMMAND_WRITE_GROUP_ADDRESSES, bytes([0, WORDS]) + bytes([READ_ADDRESS]) * WORDS),
        encode(p.COMMAND_WRITE_GROUP_RATE, bytes([0, 0, 1])),
        encode(p.COMMAND_ENABLE_PUBLISHING),
    ]


def framed_requests() -> list[bytes]:
    """Return the requests that make a framed device publish group 0 at every tick of its clock."""
    group = bytes([0, 0, 0, 0, 1, 0, WORDS]) + bytes([READ_ADDRESS]) * WORDS
    publish = p.CONTROL_PUBLISH.to_bytes(2, "big") + (1).to_bytes(4, "big")
    return [
        frame(p.REQUEST_KIND_DEFINE_GROUP, bytes([0, 0]) + group),
        frame(p.REQUEST_KIND_WRITE_CONTROL, bytes([0, 1]) + publish),
    ]
