# SPDX-License-Identifier: BSD-3-Clause
"""The report, from the results alone: the same results always give the same page and pictures."""

from __future__ import annotations

from typing import Any

from .document import Block, Code, Figure, Heading, Paragraph, Table
from .svg import log_bars, log_lines

TITLE = "The paper's experiments, repeated"
LATENCIES = "experiments-latencies.svg"
PUBLISHES = "experiments-publishes.svg"
_KINDS = ("Read", "Read:SI", "Write", "Write:SI")

CONVENTIONS = (
    "Conventions. The paper's 64 Mb/s is 67.1e6 bit/s. In the gateware's rows (i) and (o) are as seen from "
    "the FPGA, in all others from the PC. "
    "Request -> effect ends at the output of a bus register. The rate of a write burst is its bits over "
    "the first latency and n periods. "
    "A publish limit is the highest rate without loss."
)
MODEL = (
    "The link is a model, not a board: nothing here was measured on USB. The model has a clock of its own, "
    "so its figures are exact and the same on "
    "every machine. Its parameters, with what each rests on, are below; none is fitted to a single cell. "
    "What the PC of 2012 cost is not modelled."
)
MISSING = (
    "Not repeated yet: the framed protocol, the ROS rates of section VI.C, other bridges on the same wire, "
    "the full stack's sustained publish rate, and rates and memory in a long run. The paper's Fig. 4 is a "
    "picture without numbers: of it only what can be computed is drawn."
)


def report(results: dict[str, Any]) -> list[Block]:
    """Return the report of `results`."""
    form = " --quick" if results["quick"] else ""
    machine = ", ".join(f"{name} {value}" for name, value in results["machine"].items())
    cost = results["software_cost"]
    return [
        Heading(1, TITLE),
        Paragraph(
            "Section VI of the paper, on a model of its USB chip and the gateware's own clocks. "
            "Paper, model and difference stand beside each other for every cell of its Table I."
        ),
        Code(f"unitylink experiments{form} --out build/experiments"),
        Paragraph(f"Version {results['version']}; {machine}; nothing is drawn at random."),
        Paragraph(MODEL),
        Paragraph(CONVENTIONS),
        Heading(2, "Table I"),
        *(
            _compared(
                f"{kind}: paper and model, the gateware of 2012, FT245 asynchronous, FIFOs of 256 bytes.",
                rows,
            )
            for kind in _KINDS
            if (rows := [row for row in results["table_one"] if row["table"] == kind])
        ),
        Paragraph(
            "The rows of Unity-SW are the model's link plus the processor time of a layer-4 call on this "
            "host: "
            f"{_value(cost['stack_read_s'], 's')} a read, {_value(cost['stack_write_s'], 's')} a write, "
            "measured; a bare Python script takes "
            f"{_value(cost['script_read_s'], 's')} and {_value(cost['script_write_s'], 's')}. In a loop a "
            "part of it hides in the wait for USB."
        ),
        _compared("What section VI.B says beside the table.", results["text"]),
        Figure(
            "Latencies of synchronous reads and writes (the paper's Fig. 3); each pair is paper and model.",
            LATENCIES,
        ),
        Heading(2, "Level 1: the gateware"),
        _gateware(results["gateware"]),
        Heading(2, "Level 2: other links, other settings"),
        _links(results["links"]),
        _bursts(results["bursts"]),
        Heading(2, "Publishing"),
        Figure(
            "Highest rate of publishes against their size (the paper's Fig. 4): 50e6/(20+16n) for the "
            "gateware of 2012, 50e6/(10+8n) for ours, "
            "67.1e6/((10+8n)*8) for the ideal link; the chip's model takes a packet of 510 bytes a "
            "microframe.",
            PUBLISHES,
        ),
        _publishes(results["publish"]),
        Heading(2, "Scaling"),
        *_scaling(results["scaling"]),
        Heading(2, "What a user writes for the walker"),
        *_simplicity(results["simplicity"]),
        Heading(2, "What the model assumes"),
        Table(
            "Every parameter of the FT232H in asynchronous FT245 mode.",
            ["parameter", "value", "where it comes from"],
            [[row["name"], row["value"], row["source"]] for row in results["assumptions"]],
        ),
        Heading(2, "What is not here"),
        Paragraph(MISSING),
    ]


def pictures(results: dict[str, Any]) -> dict[str, str]:
    """Return the figures: file name to SVG."""
    publish = results["publish"]
    return {
        LATENCIES: _latency_bars(results),
        PUBLISHES: log_lines(
            publish["words"], publish["limits_hz"], "words in a message", "messages per second"
        ),
    }


