# SPDX-License-Identifier: BSD-3-Clause
"""What is proven: one row for each block, with its depths and the faults that its proof must notice."""

from __future__ import annotations

from block import Block, Mutant
from bus_blocks import BUS_BLOCKS
from component_blocks import COMPONENT_BLOCKS
from device_blocks import DEVICE_BLOCKS
from framed_blocks import FRAMED_BLOCKS
from line_blocks import LINE_BLOCKS
from loop_blocks import LOOP_BLOCKS
from physical_blocks import PHYSICAL_BLOCKS
from sensor_blocks import SENSOR_BLOCKS
from small_blocks import SMALL_BLOCKS
from tosnet_blocks import TOSNET_BLOCKS

BLOCKS = (
    Block(
        "fifo",
        "`common/fifo`, 4 words of 2 bits",
        depth=10,
        pdr=True,
        quick=True,
        not_proven="other depths and widths: the proof is of the entity with these generics",
        mutants=(
            Mutant("fifo.vhd", "store <= write_valid and not full;", "store <= write_valid;"),
            Mutant("fifo.vhd", "load or (loaded and not read_ready)", "load or loaded"),
            Mutant("fifo.vhd", "load  <= not empty and", "load  <= "),
        ),
    ),
    Block(
        "crc8",
        "The checksum of the classic datalink, `datalink_pkg.next_checksum`, polynomial 07",
        depth=2,
        induction=1,
        quick=True,
        not_proven="other polynomials (the benches test them); `xor`",
        mutants=(
            Mutant(
                "datalink_pkg.vhd",
                "rest(place) := rest(place) xor bit7;",
                "rest(place) := rest(place) or bit7;",
            ),
            Mutant("datalink_pkg.vhd", "for step in 0 to 7 loop", "for step in 0 to 6 loop"),
        ),
    ),
    *BUS_BLOCKS,
    *PHYSICAL_BLOCKS,
    *TOSNET_BLOCKS,
    Block(
        "receiver",
        "`datalink/decoder` and `datalink/receiver`, CRC-8, messages of fewer than 5 entries",
        depth=7,
        deep=12,
        reach=8,
        pdr=True,
        not_proven="which of several errors is reported: the recordings of the 2012 gateware define it",
        mutants=(
            Mutant("receiver.vhd", "if in_tail = '1' and pairs = '1'", "if pairs = '1'"),
            Mutant("receiver.vhd", "(not in_tail or or sum or", "(not in_tail or"),
            Mutant(
                "receiver.vhd",
                "to_bit(entries = message_entries - 2);",
                "to_bit(entries = message_entries - 1);",
            ),
        ),
    ),
    Block(
        "decoder",
        "`datalink/decoder`",
        depth=6,
        pdr=True,
        mutants=(
            Mutant("decoder.vhd", "place >= 1 and place <= 26", "place >= 1 and place <= 27"),
            Mutant("decoder.vhd", "if place <= 6 then", "if place <= 7 then"),
            Mutant("decoder.vhd", "not full or character_ready;", "not full;"),
            Mutant("decoder.vhd", "if full = '0' or character_ready = '1' then", "if true then"),
        ),
    ),
    Block(
        "transmitter",
        "`datalink/transmitter`, CRC-8",
        depth=8,
        deep=14,
        pdr=True,
        not_proven="`digits` false; other checksums",
        mutants=(
            Mutant("transmitter.vhd", "              if place = 0 then", "              if true then"),
            Mutant("transmitter.vhd", "              if place = 2 then", "              if place = 1 then"),
            Mutant("transmitter.vhd", "if unsigned(value) < 10 then", "if unsigned(value) < 9 then"),
            Mutant("transmitter.vhd", "word_ready <= free and last;", "word_ready <= last;"),
            Mutant(
                "transmitter.vhd", "tx_last <= several and closes and last;", "tx_last <= several and last;"
            ),
            Mutant("transmitter.vhd", "              sum <= crc8_initial_c;", "              null;"),
        ),
    ),
    Block(
        "request_buffer",
        "`application/request_buffer`, messages of fewer than 7 entries, without publishing",
        depth=6,
        deep=14,
        reach=25,
        pdr=True,
        not_proven="longer messages, and the commands of publishing: the bench spells them all",
        mutants=(
            Mutant("request_buffer.vhd", "room   <= free;", "room   <= '1';"),
            Mutant("request_buffer.vhd", "if read_index + 1 = ending then", "if read_index = ending then"),
            Mutant(
                "request_buffer.vhd", "half_next <= read_half xor request_done;", "half_next <= read_half;"
            ),
            Mutant("request_buffer.vhd", "        checked <= receive.checked;\n", ""),
            Mutant(
                "request_buffer.vhd",
                "if request_done = '1' or rewind = '1' or reset = '1' then",
                "if request_done = '1' or reset = '1' then",
            ),
            Mutant("command_pkg.vhd", "receive.event = colon then", "false then"),
        ),
    ),
    Block(
        "application",
        "`application/application`, 8-bit address and data, read-many of 2 words, no publishing",
        depth=6,
        deep=12,
        reach=25,
        pdr=True,
        not_proven="publishing and the commands of groups; buses that answer later; other widths",
        mutants=(
            Mutant("application.vhd", "not (request.missing = '1' and serving = '1') then", "true then"),
            Mutant(
                "application.vhd",
                "request_done <= instruction(do_finish) and word_ready and serving;",
                "request_done <= instruction(do_finish) and serving;",
            ),
            Mutant("application.vhd", "elsif bii_response.status /= ok then", "elsif false then"),
            Mutant(
                "program_pkg.vhd",
                "take_bytes(data_bytes, act(do_shift_data), act(do_write), missing_data);",
                "take_bytes(data_bytes, act(do_shift_data), act(do_read), missing_data);",
            ),
        ),
    ),
    Block(
        "subscription_manager",
        "`application/subscription_manager`, two groups, a strobe every 8 clocks, rates up to 2",
        depth=6,
        deep=40,
        reach=45,
        pdr=True,
        not_proven="more groups, higher rates, what the memory of addresses holds, events by edge",
        mutants=(
            Mutant(
                "subscription_manager.vhd",
                "wanting      <= filled and (due or tripped);",
                "wanting      <= due or tripped;",
            ),
            Mutant(
                "subscription_manager.vhd",
                "rates(word_group) <= new_rate - 1;",
                "rates(word_group) <= new_rate;",
            ),
            Mutant("subscription_manager.vhd", "last_served <= group_number;", "last_served <= 0;"),
        ),
    ),
    Block(
        "tosnet_slave",
        "The commit of `bus/tosnet_slave`, two words, cycles of 5 clocks",
        depth=6,
        deep=14,
        reach=20,
        pdr=True,
        not_proven="the whole memory, what the PC reads from it, the asynchronous channel, halting",
        mutants=(
            Mutant(
                "tosnet_slave.vhd",
                "committed      <= exchange and pending;",
                "committed      <= cycle_ends and pending;",
            ),
            Mutant(
                "tosnet_slave.vhd", "commit or (commit_pending and not store);", "commit or commit_pending;"
            ),
            Mutant("tosnet_slave.vhd", "hidden      <= write_words;", "hidden      <= hidden;"),
        ),
    ),
    Block(
        "async_fifo",
        "`common/async_fifo`, 4 words of one bit, two clocks of any ratio; depths in half clocks",
        depth=8,
        deep=24,
        several_clocks=True,
        not_proven="resets; metastability, against which there is a `synchroniser`",
        mutants=(
            Mutant("async_fifo.vhd", "<= binary(unsigned(read_grey_seen));", "<= unsigned(read_grey_seen);"),
            Mutant("async_fifo.vhd", "when held < depth - margin", "when held <= depth - margin"),
            Mutant("async_fifo.vhd", "load or (loaded and not read_ready)", "load or loaded"),
            Mutant("async_fifo.vhd", "write_grey  <= grey(count);", "write_grey  <= grey(count + 1);"),
        ),
    ),
    Block(
        "dead_man",
        "`framed/dead_man`, two safe values, up to 3 ticks of 4 clocks, whatever the applications do",
        depth=8,
        deep=40,
        reach=24,
        pdr=True,
        not_proven="more values; longer times; that accesses end (see masters); that signs of life are real",
        mutants=(
            Mutant("dead_man.vhd", "and has_tripped and not passing;", "and has_tripped and ours;"),
            Mutant(
                "dead_man.vhd",
                "ours    <= writing and not passing;",
                "ours    <= writing and not asked.valid;",
            ),
            Mutant("dead_man.vhd", "asked.block_hold and not writing;", "asked.block_hold;"),
            Mutant("dead_man.vhd", "(tick and due and", "(tick and due and not asked.block_hold and"),
            Mutant("dead_man.vhd", "if request.alive = '1' or request.start", "if request.start"),
            Mutant(
                "dead_man.vhd", "if request.arm = '1' and tripped_now = '0' then", "if request.arm = '1' then"
            ),
            Mutant("dead_man.vhd", "            missed <= '1';", "            missed <= '0';"),
            Mutant("dead_man.vhd", "ours and not ended and not whole;", "ours and not whole;"),
            Mutant("dead_man.vhd", "or request.ticks and not has_tripped;", "or request.ticks;"),
            Mutant("dead_man.vhd", "(tick and missed and has_tripped) = '1'", "(tick and missed) = '1'"),
            Mutant("dead_man.vhd", "          missed  <= '0';\n          index ", "          index "),
        ),
    ),
    *FRAMED_BLOCKS,
    *SMALL_BLOCKS,
    *COMPONENT_BLOCKS,
    *SENSOR_BLOCKS,
    *LOOP_BLOCKS,
    *LINE_BLOCKS,
    *DEVICE_BLOCKS,
)
