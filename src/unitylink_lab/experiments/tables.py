# SPDX-License-Identifier: BSD-3-Clause
"""The tables of the report, from the results."""

from __future__ import annotations

from typing import Any

from .ablations import ABLATIONS
from .document import Block, Paragraph, Table
from .peers import wire_of
from .sustained import LINK_HZ


def ours(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "Latency of one request after another on the paper's link, by level, with FIFOs of 256 bytes. "
        "The bytes are those of request and reply. The stack is the script's latency plus the cost of "
        "a layer-4 call on this host.",
        ["gateware", "request", "send-immediate", "bytes", "gateware", "ideal link", "script", "stack"],
        [
            [
                row["gateware"],
                row["request"],
                row["send_immediate"],
                str(row["bytes"]),
                *(value(row[name], "s") for name in ("gateware_s", "ideal_s", "script_s", "stack_s")),
            ]
            for row in rows
        ],
    )


def compared(caption: str, rows: list[dict[str, Any]]) -> Table:
    return Table(
        caption,
        ["row", "figure", "paper", "model", "difference", "cause, and the model's figure with it changed"],
        [
            [
                row["row"],
                row["quantity"],
                value(row["paper"], row["unit"]) + (f" (sd {value(row['sd'], 's')})" if row["sd"] else ""),
                value(row["model"], row["unit"]),
                f"{100 * row['difference']:+.1f} %",
                "; ".join([row["cause"], *(_tried(row, each) for each in row["tried"])]),
            ]
            for row in rows
        ],
    )


def _tried(row: dict[str, Any], each: dict[str, Any]) -> str:
    ablation, moved = ABLATIONS[each["ablation"]], value(each["model"], row["unit"])
    chosen = f" (chosen from the paper's {ablation.chosen})" if ablation.chosen else ""
    return f"{ablation.words}{chosen}: {moved} ({100 * each['difference']:+.1f} %)"


def gateware(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "Clocks at 50 MHz, with 32-bit words and 8-bit addresses, through both FIFOs, which are never "
        "full here. Bit rates are at the steady period. 2012 is the twin, which has that gateware's "
        "clocks. Ours is the generated VHDL of a spec of two words, compiled and run clock by clock, "
        "with both protocols on its port. The paper's Table I has 57 and 28 for the read, 63 and 37 "
        "for the write. A frame always has its checksum.",
        ["gateware", "request", "first in to last out", "to effect", "period", "requests", "replies"],
        [
            [
                row["gateware"],
                row["name"],
                clocks(row["latency_clocks"]),
                clocks(row["effect_clocks"]),
                str(row["period_clocks"]),
                value(row["request_hz"], "bit/s"),
                value(row["reply_hz"], "bit/s") if row["reply_hz"] else "none",
            ]
            for row in rows
        ],
    )


def clocks(count: int | None) -> str:
    return "none" if count is None else str(count)


def links(rows: list[dict[str, Any]]) -> Table:
    names = list(rows[0]["latencies_s"])
    return Table(
        "Latency of one request after another, in us. The FIFO column is the bytes in each direction. "
        "A read of many words is one request in classic, and lists of up to 60 words in framed. A "
        "frame always has its checksum.",
        ["link", "gateware", "sends by", "FIFO", *names],
        [
            [
                row["link"],
                row["gateware"],
                row["sends"],
                str(row["fifo"]),
                *(
                    f"{row['latencies_s'][name] * 1e6:.0f}" if name in row["latencies_s"] else "always"
                    for name in names
                ),
            ]
            for row in rows
        ],
    )


def bursts(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "Reads sent together without send-immediate, with FIFOs of 256 bytes. The table gives the "
        "rate of the replies by the gateware's time stamps, the same without pauses, and the replies "
        "between two pauses. A framed session has at most 32 requests in flight.",
        ["link", "gateware", "requests", "reply rate", "without pauses", "between pauses"],
        [
            [
                row["link"],
                row["gateware"],
                str(row["requests"]),
                value(row["stamped_hz"], "bit/s"),
                value(row["unpaused_hz"], "bit/s"),
                str(row["between_pauses"]),
            ]
            for row in rows
        ],
    )


def write_bursts(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "30 writes sent together, with FIFOs of 256 bytes, by the time at which they took effect. The "
        "paper has 19.9 us, 1.315 us and 56.6 Mb/s, with send-immediate 19.03 us, 1.159 us and 62.5 "
        "Mb/s. A post has no answer, so nothing goes back and nothing delays it. 30 answers of 10 "
        "bytes do not fit the FIFO while the chip is held.",
        ["gateware", "request", "send-immediate", "first effect", "period", "effective rate"],
        [
            [
                row["gateware"],
                row["request"],
                row["send_immediate"],
                value(row["first_s"], "s"),
                value(row["period_s"], "s"),
                value(row["effective_hz"], "bit/s"),
            ]
            for row in rows
        ],
    )


