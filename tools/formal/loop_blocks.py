# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the components that close a loop."""

from __future__ import annotations

from block import Block, Mutant

LOOP_BLOCKS = (
    Block(
        "pid",
        "`components/pid`, an output of 5 bits; sums of products that have any value",
        depth=8,
        pdr=True,
        reach=26,
        seen={
            "words": "dut.write_words",
            "state": "dut.state",
            "started": "dut.started",
            "is_tripped": "dut.is_tripped",
            "limit": "dut.limit",
            "is_high": "dut.is_high",
            "is_low": "dut.is_low",
            "sum": "dut.sum",
            "integral": "dut.integral",
            "result": "dut.result",
        },
        loose=("dut.phase", "dut.bit_count", "dut.term", "dut.sum", "dut.result"),
        not_proven="the arithmetic of the terms, the formats of the gains, and the time of a period: the "
        "bench has them; other widths",
        mutants=(
            Mutant(
                "pid.vhd",
                "elsif whole <= -signed('0' & limit) then",
                "elsif whole < -signed('0' & most) then",
            ),
            Mutant("pid.vhd", "if started = '0' then", "if started = '0' and runs = '0' then"),
            Mutant("pid.vhd", "not (is_high = '1' and sum > 0) and", "not (is_high = '1' and sum < 0) and"),
            Mutant("pid.vhd", "elsif integral < -edge then", "elsif false then"),
            Mutant("pid.vhd", "lost    <= not is_valid(feedback_wire);", "lost    <= '0';"),
            Mutant("pid.vhd", "if enable = '1' and enabled_before = '0' then", "if enable = '1' then"),
            Mutant("pid.vhd", "if runs = '0' or trips then", "if runs = '0' then"),
            Mutant("pid.vhd", "size := unsigned(-resize(error, 33));", "null;"),
        ),
    ),
)
