# SPDX-License-Identifier: BSD-3-Clause
"""One run of all experiments, as JSON has it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import unitylink
from unitylink.tools.bench.report import machine

from . import level_one, software_cost
from .link_parameters import FT245_ASYNC, FT245_SYNC, LINKS, LinkParameters, assumptions
from .low_level import read, read_burst, read_many, synchronous_s, write
from .model_figures import LONG_BURST_REQUESTS, model_figures
from .publish_limits import WORDS, limits
from .scaling import scaling
from .simplicity import PAPER, simplicity
from .table_one import CELLS, TEXT, Cell

FORMAT = 1
_LINE_FEED = 0x0A


def run_all(*, quick: bool, say: Callable[[str], None]) -> dict[str, Any]:
    """Run everything; `quick` repeats the measured part less often. The modelled part is the same in both."""
    say("level 1: the gateware")
    gateware = [{"gateware": which, **asdict(figures)} for which, figures in level_one.all_figures()]
    say("level 3: what this host's software costs")
    cost = software_cost.measure(rounds=11 if quick else 101)
    say("level 2: the byte stream, through the model of the chip")
    figures = model_figures(cost)
    say("level 2: other links")
    links = [row for link in LINKS for row in _link_rows(link, quick=quick)]
    bursts = [
        {
            "link": link.name,
            "gateware": which,
            **asdict(read_burst(link, LONG_BURST_REQUESTS, gateware=which)),
        }
        for link in (FT245_ASYNC, FT245_SYNC)
        for which in ("2012", "ours")
    ]
    say("scaling")
    grown = scaling(rounds=5 if quick else 51)
    return {
        "format": FORMAT,
        "quick": quick,
        "version": unitylink.__version__,
        "machine": machine(),
        "seeds": [],  # nothing in the model is drawn at random
        "assumptions": assumptions(),
        "gateware": gateware,
        "software_cost": asdict(cost),
        "table_one": [_compared(cell, figures) for cell in CELLS],
        "text": [_compared(cell, figures) for cell in TEXT],
        "links": links,
        "bursts": bursts,
        "scaling": grown,
        "publish": {"words": list(WORDS), "limits_hz": limits()},
        "simplicity": {"paper": PAPER, "ours": simplicity()},
    }


def _compared(cell: Cell, figures: dict[str, float]) -> dict[str, Any]:
    value = figures[cell.model]
    return {**asdict(cell), "model": value, "difference": value / cell.paper - 1}


def _link_rows(link: LinkParameters, *, quick: bool) -> list[dict[str, Any]]:
    """Latencies of one link when the chip waits for its timer, and when something makes it send."""
    if link.half_duplex:
        ways = {"latency timer": link, "send-immediate": replace(link, send_immediate="all")}
    else:
        ways = {"latency timer": link, "event character": replace(link, event_character=_LINE_FEED)}
    exchanges = [read(), read(checked=True), write(), write(checked=True), read_many(32), read_many(255)]
    return [
        {
            "link": link.name,
            "sends": sends,
            "fifo": fifo,
            "latencies_s": {
                exchange.name + (", CRC" if exchange.request.startswith(b"$") else ""): synchronous_s(
                    chosen, exchange, fifo=fifo, count=5 if quick else 20
                )
                for exchange in exchanges
            },
        }
        for sends, chosen in ways.items()
        for fifo in (16, 256)
    ]
