# SPDX-License-Identifier: BSD-3-Clause
"""One run of all experiments, as data for JSON."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import unitylink
from unitylink.errors import UnityLinkError
from unitylink.protocol import FRAME_WINDOW_DEFAULT
from unitylink_lab.bench.figure import Run
from unitylink_lab.bench.programs import find_checkout
from unitylink_lab.bench.report import machine

from . import level_one, peers, ros_rates, software_cost
from .ablations import ablations
from .exchange import (
    Exchange,
    framed_post,
    framed_read,
    framed_read_many,
    framed_write,
    read,
    read_many,
    write,
)
from .gateware import CLASSIC, CLOCK_HZ, FRAMED, GATEWARES, LONGEST_READ
from .link_parameters import FT245_ASYNC, FT245_SYNC, LINKS, LinkParameters, assumptions
from .low_level import read_burst, synchronous_s, write_burst
from .model_figures import LONG_BURST_REQUESTS, model_figures
from .publish_delay import SEND_IMMEDIATE, publish_delay
from .publish_limits import WORDS, limits
from .scaling import scaling
from .simplicity import PAPER, simplicity
from .software_cost import SoftwareCost
from .sustained import LINK_HZ, sustained
from .table_one import CELLS, TEXT, Cell

FORMAT = 3


@dataclass(frozen=True)
class Wanted:
    """How long a run may take. `quick` repeats measurements less often. Memory is watched for `soak_s`.

    `bitstreams` adds the rows of our gateware unpacked from its bitstream.
    """

    quick: bool
    soak_s: float
    say: Callable[[str], None]
    bitstreams: bool = False

    @property
    def run(self) -> Run:
        return Run(self.quick, find_checkout(), self.say)


def run_all(
    *,
    quick: bool,
    soak_s: float,
    say: Callable[[str], None],
    only: Sequence[str] = (),
    bitstreams: bool = False,
) -> dict[str, Any]:
    """Run all PARTS, or only those in `only`. `quick` repeats the measured ones less often.

    The modelled part is the same in both. Memory is watched for `soak_s`.
    `bitstreams` adds rows to the part gateware.

    >>> run_all(quick=True, soak_s=1.0, say=print, only=["simplicity"])["simplicity"]["paper"]["VHDL, copied"]
    what a user writes
    32
    """
    wanted = Wanted(quick, soak_s, say, bitstreams)
    results: dict[str, Any] = {
        "format": FORMAT,
        "quick": quick,
        "version": unitylink.__version__,
        "machine": machine(),
        "seeds": [],  # the model draws nothing at random
        "assumptions": assumptions(),
        "parts": [name for name in PARTS if not only or name in only],
    }
    for name in results["parts"]:
        say(PARTS[name].title)
        results.update(PARTS[name].measure(wanted))
    return results


@dataclass(frozen=True)
class Part:
    """A part that can run alone. Its measurements go into the results."""

    title: str
    measure: Callable[[Wanted], dict[str, Any]]


def _gateware(wanted: Wanted) -> dict[str, Any]:
    return {"gateware": [asdict(figures) for figures in level_one.all_figures(bitstreams=wanted.bitstreams)]}


def _table_one(wanted: Wanted) -> dict[str, Any]:
    cost = software_cost.measure(rounds=11 if wanted.quick else 101)
    figures, changed = model_figures(cost), ablations(cost)
    return {
        "software_cost": asdict(cost),
        "table_one": compared(CELLS, figures, changed),
        "text": compared(TEXT, figures, changed),
        "ours": _ours(cost),
    }


def _links(wanted: Wanted) -> dict[str, Any]:
    return {
        "links": [row for link in LINKS for row in _link_rows(link, quick=wanted.quick)],
        "bursts": _read_bursts(),
        "write_bursts": _write_bursts(),
    }


def _publishing(wanted: Wanted) -> dict[str, Any]:
    taken = [
        asdict(sustained(protocol, words, window_s=0.3 if wanted.quick else 2.0))
        for protocol in LINK_HZ
        for words in WORDS
    ]
    return {
        "publish_delays": [
            asdict(publish_delay(FT245_ASYNC, gateware, sends))
            for gateware in GATEWARES
            for sends in SEND_IMMEDIATE
        ],
        "publish": {"words": list(WORDS), "limits_hz": limits(), "sustained": taken},
    }


def _peers(wanted: Wanted) -> dict[str, Any]:
    rounds = 5 if wanted.quick else 41
    return {"peers": _measured(lambda: peers.compare(wanted.run, rounds=rounds, count=100))}


def _ros(wanted: Wanted) -> dict[str, Any]:
    return {"ros": ros_rates.rates(quick=wanted.quick, say=wanted.say)}


def _scaling(wanted: Wanted) -> dict[str, Any]:
    rounds, window_s = (5, 0.5) if wanted.quick else (51, 5.0)
    return {"scaling": scaling(rounds=rounds, window_s=window_s, memory_s=wanted.soak_s)}


def _simplicity(_: Wanted) -> dict[str, Any]:
    return {"simplicity": {"paper": PAPER, "ours": simplicity()}}


PARTS = {
    "gateware": Part("level 1: the gateware", _gateware),
    "table-one": Part("Table I: the model of the chip, and what this host's software costs", _table_one),
    "links": Part("level 2: other links", _links),
    "publishing": Part("publishing: what the full stack takes", _publishing),
    "peers": Part("peers: LiteX and a script on the same kind of wire", _peers),
    "scaling": Part("scaling", _scaling),
    "ros": Part("ROS", _ros),
    "simplicity": Part("what a user writes", _simplicity),
}


def compared(
    cells: Sequence[Cell], figures: dict[str, float], changed: Mapping[str, dict[str, float]]
) -> list[dict[str, Any]]:
    """Return a row for each cell: the paper, the model, and the model with each change."""

    def beside(cell: Cell, value: float) -> dict[str, float]:
        return {"model": value, "difference": value / cell.paper - 1}

    return [
        {
            **asdict(cell),
            "cause": cell.cause.words,
            "tried": [
                {"ablation": name, **beside(cell, changed[name][cell.model])} for name in cell.cause.tried
            ],
            **beside(cell, figures[cell.model]),
        }
        for cell in cells
    ]


def _measured(measure: Callable[[], list[dict[str, Any]]]) -> dict[str, Any]:
    """Return the rows, or the reason why there are none. A missing tool does not stop the other parts."""
    try:
        return {"rows": measure(), "failure": ""}
    except UnityLinkError as error:
        return {"rows": [], "failure": str(error)}


def _ours(cost: SoftwareCost) -> list[dict[str, Any]]:
    """Return the latencies of Table I for our gateware and our stack on the paper's link."""
    rows = []
    for gateware, exchanges, stack_s in (
        (CLASSIC, (read(), write()), (cost.stack_read_s, cost.stack_write_s)),
        (FRAMED, (framed_read(), framed_write()), (cost.framed_read_s, cost.framed_write_s)),
    ):
        for exchange, software_s in zip(exchanges, stack_s, strict=True):
            clocks = level_one.figures(gateware, exchange).latency_clocks
            assert clocks is not None
            gateware_s = clocks / CLOCK_HZ
            for sends in ("never", "all"):
                link = replace(FT245_ASYNC, send_immediate=sends)
                script_s = synchronous_s(link, exchange, gateware=gateware)
                rows.append(
                    {
                        "gateware": gateware,
                        "request": exchange.name,
                        "send_immediate": sends,
                        "bytes": exchange.bits // 8,
                        "gateware_s": gateware_s,
                        "ideal_s": exchange.bits * link.byte_s / 8 + gateware_s,
                        "script_s": script_s,
                        "stack_s": script_s + software_s,
                    }
                )
    return rows


