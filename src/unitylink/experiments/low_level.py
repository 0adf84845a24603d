# SPDX-License-Identifier: BSD-3-Clause
"""Level 2 of the paper: a bare script on the byte stream, through the model of the chip."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import mean

from unitylink.layer1_stream import ClassicEncoder

from .gateware import CLOCK_HZ, Core, Gateware, Gateware2012
from .link_parameters import LinkParameters
from .virtual_link import VirtualLink

ADDRESS = 0x12
TRANSMIT_FIFO_BYTES = 255  # as the paper counts its 256
_PAUSE = 4  # a gap so many times the median one is a pause


@dataclass(frozen=True)
class Exchange:
    """A request and how many bytes its reply has."""

    name: str
    request: bytes
    reply_bytes: int

    @property
    def bits(self) -> int:
        return 8 * (len(self.request) + self.reply_bytes)


def read(*, checked: bool = False) -> Exchange:
    """Return the read of one word.

    >>> read().request, read().bits
    (b'#R:12\\n', 160)
    """
    return Exchange(
        "read", ClassicEncoder(checked=checked).encode("R", bytes([ADDRESS])), 17 if checked else 14
    )


def read_many(words: int, *, checked: bool = False) -> Exchange:
    """Return the read of `words` words in one request."""
    data = bytes([words]) + bytes([ADDRESS]) * words
    tail = 3 if checked else 0
    return Exchange(f"read {words}", ClassicEncoder(checked=checked).encode("RM", data), 7 + 8 * words + tail)


def write(value: int = 1, *, checked: bool = False) -> Exchange:
    """Return the write of one word."""
    data = bytes([ADDRESS]) + value.to_bytes(4, "big")
    return Exchange("write", ClassicEncoder(checked=checked).encode("W", data), 8 if checked else 5)


def synchronous_s(link: LinkParameters, exchange: Exchange, *, count: int = 20, fifo: int = 256) -> float:
    """Return the mean time from a request to its reply, one after another; the first is not counted.

    >>> from unitylink.experiments.link_parameters import FT245_ASYNC
    >>> round(synchronous_s(FT245_ASYNC, read()) * 1e6)
    1000
    """
    wire = VirtualLink(link, Gateware2012(fifo=fifo))
    times: list[float] = []
    for _ in range(count + 1):
        start_s = wire.now_s
        wire.send(exchange.request)
        wire.wait(exchange.reply_bytes)
        times.append(wire.now_s - start_s)
    return mean(times[1:])


@dataclass(frozen=True)
class ReadBurst:
    """Replies to requests that were sent together; rates in bit/s of reply."""

    requests: int
    received_hz: float  # by the times at which the program got them
    stamped_hz: float  # by the gateware's time stamps, over the whole burst
    unpaused_hz: float  # of them, without the pauses
    between_pauses: int  # replies from one pause to the next; all if there is none
    peak_bytes: int  # most that waited in the transmit FIFO


def read_burst(link: LinkParameters, requests: int, *, gateware: str = "2012", fifo: int = 256) -> ReadBurst:
    """Send so many reads at once to the gateware "2012" or "ours", and see the replies come."""
    device: Gateware = Gateware2012(fifo=fifo) if gateware == "2012" else Core(fifo=fifo)
    wire = VirtualLink(link, device)
    exchange = read()
    wire.send(exchange.request * requests)
    wire.wait(exchange.reply_bytes * requests)
    bits = 8 * exchange.reply_bytes
    gaps = [b - a for a, b in pairwise(device.answered)]
    usual = sorted(gaps)[len(gaps) // 2]
    pauses = [index for index, gap in enumerate(gaps) if gap > _PAUSE * usual]
    flowing = [gap for gap in gaps if gap <= _PAUSE * usual]
    runs = [b - a for a, b in pairwise(pauses)]
    first, last = wire.received[0][0], wire.received[-1][0]
    return ReadBurst(
        requests,
        bits * (requests - 1) / max(last - first, link.microframe_s),
        bits / (mean(gaps) / CLOCK_HZ),
        bits / (mean(flowing) / CLOCK_HZ),
        round(mean(runs)) if runs else requests,
        device.peak,
    )


def largest_held_burst(link: LinkParameters) -> int:
    """Return how many reads may go at once with send-immediate: more would meet a full transmit FIFO."""
    held = replace(link, send_immediate="all")
    requests = 1
    while read_burst(held, requests + 1, fifo=2048).peak_bytes <= TRANSMIT_FIFO_BYTES:
        requests += 1
    return requests


@dataclass(frozen=True)
class WriteBurst:
    """Writes that were sent together, by the clocks at which they took effect."""

    first_s: float  # request to effect of the first
    period_s: float
    effective_hz: float  # bits / (first latency + n periods), as the paper counts


def write_burst(link: LinkParameters, requests: int = 30) -> WriteBurst:
    """Send so many writes at once to a bus register, and see its output change."""
    device = Gateware2012(watch=ADDRESS)
    wire = VirtualLink(link, device)
    exchanges = [write(number + 1) for number in range(requests)]
    wire.send(b"".join(exchange.request for exchange in exchanges))
    wire.wait(exchanges[0].reply_bytes * requests)
    effects = [clock / CLOCK_HZ for clock in device.effects]
    period_s = mean(b - a for a, b in pairwise(effects))
    bits = 8 * len(exchanges[0].request) * requests
    return WriteBurst(effects[0], period_s, bits / (effects[0] + requests * period_s))