_OPERATIONS = {
    "read": "read",
    "write": "write, acknowledged",
    "block": "255 words read",
    "cycle": "18 written, 18 read",
}


def peers(measured: dict[str, Any]) -> list[Block]:
    """Return tables of times, bytes and faults, or the reason why there are none."""
    rows = measured["rows"]
    if not rows:
        return [Paragraph(f"Not measured: {measured['failure']}")]
    return [
        Table(
            "Times of a call, p50 / p99 in us. In brackets is the ratio to ours on frames and the "
            "same wire, within a round. Each client has its own device that answers at once, in "
            "another process behind a pty or on UDP. The clients take turns.",
            ["wire", "client", *_OPERATIONS.values()],
            [
                [
                    wire_of(row["name"]),
                    row["name"],
                    *(
                        f"{row[name]['p50_s'] * 1e6:.0f} / {row[name]['p99_s'] * 1e6:.0f} "
                        f"({_ratio(row[name]['ratio'])} x)"
                        for name in _OPERATIONS
                    ),
                ]
                for row in rows
            ],
        ),
        Table(
            "Bytes on the wire, to the device + back. On UDP it is the content of the datagrams. Each "
            "datagram has a head of 28 bytes more, and that of Ethernet.",
            ["client", *_OPERATIONS.values()],
            [
                [row["name"], *("{:.0f} + {:.0f}".format(*row["bytes"][name]) for name in _OPERATIONS)]
                for row in rows
            ],
        ),
        Table(
            "The columns: what a read gives when one bit of the answer is flipped, what the next read "
            "gives, and what a read does when the device no longer answers. RemoteClient ends after "
            "four seconds with 0 and no error (docs/faults.md has more such faults). On a network the "
            "checksums of Ethernet and UDP find most flipped bits before that. Here the bit flips "
            "after these checks, as in a buffer.",
            ["client", "a flipped bit", "the read after it", "a frozen device"],
            [
                [row["name"], *(_outcome(row[name]) for name in ("flipped", "after", "frozen"))]
                for row in rows
            ],
        ),
    ]


def _ratio(ratio: float) -> str:
    return f"{ratio:.3g}" if ratio < 1000 else f"{ratio:.0f}"


def _outcome(told: dict[str, Any]) -> str:
    if told["outcome"] == "right":
        return "the right value"
    what = f"{told['outcome']}: {told['detail']}".replace("|", "/")
    return what if told["outcome"] != "error" else f"{what} ({told['time_s']:.2g} s)"


def ros(measured: dict[str, Any]) -> list[Block]:
    """Return the rates, and the figures that could not be measured."""
    table = Table(
        "A single integer on a topic, sent as fast as possible. The table gives the messages a second "
        "of our node with the twin behind it, and of a bare publisher or subscriber in the same run. "
        "Into the FPGA it counts writes that the twin has answered.",
        ["topic", "paper", "our node", "bare", "share"],
        [
            [
                row["title"].partition(",")[0],
                "-" if row["paper_hz"] is None else f"{row['paper_hz']:.0f}",
                f"{row['node_hz']:.0f}",
                f"{row['bare_hz']:.0f}",
                f"{row['ratio']:.2f}",
            ]
            for row in measured["rows"]
        ],
    )
    missing = [Paragraph(f"Not measured: {name}: {why}") for name, why in measured["failures"].items()]
    return [*([table] if measured["rows"] else []), *missing]


