# SPDX-License-Identifier: BSD-3-Clause
"""Table I of the paper as data, with the figure of the model that stands beside each cell."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cause:
    """Why model and paper may differ. `tried` are the ablations that show whether this is true."""

    words: str
    tried: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cell:
    """A number of the paper.

    `model` names the figure that is compared with it. `cause` says why the two may differ.

    `sd` is the paper's standard deviation, if it gives one.
    """

    table: str
    row: str
    quantity: str
    paper: float
    unit: str
    model: str
    cause: Cause
    sd: float | None = None


EXACT = Cause("rounding in the paper")
ASSUMED = Cause("the assumption itself")
APPROXIMATE = Cause("the paper's figure is approximate; the twin follows the simulation of the 2012 gateware")
HOST = Cause("not explained: the model gives whole microframes, the paper 26 to 29 us less", ("pause",))
SCRIPT = Cause("the script of 2012 read a port byte by byte", ("one-reply",))
ONE_PACKET = Cause("not explained: the script of 2012 needed 1.4 microframes for a reply", ("microframe",))
STACK = Cause("the Python stack of 2012 on its PC; the model uses our stack's cost on this host", ("stack",))
STACK_SI = Cause(
    "not explained: the paper's stack costs a read 98 us without SI and 428 us with it, "
    "a write 87 and 331 us",
    ("stack",),
)
OUT = Cause("driver and host controller of the PC, which the model leaves out", ("start",))
TURNS = Cause(
    "the chip took bytes faster than the paper's ideal row says, and did not take turns",
    ("two-buses", "fast", "fast-two-buses"),
)
FASTER = Cause("the chip took bytes faster than the paper's ideal row says", ("fast",))
BURST = Cause("the two causes above together", ("fast-two-buses", "all-out"))
BURST_SI = Cause("the two causes above, which cancel in part", ("fast", "all-out"))
LONG = Cause(
    "600 requests in the model, 200 and more in the paper: the initial fill of the chip counts "
    "less in a longer burst",
    ("shorter-burst", "two-buses"),
)
STAMPS = Cause("not explained: the model's requests come without a gap", ("two-buses",))
HELD = Cause("not explained; the model's first reply is in the chip before the chip is held")

EFFECT = "request -> effect"

CELLS = (
    Cell("Read", "Unity GW", "latency", 1.14e-6, "s", "read_gateware_s", EXACT),
    Cell("Read", "Unity GW", "throughput (i)", 85.7e6, "bit/s", "read_gateware_request_hz", EXACT),
    Cell("Read", "Unity GW", "throughput (o)", 200.0e6, "bit/s", "read_gateware_reply_hz", EXACT),
    Cell("Read", "FTDI FT245", "latency (ideal)", 3.524e-6, "s", "read_ideal_s", EXACT),
    Cell("Read", "FTDI FT245", "throughput (i,o)", 67.1e6, "bit/s", "link_hz", ASSUMED),
    Cell("Read", "Low-level python", "latency", 974e-6, "s", "read_script_s", HOST, sd=120e-6),
    Cell("Read", "Low-level python", "throughput (i+o)", 164.3e3, "bit/s", "read_script_hz", HOST),
    Cell("Read", "Low-level python*", "throughput (i)*", 889.8e3, "bit/s", "read_burst_received_hz", SCRIPT),
    Cell("Read", "Unity-SW", "latency", 1072e-6, "s", "read_stack_s", STACK, sd=17.5e-6),
    Cell("Read", "Unity-SW", "throughput (i+o)", 149.2e3, "bit/s", "read_stack_hz", STACK),
    Cell("Read:SI", "Unity GW", "latency", 1.14e-6, "s", "read_gateware_s", EXACT),
    Cell("Read:SI", "Unity GW", "throughput (i)", 85.7e6, "bit/s", "read_gateware_request_hz", EXACT),
    Cell("Read:SI", "Unity GW", "throughput (o)", 200.0e6, "bit/s", "read_gateware_reply_hz", EXACT),
    Cell("Read:SI", "FTDI FT245", "latency (ideal)", 3.524e-6, "s", "read_ideal_s", EXACT),
    Cell("Read:SI", "FTDI FT245", "throughput (i,o)", 67.1e6, "bit/s", "link_hz", ASSUMED),
    Cell("Read:SI", "Low-level python", "latency", 223.6e-6, "s", "read_script_si_s", HOST, sd=9.06e-6),
    Cell("Read:SI", "Low-level python", "throughput (i+o)", 715.6e3, "bit/s", "read_script_si_hz", HOST),
    Cell(
        "Read:SI",
        "Low-level python*",
        "throughput (i)*",
        639.1e3,
        "bit/s",
        "read_burst_si_received_hz",
        ONE_PACKET,
    ),
    Cell("Read:SI", "Unity-SW", "latency", 652e-6, "s", "read_stack_si_s", STACK_SI, sd=11.7e-6),
    Cell("Read:SI", "Unity-SW", "throughput (i+o)", 245.6e3, "bit/s", "read_stack_si_hz", STACK_SI),
    Cell("Write", "Unity GW", "latency", 1.26e-6, "s", "write_gateware_s", EXACT),
    Cell("Write", "Unity GW", EFFECT, 0.84e-6, "s", "write_gateware_effect_s", APPROXIMATE),
    Cell("Write", "Unity GW", "throughput (i)", 151.3e6, "bit/s", "write_gateware_request_hz", EXACT),
    Cell("Write", "Unity GW", "throughput (o)", 54.1e6, "bit/s", "write_gateware_reply_hz", EXACT),
    Cell("Write", "FTDI FT245", "throughput (i,o)", 67.1e6, "bit/s", "link_hz", ASSUMED),
    Cell("Write", "Low-level python", "latency", 971e-6, "s", "write_script_s", HOST, sd=76.81e-6),
    Cell("Write", "Low-level python", EFFECT, 19.9e-6, "s", "write_burst_first_s", OUT, sd=3.77e-6),
    Cell("Write", "Low-level python", "throughput (i+o)", 156.5e3, "bit/s", "write_script_hz", HOST),
    Cell("Write", "Low-level python*", "period (burst)*", 1.315e-6, "s", "write_burst_period_s", TURNS),
    Cell(
        "Write", "Low-level python*", "throughput (o)*, 30 writes", 56.6e6, "bit/s", "write_burst_hz", BURST
    ),
    Cell("Write", "Unity-SW", "latency", 1058e-6, "s", "write_stack_s", STACK, sd=16.64e-6),
    Cell("Write", "Unity-SW", "throughput (i+o)", 143.7e3, "bit/s", "write_stack_hz", STACK),
    Cell("Write:SI", "Unity GW", "latency", 1.26e-6, "s", "write_gateware_s", EXACT),
    Cell("Write:SI", "Unity GW", EFFECT, 0.84e-6, "s", "write_gateware_effect_s", APPROXIMATE),
    Cell("Write:SI", "Unity GW", "throughput (i)", 151.3e6, "bit/s", "write_gateware_request_hz", EXACT),
    Cell("Write:SI", "Unity GW", "throughput (o)", 54.1e6, "bit/s", "write_gateware_reply_hz", EXACT),
    Cell("Write:SI", "FTDI FT245", "throughput (i,o)", 67.1e6, "bit/s", "link_hz", ASSUMED),
    Cell("Write:SI", "Low-level python", "latency", 221.74e-6, "s", "write_script_si_s", HOST, sd=5.89e-6),
    Cell(
        "Write:SI",
        "Low-level python",
        EFFECT,
        19.03e-6,
        "s",
        "write_burst_si_first_s",
        OUT,
        sd=3.07e-6,
    ),
    Cell("Write:SI", "Low-level python", "throughput (i+o)", 685.5e3, "bit/s", "write_script_si_hz", HOST),
    Cell(
        "Write:SI", "Low-level python*", "period (burst)*", 1.159e-6, "s", "write_burst_si_period_s", FASTER
    ),
    Cell(
        "Write:SI",
        "Low-level python*",
        "throughput (o)*, 30 writes",
        62.5e6,
        "bit/s",
        "write_burst_si_hz",
        BURST_SI,
    ),
    Cell("Write:SI", "Unity-SW", "latency", 553e-6, "s", "write_stack_si_s", STACK_SI, sd=34.86e-6),
    Cell("Write:SI", "Unity-SW", "throughput (i+o)", 274.9e3, "bit/s", "write_stack_si_hz", STACK_SI),
)

# The statements of section VI.B beside the table.
TEXT = (
    Cell(
        "text",
        "burst of 200+",
        "reply rate, gateware time stamps",
        35.3e6,
        "bit/s",
        "long_burst_stamped_hz",
        LONG,
    ),
    Cell(
        "text",
        "burst of 200+",
        "the same without the pauses",
        64.2e6,
        "bit/s",
        "long_burst_unpaused_hz",
        LONG,
    ),
    Cell("text", "burst of 200+", "replies between two pauses", 36, "", "long_burst_between_pauses", LONG),
    Cell(
        "text",
        "burst of 18, SI",
        "reply rate, gateware time stamps",
        121.8e6,
        "bit/s",
        "burst_si_stamped_hz",
        STAMPS,
    ),
    Cell("text", "burst, SI", "most requests together", 18, "", "burst_si_most", HELD),
)