def _read_bursts() -> list[dict[str, Any]]:
    """Reads that are sent together: as many as in the paper, or as many as fit the window of the framed
    protocol.
    """
    sizes = {"2012": LONG_BURST_REQUESTS, CLASSIC: LONG_BURST_REQUESTS, FRAMED: FRAME_WINDOW_DEFAULT}
    return [
        {"link": link.name, "gateware": gateware, **asdict(read_burst(link, size, gateware=gateware))}
        for link in (FT245_ASYNC, FT245_SYNC)
        for gateware, size in sizes.items()
    ]


def _write_bursts() -> list[dict[str, Any]]:
    """The paper's 30 writes, and 30 posts, on each gateware."""
    kinds = [("2012", write()), (CLASSIC, write()), (FRAMED, framed_write()), (FRAMED, framed_post())]
    return [
        {
            "gateware": gateware,
            "request": exchange.name,
            "send_immediate": sends,
            **asdict(write_burst(replace(FT245_ASYNC, send_immediate=sends), exchange, gateware=gateware)),
        }
        for gateware, exchange in kinds
        for sends in ("never", "all")
    ]


def _link_rows(link: LinkParameters, *, quick: bool) -> list[dict[str, Any]]:
    """Latencies of one link: when the chip waits for its timer, and when something makes it send."""
    classic = [
        read(),
        read(checked=True),
        write(),
        write(checked=True),
        read_many(32),
        read_many(LONGEST_READ),
    ]
    framed = [framed_read(), framed_write(), framed_read_many(32), framed_read_many(LONGEST_READ)]
    cases: list[tuple[str, int, list[Exchange]]] = [
        ("2012", 16, classic),
        ("2012", 256, classic),
        (CLASSIC, 16, classic),
        (CLASSIC, 256, classic),
        (FRAMED, 16, framed),
        (FRAMED, 256, framed),
    ]
    rows = []
    for gateware, fifo, exchanges in cases:
        if link.half_duplex:
            ways = {"latency timer": link, "send-immediate": replace(link, send_immediate="all")}
        else:
            end = GATEWARES[gateware].terminator
            ways = {"latency timer": link, "event character": replace(link, event_character=end)}
        rows += [
            {
                "link": link.name,
                "gateware": gateware,
                "sends": sends,
                "fifo": fifo,
                "latencies_s": {
                    exchange.title: synchronous_s(
                        chosen, exchange, gateware=gateware, fifo=fifo, count=2 if quick else 20
                    )
                    for exchange in exchanges
                },
            }
            for sends, chosen in ways.items()
        ]
    return rows
