# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the components that drive devices."""

from __future__ import annotations

from block import Block, Mutant

DEVICE_BLOCKS = (
    Block(
        "dshot",
        "`components/dshot`, the lines of two channels: bits of 16 clocks; a round begins at any clock",
        depth=0,
        deep=20,
        induction=3,
        by_abc=True,
        reach=24,
        seen={
            "words": "dut.write_words",
            "written": "dut.written",
            "state": "dut.state",
            "channel": "dut.channel",
            "waiting": "dut.commands",
            "repeats": "dut.repeats",
            "asked": "dut.asked",
            "is_throttle": "dut.is_throttle",
            "timer": "dut.timer",
            "bits": "dut.bits",
            "frame": "dut.frame",
        },
        loose=("dut.phase",),
        not_proven="`bidirectional`, the replies and the line that is let go; other rates: the bench",
        mutants=(
            Mutant(
                "dshot.vhd",
                "(minimum(asked(throttle_t'range), to_unsigned(throttle_most, 11)) + first_value)",
                "(asked(throttle_t'range) + first_value)",
            ),
            Mutant("dshot.vhd", "forgets   := repeats(channel) = 0;", "forgets   := repeats(channel) = 15;"),
            Mutant(
                "dshot.vhd",
                "if data = '1' then\n        go(pulse, one_clocks);",
                "if data = '1' then\n        go(pulse, bit_clocks);",
            ),
            Mutant("dshot.vhd", "go(rest, bit_clocks - zero_clocks);", "go(rest, bit_clocks - one_clocks);"),
            Mutant(
                "dshot.vhd",
                "            is_throttle <= '1';\n            forgets     := true;",
                "            is_throttle <= '1';",
            ),
            Mutant("dshot.vhd", "line_out   <= (others => idle_level);\n        line_drive", "line_drive"),
            Mutant(
                "dshot.vhd",
                "timer <= to_unsigned(clocks - 1, timer'length);",
                "timer <= to_unsigned(clocks, timer'length);",
            ),
        ),
    ),
    Block(
        "hx711",
        "`components/hx711`, `settle` 0, a timeout of 100 us; a us may end at any clock",
        depth=0,
        deep=10,
        induction=3,
        by_abc=True,
        reach=285,
        guided={"reset": 0, "tick": 1, "control": 5, "m2s_cyc": 0},
        seen={
            "in_a_row": "dut.tries.in_a_row",
            **{
                name: f"dut.{name}"
                for name in ("raw", "state", "now", "chosen", "left", "shift", "at_rail", "ended", "reason")
            },
        },
        given={"dut.tick": "ticks", "dut.write_words": "words"},
        not_proven="what the state says; other numbers of conversions to drop: the bench has them",
        mutants=(
            Mutant("hx711.vhd", "if ended = '1' then", "if false then"),
            Mutant(
                "hx711.vhd", "left <= to_unsigned(settle + 1, left'length);\n              end if;", "end if;"
            ),
            Mutant("hx711.vhd", "void       <= not enable or other;", "void       <= not enable;"),
            Mutant("hx711.vhd", "elsif now(2 downto 1) = chosen then", "elsif now(2 downto 1) = wanted then"),
            Mutant("hx711.vhd", "elsif now = timeout_us - 1 then", "elsif now = timeout_us then"),
            Mutant("hx711.vhd", "if now(reset_bit) = '1' then", "if now(reset_bit - 1) = '1' then"),
            Mutant("hx711.vhd", "at_rail <= raw xor shift(0);", "at_rail <= '0';"),
            Mutant(
                "hx711.vhd",
                "if raw = '0' then\n              ended",
                "if reset = '1' then\n              ended",
            ),
        ),
    ),
    Block(
        "i2c_device",
        "`components/i2c_device`, its lines: a quarter of a bit of 4 clocks, and one quarter of patience",
        depth=0,
        deep=40,
        induction=3,
        by_abc=True,
        reach=215,
        guided={"scl_in": 1, "first": 1},
        seen={
            "clocks": "dut.count",
            "ends_frame": "dut.last",
            "receives": "dut.receive",
            **{
                name: f"dut.{name}"
                for name in ("scl", "sda", "dirty", "state", "quarter", "bits", "bad", "shift", "again")
            },
        },
        not_proven="other rates; how many pulses free the bus; the program of `bus_sequencer`: the bench "
        "has them",
        mutants=(
            Mutant(
                "i2c_device_master.vhd",
                "held  <= quarter(1) and not quarter(0) and not scl;",
                "held  <= quarter(1) and quarter(0) and not scl;",
            ),
            Mutant(
                "i2c_device_master.vhd",
                "sda_drive <= receive and not last; -- the acknowledge",
                "sda_drive <= receive; -- the acknowledge",
            ),
            Mutant("i2c_device_master.vhd", "elsif sda = '1' and receive = '0' then", "elsif false then"),
            Mutant(
                "i2c_device_master.vhd",
                "sda_drive <= not receive and not shift(7);",
                "sda_drive <= not shift(7);",
            ),
            Mutant("i2c_device_master.vhd", "if last = '1' or bad = '1' then", "if last = '1' then"),
            Mutant(
                "i2c_device_master.vhd", "reply.failed <= bad or dirty or not sda;", "reply.failed <= bad;"
            ),
            Mutant(
                "i2c_device_master.vhd",
                "scl_drive  <= '0';\n        sda_drive  <= '0';\n        dirty",
                "scl_drive  <= '0';\n        dirty",
            ),
        ),
    ),
    Block(
        "ws2812",
        "`components/ws2812`, the line, one LED with three colours, a clock of 8 MHz, a pause of 25 us",
        depth=0,
        deep=30,
        induction=3,
        by_abc=True,
        reach=280,
        seen={
            name: f"dut.{name}"
            for name in (
                "found",
                "place",
                "fetch",
                "fetches",
                "fetched",
                "ack",
                "err",
                "on_now",
                "sending",
                "quiet",
                "clocks",
                "left",
                "ahead",
                "shift",
            )
        },
        loose=("dut.found",),
        not_proven="the colours in the memory and the event `sent`; other numbers of LEDs and clocks",
        mutants=(
            Mutant("ws2812.vhd", "quiet   <= '1';\n        clocks", "quiet   <= '0';\n        clocks"),
            Mutant(
                "ws2812.vhd",
                "(clocks = zero_clocks and shift(shift'high) = '0')",
                "(clocks = zero_clocks and shift(0) = '0')",
            ),
            Mutant("ws2812.vhd", "if ahead = end_place + pause then", "if ahead = end_place then"),
            Mutant("ws2812.vhd", "if ahead = end_place then", "if ahead = end_place + 1 then"),
            Mutant("ws2812.vhd", "shift <= found and (colour_t'range => on_now);", "shift <= found;"),
        ),
    ),
)
