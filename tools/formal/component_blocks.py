# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about components."""

from __future__ import annotations

from block import Block, Mutant

COMPONENT_BLOCKS = (
    Block(
        "gpio",
        "`components/gpio`, two pins without a filter",
        depth=14,
        pdr=True,
        not_proven="other numbers of pins; the filter; a master that gives an access up",
        mutants=(
            Mutant("gpio.vhd", "pin_out or write_words(3)(pins_t'range);", "write_words(3)(pins_t'range);"),
            Mutant(
                "gpio.vhd",
                "changed <= or ((levels xor before) and",
                "changed <= or ((levels and not before) and",
            ),
            Mutant("gpio.vhd", 'writable => "011111"', 'writable => "111111"'),
        ),
    ),
    Block(
        "pwm",
        "`components/pwm`, one channel, a period of 16 clocks",
        depth=8,
        deep=50,
        reach=70,
        pdr=True,
        seen={
            "step": "dut.step",
            "product": "dut.product",
            "word": "dut.word",
            "turning": "dut.turning",
        },
        not_proven="servos; several channels; longer periods; a master that gives an access up",
        mutants=(
            Mutant("pwm.vhd", "product <= (others => '1');", "product <= (others => '0');"),
            Mutant(
                "pwm.vhd",
                "left    <= to_unsigned(period - 1, left'length);",
                "left    <= to_unsigned(period - 2, left'length);",
            ),
            Mutant(
                "pwm.vhd",
                "if (writes or late) = '1' and reads = '0' then",
                "if writes = '1' and reads = '0' then",
            ),
            Mutant("pwm.vhd", "if counting = '0' or (tick", "if (tick"),
            Mutant("pwm.vhd", "word(word'high) = '1' and bit_number", "false and bit_number"),
        ),
    ),
    Block(
        "pdm",
        "`components/pdm`, two channels of 4 bits, 5 clocks a bit",
        depth=9,
        deep=16,
        reach=60,
        pdr=True,
        seen={"word": "dut.word", "total": "dut.total"},
        not_proven="other numbers of channels, bits and clocks; a master that gives an access up",
        mutants=(
            Mutant("pdm.vhd", "sum(sum'high) or word(word'high);", "sum(sum'high);"),
            Mutant("pdm.vhd", "(second and not word(word'high));", "second;"),
            Mutant(
                "pdm.vhd",
                "if (writes or late) = '1' and reads = '0' then",
                "if writes = '1' and reads = '0' then",
            ),
            Mutant("pdm.vhd", "period - 1, left'length", "period - 2, left'length"),
            Mutant("pdm.vhd", "(total_t'range => not clearing);", "(total_t'range => '1');"),
            Mutant("pdm.vhd", "to_unsigned(start, word_bits) when", "to_unsigned(0, word_bits) when"),
        ),
    ),
    Block(
        "h_bridge",
        "`components/h_bridge`, four gates, 16 clocks a period, a dead time of at least 3 clocks",
        depth=10,
        pdr=True,
        reach=40,
        seen={"enable": "dut.gates.enable"},
        loose=("dut.duty",),  # of the register or of a wire: any value at any clock
        not_proven="the lengths of pulses, longer dead times, and forms 1 and 2: the bench measures them",
        mutants=(
            Mutant("bridge_gates.vhd", "high <= high_on and not seen;", "high <= high_on;"),
            Mutant("bridge_gates.vhd", "seen = '1' or driven(leg)", "driven(leg)"),
            Mutant("bridge_gates.vhd", "(running or not enabled_before);", "'1';"),
            Mutant(
                "h_bridge.vhd", "low(1) & high(1) & low(0) & high(0);", "low(0) & high(1) & low(1) & high(0);"
            ),
            Mutant(
                "h_bridge.vhd",
                "(on_now and back) & (on_now and not back);",
                "on_now & (on_now and not back);",
            ),
        ),
    ),
    Block(
        "estop",
        "`components/estop`, two contacts, a filter of 3 clocks, a watchdog of 8",
        depth=18,
        pdr=True,
        reach=60,
        seen={"enable": "dut.enable", "fed": "dut.fed"},
        not_proven="other numbers of contacts and longer times; the bench measures them",
        mutants=(
            Mutant(
                "estop.vhd",
                "silent_clocks /= watchdog_clocks then",
                "is_open = '1' and silent_clocks < 8 then",
            ),
            Mutant(
                "estop.vhd",
                "if running = '1' and (breaks or silent) then",
                "if running = '1' and silent then",
            ),
            Mutant("estop.vhd", "enabled_before = '0' and is_open = '0'", "enabled_before = '0'"),
            Mutant("estop.vhd", "enabled_before = '0' and is_open = '0'", "is_open = '0'"),
            Mutant("estop.vhd", "is_open       <= or open_contacts;", "is_open       <= open_contacts(0);"),
            Mutant("estop.vhd", "elsif open_clocks /= filter_clocks then", "elsif running = '0' then"),
            Mutant("estop.vhd", "tripped        <= '0';\n      if", "if"),
        ),
    ),
    Block(
        "sonar",
        "`components/sonar`, a period of 20 us, echoes below 4 us, a clock of 1 MHz",
        depth=30,
        pdr=True,
        reach=80,
        seen={"enable": "dut.enable", "level": "dut.level"},
        not_proven="other times and clocks, what the state says, blocks of accesses: the bench has them",
        mutants=(
            Mutant("sonar.vhd", "if now(3 downto 0) = trigger_us - 1", "if now(3 downto 0) = trigger_us"),
            Mutant("sonar.vhd", "if is_long = '0' then", "if true then"),
            Mutant("sonar.vhd", "ended   <= armed;", "ended   <= '0';"),
            Mutant("sonar.vhd", "elsif hears = '0' and ended = '0' then", "elsif hears = '0' then"),
            Mutant("sonar.vhd", "          if level = '1' then", "          if hears = '1' then"),
            Mutant("sample_state.vhd", "if void = '1' then", "if reset = '1' then"),
            Mutant("sample_state.vhd", "if in_a_row = failures_most - 1", "if in_a_row = failures_most"),
        ),
    ),
    Block(
        "absolute_encoder",
        "`components/absolute_encoder`, its lines with SSI: 2 bits, half a period of 3 clocks, a pause of 10",
        depth=30,
        pdr=True,
        reach=60,
        not_proven="other numbers of bits and rates, position: the bench has them; BiSS-C and SPI are below",
        mutants=(
            Mutant(
                "absolute_encoder_line.vhd", "timer    <= half_clocks - 1;", "timer    <= half_clocks - 2;"
            ),
            Mutant("absolute_encoder_line.vhd", "if takes and left = 0 then", "if takes and left = 1 then"),
            Mutant(
                "absolute_encoder_line.vhd",
                "state <= resting;\n            timer <= pause_clocks - 1;",
                "state <= resting;\n            timer <= 0;",
            ),
            Mutant("absolute_encoder_line.vhd", "sclk  <= rest;", "sclk  <= not sclk and level;"),
        ),
    ),
    Block(
        "absolute_encoder_biss",
        "`components/absolute_encoder`, its lines with BiSS-C: 2 bits, half a period of 3 clocks, a pause of "
        "10, and 40 clocks for an answer",
        depth=0,
        deep=20,
        induction=3,
        by_abc=True,
        reach=150,
        guided={"ask": 1, "accept": 1},
        seen={
            name: f"dut.{name}"
            for name in (
                *(
                    "level",
                    "state",
                    "stage",
                    "timer",
                    "sampler",
                    "patience",
                    "left",
                    "done",
                    "crc",
                    "is_error",
                ),
                "command",
            )
        },
        not_proven="other numbers of bits and rates: the bench tries them; the filter; the position",
        mutants=(
            Mutant("absolute_encoder_line.vhd", "if left <= bits + 7 then", "if left <= bits + 6 then"),
            Mutant(
                "absolute_encoder_line.vhd",
                'kind = biss and crc /= "000000" then',
                "kind = biss and crc(5) = '1' then",
            ),
            Mutant(
                "absolute_encoder_line.vhd",
                "sampler <= 2 * half_clocks - 1;",
                "sampler <= 2 * half_clocks - 2;",
            ),
            Mutant("absolute_encoder_line.vhd", "is_error <= not level;", "is_error <= level;"),
            Mutant(
                "absolute_encoder_line.vhd",
                "if stage /= data and patience = 0 then",
                "if stage = start and patience = 0 then",
            ),
            Mutant(
                "absolute_encoder_line.vhd",
                "state <= resting;\n            timer <= pause_clocks - 1;",
                "state <= resting;\n            timer <= 0;",
            ),
        ),
    ),
    Block(
        "absolute_encoder_spi",
        "`components/absolute_encoder`, its lines with an AS5047P: 14 bits, half a period of 3 clocks, "
        "pauses of 4",
        depth=0,
        deep=20,
        induction=3,
        by_abc=True,
        reach=680,
        guided={"again": 0, "ask": 1, "accept": 1},
        seen={
            "first": "dut.filter.pin_synchroniser.first",
            "middle": "dut.filter.settled",
            **{
                name: f"dut.{name}"
                for name in (
                    *("level", "state", "timer", "left", "done", "primed", "second", "renews", "command"),
                    *("parity", "is_error"),
                )
            },
        },
        not_proven="other numbers of bits and rates: the bench tries them; the position",
        mutants=(
            Mutant("absolute_encoder_line.vhd", "parity <= parity xor level;", "parity <= level;"),
            Mutant("absolute_encoder_line.vhd", "(second = '0' and shift = 0) or (is_error", "(is_error"),
            Mutant("absolute_encoder_line.vhd", "if renews = 2 then", "if renews = 1 then"),
            Mutant(
                "absolute_encoder_line.vhd",
                "renews <= 2;\n            elsif",
                "renews <= 1;\n            elsif",
            ),
            Mutant(
                "absolute_encoder_line.vhd",
                "timer    <= pause_clocks - 1;\n              state    <= deselected;",
                "timer    <= 0;\n              state    <= deselected;",
            ),
            Mutant(
                "absolute_encoder_line.vhd",
                "timer = half_clocks - latency;",
                "timer = half_clocks - latency + 1;",
            ),
            Mutant("absolute_encoder_line.vhd", "if left = 14 then", "if left = 13 then"),
        ),
    ),
    Block(
        "spi_device",
        "`components/spi_device`, its lines: mode 1, half a period of 2 clocks, pauses of 3",
        depth=20,
        pdr=True,
        reach=60,
        not_proven="other modes and rates, and the bytes themselves: the benches try them; the program",
        mutants=(
            Mutant("spi_master.vhd", "to_unsigned(half_clocks - 1,", "to_unsigned(half_clocks - 2,"),
            Mutant("spi_master.vhd", "to_unsigned(pause_clocks - 1,", "to_unsigned(half_clocks - 1,"),
            Mutant("spi_master.vhd", "over and is_behind and not place(0) and", "over and not place(0) and"),
            Mutant("spi_master.vhd", "(not next_place(4) and (second_edge", "((second_edge"),
            Mutant("spi_master.vhd", "over and place(0) and not place(4);", "over and not place(0);"),
            Mutant("spi_master.vhd", "take(1) and not request.last", "take(1)"),
        ),
    ),
    Block(
        "pulse_generator",
        "`components/pulse_generator`, words of 16 bits",
        depth=10,
        pdr=True,
        reach=40,
        seen={"frequency": "dut.asked", "burst": "dut.burst", "to_go": "dut.to_go"},
        loose=("dut.half", "dut.left", "dut.fine"),  # half a period and a width end at any clock
        not_proven="the times and the widths of the pulses: the bench has them, clock by clock",
        mutants=(
            Mutant("pulse_generator.vhd", "due and wants and not active;", "due and wants;"),
            Mutant("pulse_generator.vhd", "if (written(0) and off) = '1' or stopped", "if stopped"),
            Mutant("pulse_generator.vhd", "pulled or (halted and not written(0));", "pulled;"),
            Mutant("pulse_generator.vhd", "to_go <= to_go - 1;", "to_go <= to_go - 2;"),
            Mutant("pulse_generator.vhd", "to_go = 0 then\n        to_go", "to_go /= 1 then\n        to_go"),
            Mutant("pulse_generator.vhd", "and not ends)) and not stopped;", "and not ends));"),
        ),
    ),
    Block(
        "stepgen_pulse",
        "`components/stepgen`, the pins STEP and DIR of an axis",
        depth=24,
        pdr=True,
        not_proven="other times: the proof is of 3, 2, 4 and 2 clocks",
        mutants=(
            Mutant("stepgen_pulse.vhd", "setup_clocks - 1;", "setup_clocks - 2;"),
            Mutant("stepgen_pulse.vhd", "timer <= space_clocks - 1;", "timer <= 0;"),
            Mutant("stepgen_pulse.vhd", "timer <= length_clocks - 1;", "timer <= length_clocks - 2;"),
            Mutant("stepgen_pulse.vhd", "timer <= hold_clocks - 1;", "timer <= 0;"),
            Mutant("stepgen_pulse.vhd", "and state /= holding else", "else"),
            Mutant(
                "stepgen_pulse.vhd",
                "ask = '1' and ready = '1' and down /= direction",
                "ask = '1' and ready = '1'",
            ),
        ),
    ),
    Block(
        "stepgen_motion",
        "`components/stepgen`, the steps and the positions of two axes, at eight clocks a base period",
        depth=20,
        reach=110,
        pdr=True,
        loose=("dut.beyond", "dut.down"),
        seen={"asks": "dut.ask", "takes": "dut.taken", "stores": "dut.store"},
        not_proven="the arithmetic of a phase: a step may be wanted at any base period; other numbers "
        "of axes; the latches (the bench tests them)",
        mutants=(
            Mutant("stepgen_motion.vhd", "(ask = '1' and taken = '0')", "(ask = '1' and down = '0')"),
            Mutant("stepgen_motion.vhd", "moved(axis_last) <= '1';", "moved(axis_last) <= down;"),
            Mutant("stepgen_motion.vhd", "if direction(slot - positions_at) = '1'", "if direction(0) = '1'"),
            Mutant("stepgen_motion.vhd", "phases_at + maximum(axes, 3);", "phases_at + axes;"),
            Mutant("stepgen_motion.vhd", "moved(axis_now) <= '0';", "moved(axis_now) <= down;"),
        ),
    ),
    Block(
        "stepgen_ramp",
        "`components/stepgen`, the velocities of one axis: any parameters, which change between two passes",
        depth=0,
        deep=12,
        induction=4,
        by_abc=True,
        reach=62,
        seen={
            name: f"dut.{name}"
            for name in (
                *("state", "executes", "adds", "sum", "slower", "goal_down", "goes", "to_target", "brakes"),
                *("place", "tick"),
            )
        },
        loose=("dut.count",),
        not_proven="where a move brakes: the bench compares it with the equations of motion; parameters that "
        "are written in the middle of a pass",
        mutants=(
            Mutant(
                "stepgen_ramp.vhd",
                "carry     <= not sum(31);\n      when load_goal",
                "carry     <= sum(31);\n      when load_goal",
            ),
            Mutant(
                "stepgen_ramp.vhd",
                "minus     <= not sum(31);\n        carry     <= not sum(31);\n      when load_velocity",
                "minus     <= sum(31);\n        carry     <= not sum(31);\n      when load_velocity",
            ),
            Mutant("stepgen_ramp.vhd", "if sum(31) /= slower then", "if sum(31) = slower then"),
            Mutant("stepgen_ramp.vhd", "word_velocity when bank = '0'", "word_velocity when bank = '1'"),
            Mutant("stepgen_ramp.vhd", "if goes = '1' and brakes = '0' then", "if brakes = '0' then"),
            Mutant(
                "stepgen_ramp.vhd",
                "if to_target = '0' and sum(31) /= goal_down then",
                "if to_target = '0' then",
            ),
            Mutant("stepgen_ramp.vhd", "(state = await_shift and shifted = '1')", "state = await_shift"),
            Mutant("stepgen_ramp.vhd", "when state = put_shift else", "when state = await_shift else"),
        ),
    ),
    Block(
        "three_phase_pwm",
        "`components/three_phase_pwm`, 16 clocks a period, a dead time of at least 3 clocks",
        depth=10,
        pdr=True,
        reach=40,
        seen={"enable": "dut.enable"},
        not_proven="the lengths of pulses, and longer dead times: the bench measures them",
        mutants=(
            Mutant("bridge_gates.vhd", "high <= high_on and not seen;", "high <= high_on;"),
            Mutant("bridge_gates.vhd", "code   := code_before(code);", "code := code_last;"),
            Mutant("bridge_gates.vhd", "seen = '1' or driven(leg)", "driven(leg)"),
            Mutant("bridge_gates.vhd", "codes(leg)   <= dead_code;", "codes(leg) <= code_last;"),
            Mutant("bridge_gates.vhd", "(running or not enabled_before);", "'1';"),
            Mutant("bridge_gates.vhd", "side(leg) and (over or high_on(leg));", "side(leg);"),
            Mutant("three_phase_pwm.vhd", "enable and not ends and", "enable and"),
            Mutant("three_phase_pwm.vhd", "(not lost or not enabled_before);", "not ends;"),
        ),
    ),
    Block(
        "quadrature_encoder_counts",
        "`components/quadrature_encoder`, the words of one encoder, of 8 bits, with its index",
        depth=0,
        deep=10,
        induction=3,
        by_abc=True,
        reach=52,
        seen={
            "clocks": "dut.count",
            "begins": "dut.starting",
            "shut": "dut.closed",
            "old": "dut.whole",
            "for_bus": "dut.shown",
            "is_due": "dut.due",
            "indexes": "dut.has_index",
            "fails": "dut.has_failed",
            "a_was": "dut.a_before",
            "b_was": "dut.b_before",
            "index_was": "dut.index_before",
            "puts": "dut.put",
            "thaws": "dut.thawed",
            "acks": "dut.ack",
            "errs": "dut.err",
            **{name: f"dut.{name}" for name in ("bank", "now", "sum", "steps", "index_steps", "reads")},
        },
        not_proven="stamps and several channels; longer words; how long a write waits; a master that gives "
        "an access up",
        mutants=(
            Mutant(
                "quadrature_encoder_counts.vhd", "total                := by;", "total := (others => '0');"
            ),
            Mutant("quadrature_encoder_counts.vhd", "given  <= preset;", "given  <= '0';"),
            Mutant("quadrature_encoder_counts.vhd", "if has_index(channel) = '0' then", "if true then"),
            Mutant("quadrature_encoder_counts.vhd", "bank <= bank xor shown;", "bank <= not bank;"),
            Mutant(
                "quadrature_encoder_counts.vhd", "starting = '1' or reset = '1' then", "starting = '1' then"
            ),
            Mutant("quadrature_encoder_counts.vhd", "thawed or (put and last)", "thawed"),
        ),
    ),
)