def _latency_bars(results: dict[str, Any]) -> str:
    groups, paper, model = [], [], []
    for kind in _KINDS:
        for row, name in (("Unity GW", "GW"), ("Low-level python", "script"), ("Unity-SW", "stack")):
            cell = next(
                c
                for c in results["table_one"]
                if c["table"] == kind and c["row"] == row and c["quantity"] == "latency"
            )
            groups.append(f"{kind} {name}".replace("Read", "R").replace("Write", "W"))
            paper.append(cell["paper"] * 1e6)
            model.append(cell["model"] * 1e6)
    return log_bars(groups, {"paper": paper, "model": model}, "latency in us")


def _compared(caption: str, rows: list[dict[str, Any]]) -> Table:
    return Table(
        caption,
        ["row", "figure", "paper", "model", "difference", "cause"],
        [
            [
                row["row"],
                row["quantity"],
                _value(row["paper"], row["unit"]),
                _value(row["model"], row["unit"]),
                f"{100 * row['difference']:+.1f} %",
                row["cause"],
            ]
            for row in rows
        ],
    )


def _gateware(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "Clocks at 50 MHz through both FIFOs, bit rates at the steady period. 2012: the twin, which has "
        "that gateware's clocks. Ours: what the tests of the RTL "
        "hold it to. The paper's Table I has 57 and 28 for the read, 63 and 37 for the write.",
        ["gateware", "request", "first in to last out", "period", "requests", "replies"],
        [
            [
                row["gateware"],
                row["name"],
                "not held" if row["latency_clocks"] is None else str(row["latency_clocks"]),
                str(row["period_clocks"]),
                _value(row["request_hz"], "bit/s"),
                _value(row["reply_hz"], "bit/s"),
            ]
            for row in rows
        ],
    )


def _links(rows: list[dict[str, Any]]) -> Table:
    names = list(rows[0]["latencies_s"])
    return Table(
        "Latency of one request after another, in us, the gateware of 2012.",
        ["link", "sends by", "FIFO", *names],
        [
            [
                row["link"],
                row["sends"],
                str(row["fifo"]),
                *(f"{row['latencies_s'][name] * 1e6:.0f}" for name in names),
            ]
            for row in rows
        ],
    )


def _bursts(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "Reads sent together without send-immediate, FIFOs of 256 bytes: the rate of the replies by the "
        "gateware's time stamps, the same without pauses, and replies between two pauses.",
        ["link", "gateware", "requests", "reply rate", "without pauses", "between pauses"],
        [
            [
                row["link"],
                row["gateware"],
                str(row["requests"]),
                _value(row["stamped_hz"], "bit/s"),
                _value(row["unpaused_hz"], "bit/s"),
                str(row["between_pauses"]),
            ]
            for row in rows
        ],
    )


def _scaling(rows: dict[str, list[dict[str, Any]]]) -> list[Block]:
    captions = {
        "registers": "Processor time of a layer-4 read on this host against the registers in the spec.",
        "links": "The same, in turns over so many links in one process, each to a virtual board of its own.",
    }
    return [
        Table(
            caption,
            [name, *(str(row["count"]) for row in rows[name])],
            [["a read", *(_value(row["read_s"], "s") for row in rows[name])]],
        )
        for name, caption in captions.items()
    ]


def _publishes(publish: dict[str, Any]) -> Table:
    return Table(
        "The same as numbers, messages per second.",
        ["words", *publish["limits_hz"]],
        [
            [str(words), *(f"{limit[index]:.0f}" for limit in publish["limits_hz"].values())]
            for index, words in enumerate(publish["words"])
        ],
    )


def _simplicity(counts: dict[str, Any]) -> list[Block]:
    paper = counts["paper"]
    return [
        Table(
            "Lines that are neither empty nor only a comment.",
            ["specification", "written", "Python made of it", "VHDL made of it"],
            [
                [row["file"], str(row["written"]), str(row["python"]), str(row["vhdl"])]
                for row in counts["ours"]
            ],
        ),
        Paragraph(
            f"The paper has {paper['specification']} lines of specification, {paper['VHDL, configured']} "
            f"of VHDL written and {paper['VHDL, copied']} copied; "
            f"the microcontroller before it {paper['MCU, communication']} of C for the communication and "
            f"{paper['MCU, hardware']} of C and assembly for the hardware. "
            "A board's pins and servo drivers of your own are in neither column of ours. Nobody was timed."
        ),
    ]


def _value(value: float, unit: str) -> str:
    """Write a figure with four digits and a prefix a reader knows."""
    if unit == "s":
        return f"{value * 1e6:.4g} us"
    if unit == "bit/s":
        return f"{value / 1e6:.4g} Mb/s" if value >= 1e6 else f"{value / 1e3:.4g} kb/s"
    return f"{value:.4g}"
