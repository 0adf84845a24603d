# SPDX-License-Identifier: BSD-3-Clause
"""Level 1 of the paper: what the gateware alone does, at 50 MHz, 32-bit words and 8-bit addresses."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from .gateware import CLOCK_HZ, CORE, CORE_CHECKED_PERIOD, FIFO_CLOCKS, Gateware2012
from .low_level import ADDRESS, Exchange, read, read_many, write

_RUN_CLOCKS = 200_000
_REPEATS = 16


@dataclass(frozen=True)
class GatewareFigures:
    """Clocks of one request through both FIFOs, the period of many, and bit/s at that period."""

    name: str
    latency_clocks: int | None  # None: no test holds the core to one
    period_clocks: int
    request_hz: float
    reply_hz: float


def gateware_2012(exchange: Exchange) -> GatewareFigures:
    """Run the twin, request bytes at full speed.

    >>> from unitylink.experiments.low_level import read
    >>> figures = gateware_2012(read())
    >>> figures.latency_clocks, figures.period_clocks
    (57, 28)
    """
    single = Gateware2012(fifo=0)
    _feed(single, exchange.request)
    many = Gateware2012(fifo=0)
    _feed(many, exchange.request * _REPEATS)
    periods = [b - a for a, b in pairwise(many.answered)][_REPEATS // 2 :]
    return _figures(exchange, single.answered[0], max(periods))


def core(exchange: Exchange) -> GatewareFigures:
    """Give the figures our core is held to by its tests; reads and writes of one word."""
    kind = exchange.request[:2]
    if kind in CORE_CHECKED_PERIOD:
        return _figures(exchange, None, CORE_CHECKED_PERIOD[kind])
    clocks = CORE[kind]
    last_in = len(exchange.request) - 1
    return _figures(exchange, last_in + clocks.last_out + FIFO_CLOCKS, clocks.period)


def effect_2012_clocks() -> int:
    """Return the clocks from the first byte of a write to the change of the bus register."""
    gateware = Gateware2012(fifo=0, watch=ADDRESS)
    _feed(gateware, write().request)
    return gateware.effects[0]


def all_figures() -> list[tuple[str, GatewareFigures]]:
    """Return the figures of each request of both gatewares."""
    exchanges = [read(), read(checked=True), write(), write(checked=True)]
    many = [read_many(words, checked=checked) for words in (1, 4, 32) for checked in (False, True)]
    return [("2012", gateware_2012(one)) for one in [*exchanges, *many]] + [
        ("ours", core(one)) for one in exchanges
    ]


def _feed(gateware: Gateware2012, data: bytes) -> None:
    for byte in data:
        gateware.receive(byte)
    gateware.run_until(_RUN_CLOCKS)


def _figures(exchange: Exchange, latency: int | None, period: int) -> GatewareFigures:
    per_s = 8 * CLOCK_HZ / period
    name = exchange.name + (", CRC" if exchange.request.startswith(b"$") else "")
    return GatewareFigures(name, latency, period, len(exchange.request) * per_s, exchange.reply_bytes * per_s)
