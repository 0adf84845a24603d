# SPDX-License-Identifier: BSD-3-Clause
"""The report, made from the results alone. The same results always give the same page and pictures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from . import tables
from .claims import claims
from .document import Block, Code, Figure, Heading, Paragraph, Table
from .gateware import CLASSIC, FRAMED
from .sustained import LINK_HZ
from .svg import log_bars, log_lines

TITLE = "The paper's experiments, repeated"
LATENCIES = "experiments-latencies.svg"
PUBLISHES = "experiments-publishes.svg"
_KINDS = ("Read", "Read:SI", "Write", "Write:SI")

CONVENTIONS = (
    "Conventions. The paper's 64 Mb/s is 67.1e6 bit/s. In the gateware's rows (i) and (o) are as seen "
    "from the FPGA, in all others from the PC. Request -> effect ends at the output of a bus "
    "register. The rate of a write burst is its bits divided by the first latency plus n periods. A "
    "publish limit is the highest rate without loss. The paper's standard deviations (sd) are over "
    "its runs. The model has none. Our gateware has 256 bytes of FIFO in each direction unless a "
    "table says otherwise."
)
MODEL = (
    "The link is a model, not a board: nothing here was measured on USB. The model has its own clock, "
    "so its figures are exact and the same on every machine. Its parameters and their sources are "
    "listed below. One is inferred from a cell of the paper (the latency timer, from 974 us), so that "
    "cell is no evidence for the model. Beside a difference stands the model's figure with a "
    "suspected cause changed. If that does not move the cell towards the paper, the difference is not "
    "explained. The cost of the PC of 2012 is not modelled."
)
PEERS = (
    "LiteX is its released package 2024.12. CommUART has the port itself. CommUDP speaks Etherbone in "
    "datagrams. RemoteClient speaks Etherbone to litex_server, which has the port or the network. "
    "Each client uses its best call for a block. 'Etherbone packets' adds a feature that the packets "
    "allow but CommUDP does not offer: scattered addresses in one read, built with LiteX's own "
    "classes. The device at the far end is ours and takes packets of any length. LiteX's gateware "
    "holds 16 words by default. Neither UARTBone nor Etherbone acknowledges a write or carries a "
    "checksum, so a write is one that is read back. RemoteClient's write followed by a read waits "
    "some 40 ms for TCP's delayed acknowledgement (Nagle's algorithm). The script is what a user "
    "writes with pyserial on the classic protocol: 20 lines, no checksum. Ours writes 18 words and "
    "reads 18 by an exchange group, which is one frame each way, or on the classic protocol by "
    "pipelined requests. Absolute times are this machine's. The ratios say more."
)
ROS = (
    "Section VI.C measured 1.8 kHz from Unity-Link to ROS and 0.3 kHz the other way, because its "
    "subscriptions are synchronous writes. ROS 1 is that of Debian, with rosmaster. ROS 2 is "
    "cyclonedds, the middleware under it. Node and bare peer take turns. On a busy machine a share "
    "may still be above 1."
)
MISSING = (
    "A board: all of this is simulated, or measured on one PC. The paper's Fig. 4 is a picture "
    "without numbers, so only what can be computed is drawn. The cost of its PC of 2012 is not "
    "modelled."
)


def report(results: dict[str, Any]) -> list[Block]:
    """Return the report of `results`. They may hold some parts only."""
    form = " --quick" if results["quick"] else ""
    machine = ", ".join(f"{name} {value}" for name, value in results["machine"].items())
    parts = [name for name in _SECTIONS if name in results["parts"]]
    return [
        Heading(1, TITLE),
        Paragraph(
            "This page repeats section VI of the paper, on a model of its USB chip and the gateware's "
            "own clocks. It shows paper, model and difference for every cell of its Table I."
        ),
        Code(f"unitylink experiments{form} --out build/experiments"),
        Paragraph(f"Version {results['version']} on this machine: {machine}. Nothing is random."),
        Paragraph(MODEL),
        Paragraph(CONVENTIONS),
        *(
            block
            for part in parts
            for block in (
                *_SECTIONS[part](results),
                Paragraph(f"These figures alone: `unitylink experiments{form} --only {part}`."),
            )
        ),
        *(_claims(results) if len(parts) == len(_SECTIONS) else ()),
        Heading(2, "What the model assumes"),
        Table(
            "Every parameter of the FT232H in asynchronous FT245 mode.",
            ["parameter", "value", "where it comes from"],
            [[row["name"], row["value"], row["source"]] for row in results["assumptions"]],
        ),
        Heading(2, "What is missing"),
        Paragraph(MISSING),
    ]


def _table_one(results: dict[str, Any]) -> list[Block]:
    told = {name: tables.value(cost_s, "s") for name, cost_s in results["software_cost"].items()}
    return [
        Heading(2, "Table I"),
        *(
            tables.compared(
                f"{kind}: paper and model, the gateware of 2012, FT245 asynchronous, FIFOs of 256 bytes.",
                rows,
            )
            for kind in _KINDS
            if (rows := [row for row in results["table_one"] if row["table"] == kind])
        ),
        Paragraph(
            "The rows of Unity-SW are the model's link plus the processor time of a layer-4 call, "
            f"measured on this host: {told['stack_read_s']} a read, {told['stack_write_s']} a write, "
            f"framed {told['framed_read_s']} and {told['framed_write_s']}. A bare classic script takes "
            f"{told['script_read_s']} and {told['script_write_s']}. In a loop a part of it overlaps "
            "with the wait for USB."
        ),
        tables.compared("Further figures in the text of section VI.B.", results["text"]),
        Heading(2, "The same with our gateware and both protocols"),
        tables.ours(results["ours"]),
        Figure(
            "Latencies of synchronous reads (R) and writes (W), with send-immediate (SI) and without "
            "(the paper's Fig. 3). The bars are the paper's own with their standard deviations, the "
            "model of its system, and the model with our gateware, protocol and stack. GW is the "
            "gateware alone. Link is the ideal link of 67.1e6 bit/s with it. Whole microframes of USB "
            "hide the rest. The columns GW show what our gateware saves. Posts and publishes need no "
            "answer, so they do not wait for one.",
            LATENCIES,
        ),
    ]


def _gateware(results: dict[str, Any]) -> list[Block]:
    return [Heading(2, "Level 1: the gateware"), tables.gateware(results["gateware"])]


def _links(results: dict[str, Any]) -> list[Block]:
    return [
        Heading(2, "Level 2: other links, other settings"),
        tables.links(results["links"]),
        tables.bursts(results["bursts"]),
        tables.write_bursts(results["write_bursts"]),
    ]


def _publishing(results: dict[str, Any]) -> list[Block]:
    return [
        Heading(2, "Publishing"),
        Figure(
            "Highest rate of publishes against their size (the paper's Fig. 4). The gateware of 2012 "
            "reaches 50e6/(20+16n), our core 50e6/(10+8n). The ideal link reaches 67.1e6 bit/s over "
            "the bytes of a message. In the long run the chip's model takes a packet of 510 bytes per "
            "microframe. It takes a burst of up to 1276 bytes at the link's rate, because chip and "
            "FIFO hold it. The full stack is measured, at up to twice the ideal link's rate. The "
            "paper's own points are a picture without numbers.",
            PUBLISHES,
        ),
        tables.publish_delays(results["publish_delays"]),
        tables.sustained(results["publish"]["sustained"]),
        tables.publishes(results["publish"]),
    ]


def _peers(results: dict[str, Any]) -> list[Block]:
    return [
        Heading(2, "Other software on the same kind of wire"),
        Paragraph(PEERS),
        *tables.peers(results["peers"]),
    ]


def _ros(results: dict[str, Any]) -> list[Block]:
    return [Heading(2, "ROS"), Paragraph(ROS), *tables.ros(results["ros"])]


def _scaling(results: dict[str, Any]) -> list[Block]:
    return [Heading(2, "Scaling"), *tables.scaling(results["scaling"])]


def _simplicity(results: dict[str, Any]) -> list[Block]:
    return [Heading(2, "What a user writes for the walker"), *tables.simplicity(results["simplicity"])]


def _claims(results: dict[str, Any]) -> list[Block]:
    return [
        Heading(2, "What the README claims"),
        Table(
            "Each claim, its figure in this run, and the section or page that shows it.",
            ["claim", "figure", "where"],
            claims(results),
        ),
    ]


# In the order of the report.
_SECTIONS: dict[str, Callable[[dict[str, Any]], list[Block]]] = {
    "table-one": _table_one,
    "gateware": _gateware,
    "links": _links,
    "publishing": _publishing,
    "peers": _peers,
    "ros": _ros,
    "scaling": _scaling,
    "simplicity": _simplicity,
}


def pictures(results: dict[str, Any]) -> dict[str, str]:
    """Return the pictures of the parts that are there: file name to SVG."""
    made = {"table-one": (LATENCIES, _latency_bars), "publishing": (PUBLISHES, _publish_lines)}
    return {name: draw(results) for part, (name, draw) in made.items() if part in results["parts"]}


def _publish_lines(results: dict[str, Any]) -> str:
    publish = results["publish"]
    lines = dict(publish["limits_hz"])
    for protocol in LINK_HZ:
        taken = [row["rate_hz"] or None for row in publish["sustained"] if row["protocol"] == protocol]
        lines[f"full stack, {protocol}"] = taken
    return log_lines(publish["words"], lines, "words in a message", "messages per second")


def _latency_bars(results: dict[str, Any]) -> str:
    groups: list[str] = []
    series: dict[str, list[float | None]] = {"paper": [], "model of it": [], CLASSIC: [], FRAMED: []}
    deviations: list[float | None] = []
    for kind in _KINDS:
        request, _, immediate = kind.partition(":")
        for row, name, key in (
            ("Unity GW", "GW", "gateware_s"),
            ("FTDI FT245", "link", "ideal_s"),
            ("Low-level python", "script", "script_s"),
            ("Unity-SW", "stack", "stack_s"),
        ):
            if immediate and name in ("GW", "link"):
                continue  # send-immediate makes no difference to these
            cell = next(
                (
                    c
                    for c in results["table_one"]
                    if (c["table"], c["row"]) == (kind, row) and c["quantity"].startswith("latency")
                ),
                {"paper": None, "model": None, "sd": None},  # the paper gives no ideal latency of a write
            )
            groups.append(f"{kind} {name}".replace("Read", "R").replace("Write", "W"))
            series["paper"].append(_us(cell["paper"]))
            series["model of it"].append(_us(cell["model"]))
            deviations.append(_us(cell["sd"]))
            sends = "all" if immediate else "never"
            for our in results["ours"]:
                if (our["request"], our["send_immediate"]) == (request.lower(), sends):
                    series[our["gateware"]].append(_us(our[key]))
    return log_bars(groups, series, "latency in us", {"paper": deviations})


def _us(time_s: float | None) -> float | None:
    return None if time_s is None else time_s * 1e6
