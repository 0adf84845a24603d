# SPDX-License-Identifier: BSD-3-Clause
"""What the cores of other libraries take, and the table that has our components beside them.

Theirs were measured with yosys 0.23 for iCE40: one channel, with the access to registers
that their library has. Only look-up tables and flip-flops were counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

HOSTMOT2, RIOCORE, FPGA_FOC = "hostmot2", "riocore", "FPGA-FOC"


@dataclass(frozen=True)
class Peer:
    """A core of another library beside a row of ours. `channels` are those of our row."""

    row: str
    library: str
    core: str
    luts: int
    flip_flops: int
    differs: str  # what one of them has and the other has not
    channels: int = 1


COMPONENT_PEERS = (
    Peer("stepgen", HOSTMOT2, "stepgen", 189, 172, "ours has ramps, limits and latches; theirs none", 4),
    Peer("stepgen", RIOCORE, "stepdir", 346, 100, "theirs has no ramps and no hold of the direction", 4),
    Peer(
        "quadrature_encoder",
        HOSTMOT2,
        "encoder",
        138,
        84,
        "theirs has 16 bits, a stamp and a latch",
    ),
    Peer("quadrature_encoder", RIOCORE, "quadencoder", 95, 38, "theirs has no filter, and counts no errors"),
    Peer("encoder_bank", HOSTMOT2, "encoder", 138, 84, "ours shares one adder", 8),
    Peer("encoder_bank", RIOCORE, "quadencoder", 95, 38, "ours shares one adder", 8),
    Peer(
        "pwm",
        HOSTMOT2,
        "pwmgen",
        52,
        71,
        "theirs shares a counter, which is not counted",
        4,
    ),
    Peer("pdm", HOSTMOT2, "pwmgen", 52, 71, "the same core in PDM mode", 4),
    Peer("three_phase_pwm", HOSTMOT2, "3pwmgen", 123, 139, ""),
    Peer("h_bridge", RIOCORE, "hbridge", 139, 47, "theirs drives on after a disable until its next compare"),
    Peer("absolute_encoder", HOSTMOT2, "ssi", 112, 186, "theirs takes up to 64 bits; the row has 13"),
    Peer("pulse_counter", RIOCORE, "freqin", 56, 58, ""),
    Peer("one_wire", RIOCORE, "ds18b20", 232, 101, "theirs reads two bytes, without the CRC"),
    Peer("hx711", RIOCORE, "hx711", 105, 87, "theirs drops 3 of the 24 bits"),
    Peer("sonar", RIOCORE, "sonar", 123, 97, ""),
    Peer("hall", RIOCORE, "Hall sensors", 1182, 73, "theirs has a division"),
    Peer(
        "foc",
        FPGA_FOC,
        "current loop",
        2509,
        1390,
        "theirs has 19 DSP and 25 RAM blocks too",
    ),
)


def peers_table(figures: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the lines of the section, from the figures of our rows."""
    lines = [
        "",
        "## Beside other libraries",
        "",
        "LUT4 and flip-flops of one channel on an iCE40, as yosys counts them. Ours are of the rows above,",
        "with their access to the bus. A row with several channels is divided by their number.",
        "Theirs were measured with the same yosys: one channel, with the access to registers that their",
        "library has. Block RAMs of theirs were counted only where the last column says so.",
        "",
        "| ours | channels | LUT4 | flip-flops | block RAM | theirs | LUT4 | flip-flops | what differs |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for peer in COMPONENT_PEERS:
        f = figures[peer.row]["ice40"]
        ours = " | ".join(_share(f[key], peer.channels) for key in ("luts", "flip_flops", "memories"))
        lines.append(
            f"| `{peer.row}` | {peer.channels} | {ours} | {peer.library}: {peer.core} | {peer.luts} "
            f"| {peer.flip_flops} | {peer.differs} |"
        )
    return lines


def _share(count: int, channels: int) -> str:
    share = count / channels
    return str(int(share)) if share == int(share) else f"{share:.1f}"
