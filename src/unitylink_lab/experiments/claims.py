# SPDX-License-Identifier: BSD-3-Clause
"""What the README claims, each with the place that shows it and, where there is one, the figure of this "
"run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .sustained import LINK_HZ

Results = dict[str, Any]


@dataclass(frozen=True)
class Claim:
    """`words` stand in the README. `section` is a heading of the report, or a page of the documents."""

    words: str
    section: str
    figure: Callable[[Results], str]


def _lines(results: Results) -> str:
    written, paper = results["simplicity"]["ours"][0]["written"], results["simplicity"]["paper"]
    return f"{written} lines for the walker of 18 joints; the paper has {paper['specification']}"


def _publishes(results: Results) -> str:
    shares = [
        row["rate_hz"] / LINK_HZ[row["protocol"]](row["words"]) for row in results["publish"]["sustained"]
    ]
    return f"at least {100 * min(shares):.0f} % of the ideal link's publishes, every size, either protocol"


def _clocks(gateware: str) -> Callable[[Results], str]:
    def figure(results: Results) -> str:
        read = next(
            row for row in results["gateware"] if (row["gateware"], row["name"]) == (gateware, "read")
        )
        return f"a read in {read['latency_clocks']} clocks, every {read['period_clocks']}; the paper: 57, 28"

    return figure


def _flipped(results: Results) -> str:
    outcomes = [f"{row['name']}: {row['flipped']['outcome']}" for row in results["peers"]["rows"]]
    return "a flipped bit: " + "; ".join(outcomes) if outcomes else "not measured in this run"


def _bursts(results: Results) -> str:
    burst = results["bursts"][0]
    return f"{burst['requests']} reads at once: {burst['stamped_hz'] / 1e6:.1f} Mb/s of replies"


def _ros(results: Results) -> str:
    rates = [
        f"{row['name']} {row['node_hz']:.0f}/s (the paper: {row['paper_hz']:.0f}/s)"
        for row in results["ros"]["rows"]
        if row["paper_hz"]
    ]
    return ", ".join(rates) or "not measured in this run"


def _table(results: Results) -> str:
    script = next(row for row in results["table_one"] if row["model"] and row["row"] == "Low-level python")
    return f"low-level read: paper {script['paper'] * 1e6:.0f} us, model {script['model'] * 1e6:.0f} us"


def _none(_: Results) -> str:
    return "no figure"


CLAIMS = (
    Claim("You write down once what lives at which address", "What a user writes for the walker", _lines),
    Claim("isochronous publishes", "docs/gateware/isochrony.md", lambda _: "`test_isochrony.py`"),
    Claim("a link that carries reads, writes and", "Publishing", _publishes),
    Claim("a twin of the gateware", "Level 1: the gateware", _clocks("2012")),
    Claim("lets more requests be under way at once", "Level 2: other links, other settings", _bursts),
    Claim(
        "ids, exactly-once writes, time-stamped publishes",
        "Other software on the same kind of wire",
        _flipped,
    ),
    Claim("is tried on a wire that does everything wrong", "docs/faults.md", lambda _: "`unitylink faults`"),
    Claim("Gateware of 2012 works as it is", "Table I", _table),
    Claim("Nobody had a board at hand", "What the model assumes", _none),
    Claim("in VHDL\n  without vendor cores", "Level 1: the gateware", _clocks("ours, classic")),
    Claim("open tools place it on two FPGAs", "docs/gateware/area.md", lambda _: "`make synth`"),
    Claim("with open tools, for five boards", "docs/build.md", lambda _: "`unitylink build`"),
    Claim("that VHDL as a board", "Level 1: the gateware", _clocks("ours, framed")),
    Claim("make a robot a node at once", "ROS", _ros),
)


def claims(results: Results) -> list[list[str]]:
    """Return a row for each claim: its words, the figure, and the place."""
    return [[" ".join(claim.words.split()), claim.figure(results), claim.section] for claim in CLAIMS]
