# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the bus: masters, slaves, and what joins them."""

from __future__ import annotations

from block import Block, Mutant

BUS_BLOCKS = (
    Block(
        "wishbone_master",
        "`bus/wishbone_master`, 2-bit address, 8-bit data, timeout of 3 clocks",
        depth=16,
        pdr=True,
        not_proven="a slave that answers more than twice the timeout late",
        mutants=(
            Mutant("wishbone_master.vhd", "resting <= '1';", "resting <= '0';"),
            Mutant("wishbone_master.vhd", "        held    <= '0';\n      elsif", "      elsif"),
            Mutant("wishbone_master.vhd", "strobe and not expired;", "strobe;"),
            Mutant(
                "wishbone_master.vhd",
                "or wishbone_s2m.ack = '1' or wishbone_s2m.err = '1' then",
                "or waited = 1 then",
            ),
        ),
    ),
    Block(
        "wishbone_interconnect",
        "`bus/wishbone_interconnect`, three slaves, 32-bit addresses",
        depth=4,
        induction=2,
        quick=True,
        not_proven="other maps; arbitration, because there is only one master",
        mutants=(
            Mutant("wishbone_interconnect.vhd", "and not (or hit);", "and (nor hit) and not master_m2s.we;"),
            Mutant("wishbone_interconnect.vhd", "master_m2s.stb and hit(slave);", "master_m2s.stb;"),
            Mutant(
                "wishbone_interconnect.vhd",
                "unsigned(master_m2s.adr) <= last",
                "unsigned(master_m2s.adr) < last",
            ),
        ),
    ),
    Block(
        "wishbone_arbiter",
        "`bus/wishbone_arbiter`, three masters",
        depth=10,
        pdr=True,
        not_proven="other numbers of masters: the bench has one to three",
        mutants=(
            Mutant(
                "wishbone_arbiter.vhd", "found     := taken = '1';", "found := masters_m2s(last).cyc = '1';"
            ),
            Mutant(
                "wishbone_arbiter.vhd", "taken <= masters_m2s(now).cyc;", "taken <= masters_m2s(now).stb;"
            ),
            Mutant("wishbone_arbiter.vhd", "candidate := last;", "candidate := masters - 1;"),
            Mutant("wishbone_arbiter.vhd", "masters_s2m(master).err <= '0';", "null;"),
        ),
    ),
    Block(
        "wishbone_crossing",
        "`bus/wishbone_crossing`, two clocks of any ratio; depths in half clocks",
        depth=6,
        deep=28,
        several_clocks=True,
        not_proven="resets, timeouts, a master that gives up, the ends of blocks: the bench tests them",
        mutants=(
            Mutant("wishbone_crossing.vhd", "if done_seen = asked then", "if true then"),
            Mutant("wishbone_crossing.vhd", "answer_crossed <= answer_held;", "null;"),
            Mutant("wishbone_crossing.vhd", "if asked_seen /= done then", "if true then"),
        ),
    ),
    Block(
        "interrupt_slave",
        "`bus/interrupt_slave`, two lines",
        depth=10,
        pdr=True,
        not_proven="other numbers of lines; a master that gives an access up",
        mutants=(
            Mutant("interrupt_slave.vhd", "pending   <= kept or events;", "pending   <= kept;"),
            Mutant(
                "interrupt_slave.vhd",
                "kept := pending and not write_words(0)(lines_t'range);",
                "kept := (others => '0');",
            ),
            Mutant("interrupt_slave.vhd", "or (pending and write_words(1)(lines_t'range));", "or pending;"),
        ),
    ),
    Block(
        "fifo_slave",
        "`bus/fifo_slave`, two words of 8 bits in each direction, a reminder after 6 clocks",
        depth=14,
        pdr=True,
        not_proven="other sizes; a master that gives an access up: its word is lost",
        mutants=(
            Mutant("fifo_slave.vhd", "is_data = '1' and room > 0", "is_data = '1'"),
            Mutant(
                "fifo_slave.vhd",
                "when waiting > 0 and take = '0' and patience > 0",
                "when waiting > 0 and take = '0'",
            ),
            Mutant(
                "fifo_slave.vhd",
                "when waiting = 0 else '0';\n        elsif",
                "when oldest_valid = '0' else '0';\n        elsif",
            ),
            Mutant("fifo_slave.vhd", "when waiting > 0 and take = '0' and", "when waiting > 0 and"),
        ),
    ),
    Block(
        "wishbone_memory",
        "`bus/wishbone_memory`, 4 words of 8 bits",
        depth=10,
        pdr=True,
        not_proven="other sizes",
        mutants=(
            Mutant(
                "wishbone_memory.vhd",
                "unsigned(wishbone_m2s.adr) < words",
                "unsigned(wishbone_m2s.adr) <= words",
            ),
            Mutant("wishbone_memory.vhd", "asked and not inside and not reset;", "asked and not reset;"),
        ),
    ),
    Block(
        "double_buffer_slave",
        "`bus/double_buffer_slave`, 2 words of 8 bits",
        depth=10,
        pdr=True,
        not_proven="other sizes; a reset during an access",
        mutants=(
            Mutant(
                "double_buffer_slave.vhd",
                "write_index <= (not visible) & index;",
                "write_index <= visible & index;",
            ),
            Mutant(
                "double_buffer_slave.vhd",
                "banks(to_integer(unsigned'(visible & index)));",
                "banks(to_integer(unsigned'(not visible & index)));",
            ),
            Mutant(
                "double_buffer_slave.vhd",
                "user_write_ready <= not wishbone_m2s.cyc;",
                "user_write_ready <= not wishbone_m2s.stb;",
            ),
        ),
    ),
    Block(
        "axi_lite_master",
        "`bus/axi_lite_master`, 4-bit address, 8-bit data, timeout of 3 clocks",
        depth=14,
        pdr=True,
        not_proven="whether a write that ended `silent` took place: AXI cannot tell",
        mutants=(
            Mutant("axi_lite_master.vhd", "if over = '1' and given_up = '0' then", "if over = '1' then"),
            Mutant("axi_lite_master.vhd", "ar <= ar and not axi_lite_s2m.arready;", "ar <= '0';"),
            Mutant("axi_lite_master.vhd", "          given_up <= '1';", "          given_up <= '0';"),
        ),
    ),
    Block(
        "axi_lite_slave",
        "`bus/axi_lite_slave`, timeout of 3 clocks",
        depth=12,
        pdr=True,
        not_proven="that a slave which answered too late has forgotten the access: Wishbone demands it",
        mutants=(
            Mutant(
                "axi_lite_slave.vhd", "axi_lite_s2m.wready  <= not data_full;", "axi_lite_s2m.wready  <= '1';"
            ),
            Mutant("axi_lite_slave.vhd", "<= axi_lite_m2s.wstrb;", '<= "1111";'),
            Mutant("axi_lite_slave.vhd", "response <= axi_slave_error_c;", "null;"),
            Mutant("axi_lite_slave.vhd", "axi_lite_m2s.bready = '1' then", "true then"),
        ),
    ),
    Block(
        "bus_sequencer",
        "`common/bus_sequencer` with any program, one value, a failures_most of 3, words of 8 bits",
        depth=0,
        deep=12,
        pdr=True,
        reach=40,
        seen={
            name: f"dut.{name}"
            for name in (
                *("state", "word", "tick", "enable", "valid", "bank", "pointer", "failing"),
                *("in_a_row", "age", "failures"),
            )
        },
        loose=("dut.fetched", "dut.tick", "dut.timer"),
        not_proven="what the values are, outputs, and the times of a program: the benches have them; that a "
        "bus answers each byte: see `i2c_device` and `modbus_master_line`",
        mutants=(
            Mutant(
                "bus_sequencer.vhd", "ends and not failing and not wishbone_m2s.cyc;", "ends and not failing;"
            ),
            Mutant("bus_sequencer.vhd", "ends and not failing and not", "ends and not"),
            Mutant(
                "bus_sequencer.vhd",
                "when in_a_row = failures_most - 1 or",
                "when in_a_row = failures_most or",
            ),
            Mutant(
                "bus_sequencer.vhd",
                "(reply.failed = '1' or differs = '1') then\n        failing",
                "reply.failed = '1' then\n        failing",
            ),
            Mutant("bus_sequencer.vhd", "anew     <= halts or too_many;", "anew     <= too_many;"),
            Mutant(
                "bus_sequencer.vhd",
                "if reset = '1' or commits = '1' then\n        age",
                "if reset = '1' or starts = '1' then\n        age",
            ),
        ),
    ),
)
