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
            "limit_low": "dut.limit_low",
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
                "elsif is_below(whole, limit_low) or whole = limit_low then",
                "elsif whole < -signed('0' & most) then",
            ),
            Mutant("pid.vhd", "if started = '0' then", "if started = '0' and runs = '0' then"),
            Mutant(
                "pid.vhd",
                "if (is_high = '0' or sum(sum'high) = '1') and",
                "if (is_high = '0' or sum(sum'high) = '0') and",
            ),
            Mutant(
                "pid.vhd",
                "elsif is_below(integral(integral_t'high downto gain_bits), limit_low) then",
                "elsif false then",
            ),
            Mutant("pid.vhd", "lost    <= not is_valid(feedback_wire);", "lost    <= '0';"),
            Mutant("pid.vhd", "if enable = '1' and enabled_before = '0' then", "if enable = '1' then"),
            Mutant("pid.vhd", "if runs = '0' or trips then", "if runs = '0' then"),
            Mutant("pid.vhd", "unsigned(error xor (error'range => error(error'high)))", "unsigned(error)"),
            Mutant("pid.vhd", "(error(error'high) = '1' and size =", "(false and size ="),
        ),
    ),
    Block(
        "foc",
        "`components/foc`, duties of 5, 4 and 16 bits; products, sines and voltages that have any value",
        depth=8,
        pdr=True,
        reach=16,
        for_ever=("begins_anew", "none_when_off", "whole_period"),
        seen={
            "enable": "dut.enable",
            "is_tripped": "dut.is_tripped",
            "step": "dut.step",
            "integral_d": "dut.integral_d",
            "integral_q": "dut.integral_q",
        },
        loose=("dut.phase", "dut.product", "dut.done", "dut.sine", "dut.cosine", "dut.voltages", "dut.late"),
        not_proven="the arithmetic, the limit of the voltage, and the time of a period: the bench has them",
        mutants=(
            Mutant("foc.vhd", "duties_valid <= given and runs;", "duties_valid <= given;"),
            Mutant("foc.vhd", "if enable = '1' and enabled_before = '0' then", "if enable = '1' then"),
            Mutant("foc.vhd", "        given      <= '0';\n", ""),
            Mutant("foc.vhd", "elsif value < -most then", "elsif value < -most - 1 then"),
            Mutant("foc.vhd", "or not runs or not inputs_valid;", "or not runs;"),
            Mutant("foc.vhd", "integral_q <= (others => '0');\n        high_d", "high_d"),
        ),
    ),
    Block(
        "motion_profile",
        "`components/motion_profile` without smoothing; ways and brakes that may be anything",
        depth=8,
        induction=8,
        reach=40,
        seen={
            "enable": "dut.enable",
            "state": "dut.state",
            "speed": "dut.speed",
            "most": "dut.most",
            "ramp": "dut.ramp",
            "back": "dut.back",
            "place": "dut.place",
        },
        loose=("dut.phase", "dut.way", "dut.brake", "dut.further"),
        not_proven="that the way is never passed, the arithmetic of the brakes, smoothing: the bench has it",
        mutants=(
            Mutant(
                "motion_profile.vhd", "elsif has_room = '1' and fits = '1' then", "elsif has_room = '1' then"
            ),
            Mutant("motion_profile.vhd", "if is_valid(feedback_wire) = '1' then", "if false then"),
            Mutant(
                "motion_profile.vhd",
                "        velocity     <= (others => '0');\n        acceleration",
                "        acceleration",
            ),
            Mutant(
                "motion_profile.vhd",
                "back <= rest(rest'high);\n",
                "null;\n          end if;\n          if true then\n            back <= rest(rest'high);\n",
            ),
            Mutant("motion_profile.vhd", "speed <= speed - ramp;", "speed <= speed - ramp - 1;"),
        ),
    ),
    Block(
        "position_compare",
        "`components/position_compare`, pulses of 3 clocks, any positions, places and steps",
        depth=0,
        deep=5,
        induction=3,
        by_abc=True,
        reach=12,
        seen={
            "words": "dut.write_words",
            **{
                name: f"dut.{name}"
                for name in (
                    "written",
                    "at",
                    "count",
                    "past",
                    "valid",
                    "fresh",
                    "armed",
                    "pulse",
                    "left",
                    "above",
                    "is_active",
                )
            },
        },
        not_proven="other lengths of pulses; a line that rests high; what the bus reads: the bench has them",
        mutants=(
            Mutant("position_compare.vhd", "armed <= or step;", "armed <= '1';"),
            Mutant("position_compare.vhd", "past and armed and not level", "(past or armed) and not level"),
            Mutant("position_compare.vhd", "fresh and not written(0);", "fresh;"),
            Mutant("position_compare.vhd", "left  <= pulse_clocks - 1;", "left  <= pulse_clocks - 2;"),
            Mutant("position_compare.vhd", "(not at & not down);", "(not at & '1');"),
            Mutant(
                "position_compare.vhd", "if valid = '0' then\n        armed", "if false then\n        armed"
            ),
            Mutant("position_compare.vhd", "if enable = '0' or level = '1' then", "if level = '1' then"),
        ),
    ),
)
