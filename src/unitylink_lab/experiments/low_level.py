# SPDX-License-Identifier: BSD-3-Clause
"""Level 2 of the paper: a bare script on the byte stream, through the model of the chip."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import mean

from .exchange import WRITE_ADDRESS, Exchange, framed_read, read
from .gateware import CLOCK_HZ, FRAMED, GATEWARES
from .link_parameters import LinkParameters
from .virtual_link import VirtualLink

TRANSMIT_FIFO_BYTES = 255  # as the paper counts its 256
BURST_PATIENCE_S = 1.0
_PAUSE = 4  # a gap is a pause if it is so many times longer than the median


def synchronous_s(
    link: LinkParameters,
    exchange: Exchange,
    *,
    gateware: str = "2012",
    count: int = 20,
    fifo: int = 256,
    pause_s: float = 0.0,
) -> float:
    """Return the mean round trip of requests that follow one another. The first is not counted.

    `pause_s` is the time that the program works between a reply and the next request. It is not part of the
    round trip.

    >>> from unitylink_lab.experiments.link_parameters import FT245_ASYNC
    >>> round(synchronous_s(FT245_ASYNC, read()) * 1e6)
    1000
    """
    wire = VirtualLink(link, GATEWARES[gateware](fifo=fifo))
    times: list[float] = []
    for number in range(count + 1):
        start_s = wire.now_s
        wire.send(exchange.request(number))
        wire.wait(exchange.reply_bytes)
        times.append(wire.now_s - start_s)
        wire.run_until(wire.now_s + pause_s)
    return mean(times[1:])


@dataclass(frozen=True)
class ReadBurst:
    """Replies to requests that were sent together. Rates are in bit/s of replies."""

    requests: int
    received_hz: float  # by the times at which the program received them
    stamped_hz: float  # by the gateware's time stamps, over the whole burst
    unpaused_hz: float  # by the time stamps, without the pauses
    between_pauses: int  # replies from one pause to the next; all replies if there is no pause
    peak_bytes: int  # the most bytes that waited in the transmit FIFO


def read_burst(link: LinkParameters, requests: int, *, gateware: str = "2012", fifo: int = 256) -> ReadBurst:
    """Send several reads at once to one of GATEWARES, and time the replies."""
    device = GATEWARES[gateware](fifo=fifo)
    wire = VirtualLink(link, device)
    exchange = framed_read() if gateware == FRAMED else read()
    wire.send(exchange.burst(requests))
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
    """Return how many reads may be sent at once with send-immediate.

    More of them would fill the transmit FIFO.
    """
    held = replace(link, send_immediate="all")
    requests = 1
    while read_burst(held, requests + 1, fifo=2048).peak_bytes <= TRANSMIT_FIFO_BYTES:
        requests += 1
    return requests


@dataclass(frozen=True)
class WriteBurst:
    """Writes that were sent together. Their rates come from the clocks at which they took effect."""

    first_s: float  # from the first request to its effect
    period_s: float
    effective_hz: float  # bits / (first latency + n periods), as the paper computes it
    bits: int


def write_burst(
    link: LinkParameters, exchange: Exchange, *, gateware: str = "2012", requests: int = 30
) -> WriteBurst:
    """Send several writes or posts at once to a bus register, and time the changes of its output."""
    device = GATEWARES[gateware](watch=WRITE_ADDRESS)
    wire = VirtualLink(link, device)
    wire.send(exchange.burst(requests))
    while len(device.effects) < requests:
        wire.run_until(wire.now_s + link.microframe_s)
        if wire.now_s > BURST_PATIENCE_S:
            raise TimeoutError(f"{len(device.effects)} of {requests} writes took effect")
    effects = [clock / CLOCK_HZ for clock in device.effects]
    period_s = mean(b - a for a, b in pairwise(effects))
    bits = 8 * exchange.request_bytes * requests
    return WriteBurst(effects[0], period_s, bits / (effects[0] + requests * period_s), bits)
