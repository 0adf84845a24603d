# SPDX-License-Identifier: BSD-3-Clause
"""What is proven: one row for each block, with its depths and the faults that its proof must notice."""

from __future__ import annotations

from block import Block, Mutant
from bus_blocks import BUS_BLOCKS
from component_blocks import COMPONENT_BLOCKS
from device_blocks import DEVICE_BLOCKS
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
        ),
    ),
    Block(
        "frame_dispatcher",
        "`framed/frame_dispatcher`",
        depth=8,
        deep=20,
        pdr=True,
        not_proven="that the program returns for work: with an answer it waits for room",
        mutants=(
            Mutant("frame_dispatcher.vhd", "publish = '1' and room = '1'", "publish = '1'"),
            Mutant("frame_dispatcher.vhd", "frame_valid and says_nothing", "'0'"),
            Mutant(
                "frame_dispatcher.vhd",
                "deadman and tripped = '1'",
                "deadman and tripped = '1' and frame_valid = '0'",
            ),
            Mutant("frame_dispatcher.vhd", "receive_overran <= receive_overrun;", "receive_overran <= '1';"),
            Mutant("frame_dispatcher.vhd", "asks and due and not begins", "asks and not begins"),
            Mutant("frame_dispatcher.vhd", "elsif publish_overrun = '0' and begins", "elsif begins"),
        ),
    ),
    Block(
        "frame_receiver",
        "`framed/frame_receiver`, requests of up to 2 bytes, a ring of 32",
        depth=4,
        deep=13,
        not_proven="the bytes of the payload, and room in the ring: the benches compare with the reference",
        mutants=(
            Mutant("frame_receiver.vhd", "delay(1) /= check_byte(crc, 1) or ", ""),
            Mutant("frame_receiver.vhd", "elsif coded = '0' or at_code = '0' or", "elsif coded = '0' or"),
            Mutant(
                "frame_receiver.vhd",
                "elsif outside = '0' and and epoch(15 downto 8) = '1' then",
                "elsif false then",
            ),
            Mutant("frame_receiver.vhd", "(7 downto 0 => kept)", "(7 downto 0 => '1')"),
        ),
    ),
    Block(
        "reply_cache",
        "`framed/reply_cache`, a window of 2",
        depth=6,
        deep=12,
        pdr=True,
        seen={"entry": "dut.entry"},
        not_proven="the bytes of kept replies, `order`, other windows: the bench tests them",
        mutants=(
            Mutant(
                "reply_cache.vhd", "new_id   <= not ahead(15) and not same;", "new_id   <= not ahead(15);"
            ),
            Mutant("reply_cache.vhd", "repeated <= same and nand entry(8 downto 5);", "repeated <= same;"),
            Mutant("reply_cache.vhd", "new_id   <= not ahead(15) and", "new_id   <="),
        ),
    ),
    Block(
        "frame_transmitter",
        "`framed/frame_transmitter`",
        depth=2,
        deep=13,
        not_proven="payloads of more than a few bytes, and that they can be decoded: the bench tests them",
        mutants=(
            Mutant(
                "frame_transmitter.vhd",
                "codes  <= ends or nor data;",
                "codes  <= ends;",
            ),
            Mutant("frame_transmitter.vhd", "or (crc16_t'range => outside);", "or (crc16_t'range => '0');"),
            Mutant("frame_transmitter.vhd", "if turn = 2 then", "if turn = 1 then"),
        ),
    ),
    Block(
        "frame_sequencer",
        "`framed/frame_sequencer`, a program of 256 different instructions",
        depth=14,
        induction=1,
        seen={
            "steps": "dut.step",
            "fetches": "dut.fetches",
            "fetched": "dut.fetched",
            "position": "dut.position",
        },
        not_proven="what the program does: that is the proof of `frame_application`",
        mutants=(
            Mutant(
                "frame_sequencer.vhd",
                "fetches <= fresh or resting or (step",
                "fetches <= fresh or (step",
            ),
            Mutant("frame_sequencer.vhd", "step    <= turn and is_last;", "step    <= turn;"),
            Mutant("frame_sequencer.vhd", "(holds or now_done(do_begin)));", "now_done(do_begin));"),
            Mutant(
                "frame_sequencer.vhd", "waits   <= fresh and ((is_last", "waits   <= fresh and ((not is_last"
            ),
            Mutant(
                "frame_sequencer.vhd",
                "fetched <= program(to_integer(position));",
                "fetched <= program(to_integer(position + 1));",
            ),
        ),
    ),
    Block(
        "frame_application",
        "`framed/frame_application` with its program, 8-bit address and data, dead-man, no lists and groups",
        depth=0,
        deep=6,
        induction=3,
        by_abc=True,
        guided={"reply_ready": 1, "may_begin": 1, "receive_overrun": 0},
        reach=56,
        without=(
            ("frame_application", "memory"),
            ("frame_application", "cache"),
            ("frame_application", "timer"),
        ),
        loose=("dut.pointer", "dut.epoch_now"),
        given={"dut.sequencer.fetched": "fetched", "dut.sequencer.now_done": "executed"},
        seen={
            "instruction": "dut.instruction",
            "finishes": "dut.finishes",
            "jump": "dut.holds",
            "begins": "dut.begins",
            "steps": "dut.sequencer.step",
            "fetches": "dut.sequencer.fetches",
            "first_clock": "dut.judges",
            "position": "dut.sequencer.position",
            "choice": "dut.choice",
            "caller": "dut.sequencer.caller",
            "marks": "dut.marks",
            "turns": "dut.sequencer.turns",
            "sees_missing": "dut.judge.sees_missing",
            "sees_not_new": "dut.judge.sees_not_new",
            "sees_failed": "dut.judge.sees_failed",
            "if_bytes": "dut.judge.if_bytes",
            "if_bits": "dut.judge.if_bits",
            "if_value": "dut.judge.if_value",
            "if_above_low": "dut.judge.if_above_low",
            "if_above_high": "dut.judge.if_above_high",
            "if_place": "dut.judge.if_place",
            "if_half": "dut.judge.if_half",
            "if_state": "dut.judge.if_state",
            "id": "dut.id",
            "word_index": "dut.word_index",
            "remember": "dut.remember",
            "found": "dut.data",
            "over": "dut.access_done",
            "failed": "dut.failed",
            "silent_bus": "dut.silent_bus",
            "denied_write": "dut.denied_write",
            "status_out": "dut.status_now",
            "word": "dut.word",
            "fresh": "dut.new_id",
            "repeated": "dut.repeated",
            "epoch_now": "dut.epoch_now",
        },
        not_proven="that a task ends; lists and groups; words of the memory, such as an epoch",
        mutants=(
            Mutant(
                "frame_program_pkg.vhd",
                "times(2) or act(do_read), if_not_new, not_new);",
                "times(2) or act(do_read));",
            ),
            # A request that was executed is forgotten. One case went well, the other failed.
            Mutant(
                "frame_program_pkg.vhd",
                "act(do_place) or number(reply_status_ok_c) or act(do_done));",
                "number(reply_status_ok_c) or act(do_done));",
            ),
            Mutant(
                "frame_program_pkg.vhd",
                "act(do_place) or number(status_of_data) or act(do_done));",
                "number(status_of_data) or act(do_done));",
            ),
            # A repeated request gets no answer.
            Mutant(
                "frame_program_pkg.vhd",
                "put(p, also(load_kept), if_duplicate, duplicate);",
                "put(p, also(load_kept));",
            ),
            # The epoch of a CLOSE ends while its answer is being sent.
            Mutant(
                "frame_program_pkg.vhd", "put(p, nothing_done, if_busy, close_wait);", "put(p, nothing_done);"
            ),
            # What is armed is not remembered.
            Mutant(
                "frame_state_pkg.vhd",
                "put(p, also(clear_flags, flag_tripped));\n        go_to(p, write_ok);",
                "put(p, also(clear_flags, flag_tripped));\n        go_to(p, denied);",
            ),
            # A HELLO makes the dead-man trip. A frame without a session makes `arm` work.
            Mutant(
                "frame_application.vhd", "trip => sets and number_now(0)", "trip => sets and number_now(4)"
            ),
            Mutant(
                "frame_application.vhd",
                "renew => clears and number_now(3)",
                "renew => clears and number_now(5)",
            ),
            # A denied WRITE is taken for one that the bus refused.
            Mutant(
                "frame_program_pkg.vhd",
                "put(p, nothing_done, if_denied, write_denied);",
                "put(p, nothing_done);",
            ),
            Mutant("frame_application.vhd", "request_done <= finishes and", "request_done <= does and"),
            Mutant(
                "frame_application.vhd",
                "does     <= not waits and (reply_ready or not says) and",
                "does     <= not waits and",
            ),
            Mutant(
                "frame_application.vhd",
                "reads     <= finishes and not holds and",
                "reads     <= finishes and",
            ),
        ),
    ),
    *SMALL_BLOCKS,
    *COMPONENT_BLOCKS,
    *SENSOR_BLOCKS,
    *LOOP_BLOCKS,
    *LINE_BLOCKS,
    *DEVICE_BLOCKS,
)
