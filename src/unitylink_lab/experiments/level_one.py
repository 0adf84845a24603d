# SPDX-License-Identifier: BSD-3-Clause
"""Level 1 of the paper: the gateware alone, at 50 MHz, with 32-bit words and 8-bit addresses."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from .exchange import (
    WRITE_ADDRESS,
    Exchange,
    framed_post,
    framed_read,
    framed_read_many,
    framed_write,
    read,
    read_many,
    write,
)
from .gateware import BITSTREAMS, CLOCK_HZ, FRAMED, GATEWARES, Gateware

_RUN_CLOCKS = 60_000
_REPEATS = 16


@dataclass(frozen=True)
class GatewareFigures:
    """Clocks of one request through both FIFOs, the period of many requests, and bit/s at that period.

    `latency_clocks` counts from the first byte in to the last byte out, `effect_clocks` to the output of the
    register. They are None if there is no reply or no effect.
    """

    gateware: str
    name: str
    latency_clocks: int | None
    effect_clocks: int | None
    period_clocks: int
    request_hz: float
    reply_hz: float


def figures(gateware: str, exchange: Exchange) -> GatewareFigures:
    """Run one of GATEWARES. The request's bytes come at full speed.

    >>> figures("2012", read()).latency_clocks, figures("2012", read()).period_clocks
    (57, 28)
    """
    single, many = _fed(gateware, exchange.request(0)), _fed(gateware, exchange.burst(_REPEATS))
    ends = many.answered if exchange.reply_bytes else many.effects
    ends = ends[len(ends) // _REPEATS - 1 :: len(ends) // _REPEATS]  # the last reply of each exchange
    period = max(b - a for a, b in list(pairwise(ends))[_REPEATS // 2 :])
    per_s = 8 * CLOCK_HZ / period
    return GatewareFigures(
        gateware,
        exchange.title,
        single.answered[-1] if single.answered else None,
        single.effects[0] if single.effects else None,
        period,
        exchange.request_bytes * per_s,
        exchange.reply_bytes * per_s,
    )


def all_figures(*, bitstreams: bool = False) -> list[GatewareFigures]:
    """Return the figures of each request of each gateware. With `bitstreams`, also those of BITSTREAMS."""
    classic = [read(), read(checked=True), write(), write(checked=True)]
    classic += [read_many(words, checked=checked) for words in (1, 4, 32) for checked in (False, True)]
    framed = [framed_read(), framed_write(), framed_post()]
    framed += [framed_read_many(words) for words in (1, 4, 32)]
    chosen = [*GATEWARES, *(BITSTREAMS if bitstreams else ())]
    return [
        figures(gateware, exchange)
        for gateware in chosen
        for exchange in (framed if gateware.startswith(FRAMED) else classic)
    ]


def _fed(name: str, data: bytes) -> Gateware:
    """Give all of `data` at once to a fresh gateware. Return the gateware when it has done everything."""
    gateware = {**GATEWARES, **BITSTREAMS}[name](fifo=0, watch=WRITE_ADDRESS)
    for byte in data:
        gateware.receive(byte)
    gateware.run_until(_RUN_CLOCKS)
    return gateware