def scaling(measured: dict[str, Any]) -> list[Block]:
    """Return the cost of a read and of a publish as things grow, and memory over time."""
    across = {
        "registers": "Processor time of a layer-4 read on this host, by the number of registers in the spec.",
        "links": "The same, in turns over several links in one process, each to its own virtual board.",
    }
    blocks: list[Block] = [
        Table(
            caption,
            [name, *(str(row["count"]) for row in measured[name])],
            [["a read", *(value(row["read_s"], "s") for row in measured[name])]],
        )
        for name, caption in across.items()
    ]
    cores = sorted({row["cores"] for row in measured["cores"]})
    links = sorted({row["links"] for row in measured["cores"]})
    by_place = {(row["cores"], row["links"]): row["read_s"] for row in measured["cores"]}
    publishing = [(str(row["count"]), row) for row in measured["groups"]]
    publishing += [("1", row) for row in measured["rates"]]
    memory = measured["memory"]
    return [
        *blocks,
        Table(
            "Wall time of that read, with the process and its boards on one core and on two. On one "
            "core, caller and board alternate. On two, each must wake the other's core. That costs "
            "most if the core sleeps deeply, as on an idle virtual machine.",
            ["links", *map(str, links)],
            [
                [f"{number} core{'s' if number > 1 else ''}"]
                + [value(by_place[number, count], "s") for count in links]
                for number in cores
            ],
        ),
        Table(
            "Processor time of the program that receives publishes in layer 4. The twin is another process.",
            ["groups", "rate of each", "received", "of a core", "a publish"],
            [
                [
                    name,
                    f"{row['hz']} Hz",
                    f"{row['received_hz']:.0f}/s",
                    f"{100 * row['core']:.2g} %",
                    value(row["publish_s"], "s"),
                ]
                for name, row in publishing
            ],
        ),
        Paragraph(
            f"Memory: over {0.8 * memory['duration_s']:.0f} s and {memory['publishes']:.0f} publishes the "
            f"process grew by {memory['grown_bytes'] / 1024:.0f} KiB, from "
            f"{memory['resident_bytes'] / 2**20:.0f} MiB. "
            "`unitylink experiments --soak 3600` measures for an hour."
        ),
    ]


def publish_delays(rows: list[dict[str, Any]]) -> Table:
    return Table(
        "The effect of send-immediate on publishes: four words at 961 Hz through the chip of the "
        "paper. Times are in us, from the last byte out of the gateware to the program.",
        ["gateware", "send-immediate after", "publishes", "mean", "most"],
        [
            [
                row["gateware"],
                "nothing" if row["send_immediate"] == "never" else row["send_immediate"],
                str(row["publishes"]),
                f"{row['mean_s'] * 1e6:.0f}",
                f"{row['most_s'] * 1e6:.0f}",
            ]
            for row in rows
        ],
    )


def sustained(rows: list[dict[str, Any]]) -> Table:
    framed = [row for row in rows if row["protocol"] == "framed"]
    classic = [row for row in rows if row["protocol"] == "classic"]
    return Table(
        "What the full stack receives without loss while it records all of it. It was measured over "
        "TCP, from a twin that publishes at the ideal link's rate and at twice that. The table gives "
        "messages per second, the share of the ideal 67.1e6 bit/s, and the processor time of twin and "
        "stack together. The next higher rate failed on the stack or on the source, which is the twin "
        "on the same machine. Our gateware has up to 60 words in a framed publish, and needs several "
        "for more. The twin has long frames.",
        ["words", "classic", "share", "of a core", "more", "framed", "share", "of a core", "more"],
        [
            [str(one["words"]), *_taken(one), *_taken(other)]
            for one, other in zip(classic, framed, strict=True)
        ],
    )


def _taken(row: dict[str, Any]) -> list[str]:
    share = row["rate_hz"] / LINK_HZ[row["protocol"]](row["words"])
    return [f"{row['rate_hz']:.0f}", f"{100 * share:.0f} %", f"{100 * row['core']:.0f} %", row["more"] or "-"]


def publishes(publish: dict[str, Any]) -> Table:
    return Table(
        "The limits that can be computed, in messages per second.",
        ["words", *publish["limits_hz"]],
        [
            [str(words), *(f"{limit[index]:.0f}" for limit in publish["limits_hz"].values())]
            for index, words in enumerate(publish["words"])
        ],
    )


def simplicity(counts: dict[str, Any]) -> list[Block]:
    paper = counts["paper"]
    return [
        Table(
            "Lines that are neither empty nor only a comment.",
            ["specification", "written", "generated Python", "generated VHDL"],
            [
                [row["file"], str(row["written"]), str(row["python"]), str(row["vhdl"])]
                for row in counts["ours"]
            ],
        ),
        Paragraph(
            f"The paper has {paper['specification']} lines of specification, {paper['VHDL, configured']} of "
            f"VHDL written and {paper['VHDL, copied']} copied. The microcontroller before it had "
            f"{paper['MCU, communication']} of C for the communication and {paper['MCU, hardware']} of C and "
            "assembly for the hardware. Our columns do not count a board's pins and your own servo drivers. "
            "Nobody was timed."
        ),
    ]


def value(value: float, unit: str) -> str:
    """Write a figure with four digits and a unit that readers know."""
    if unit == "s":
        return f"{value * 1e6:.4g} us"
    if unit == "bit/s":
        return f"{value / 1e6:.4g} Mb/s" if value >= 1e6 else f"{value / 1e3:.4g} kb/s"
    return f"{value:.4g}"
