# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the fast engine of the framed protocol."""

from __future__ import annotations

from typing import Any

from block import Block, Mutant

# Signals of the transmitter that its property file sees.
_TRANSMITTER = (
    "bank", "whole", "complete", "puts", "ends", "drops", "writes", "kind_waits", "full", "read_bank",
    "position", "zero", "write_index", "read_index", "read_next", "unsent", "written", "encoded", "crc",
    "turn", "state",
)  # fmt: skip

# Signals of the receiver that the property file of its ring sees.
_RING = (
    "present", "delay", "whole", "too_long", "fits", "stores", "stored", "frame_index", "write_index",
    "free_bytes", "start_index", "next_index", "read_index", "read_now", "full", "reads", "fills", "refills",
    "record_in", "at_code",
)  # fmt: skip

# Signals of the application that its property file sees.
_APPLICATION = {
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
    "shape": "dut.shape",
    "count": "dut.count",
    "address": "dut.address",
}

_APPLICATION_WITHOUT = (
    ("frame_application", "memory"),
    ("frame_application", "cache"),
    ("frame_application", "timer"),
)

# What both rows of the framed application have in common.
_COMPOSED: dict[str, Any] = {
    "depth": 0,
    "deep": 6,
    "induction": 3,
    "by_abc": True,
    "reach": 56,
    "without": _APPLICATION_WITHOUT,
    "loose": ("dut.pointer", "dut.epoch_now"),
    "given": {"dut.sequencer.fetched": "fetched", "dut.sequencer.now_done": "executed"},
    "seen": _APPLICATION,
}

FRAMED_BLOCKS = (
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
        "`framed/frame_receiver`, requests of up to 2 bytes, a ring of 32, and any one frame",
        depth=4,
        deep=13,
        induction=1,
        given={"dut.records.read_data": "record_read"},
        seen={
            "present": "dut.present",
            "at_code": "dut.at_code",
            "planned": "dut.planned",
            "delay": "dut.delay",
            "kind_kept": "dut.kind",
            "outside_kept": "dut.outside",
            "in_cobs": "dut.in_cobs",
            "coded_kept": "dut.coded",
            "whole": "dut.whole",
            "beyond": "dut.beyond",
            "too_long": "dut.too_long",
            "closed_before": "dut.closed",
            "crc_kept": "dut.crc",
            "run_kept": "dut.run",
            "length_kept": "dut.length",
            "record_in": "dut.record_in",
            "write_index": "dut.records.write_index",
            "read_index": "dut.records.read_index",
            "is_full": "dut.records.full",
            "loads": "dut.records.load",
        },
        not_proven="the bytes of the payload, and room in the ring: see frame_receiver_bytes",
        mutants=(
            Mutant("frame_receiver.vhd", "to_bit(delay(1) /= check_byte(crc, 1)) or ", ""),
            Mutant("frame_receiver.vhd", "not coded or not at_code or", "not coded or"),
            Mutant(
                "frame_receiver.vhd",
                "shut   <= not outside and and epoch(15 downto 8);",
                "shut   <= '0';",
            ),
            Mutant("frame_receiver.vhd", "at_code <= to_bit(rest = 1);", "at_code <= to_bit(run = 1);"),
            Mutant("frame_receiver.vhd", "(7 downto 0 => kept)", "(7 downto 0 => '1')"),
            Mutant("frame_receiver.vhd", "if length = request_max then", "if length = 255 then"),
            Mutant("frame_receiver.vhd", "keeps and not wrong and not entry(4);", "keeps and not entry(4);"),
            Mutant("frame_receiver.vhd", "whole <= and delay(2);", "whole <= '0';"),
        ),
    ),
    Block(
        "frame_receiver_bytes",
        "The ring of `framed/frame_receiver`, 16 bytes, requests of up to 4, any one byte of any frame",
        depth=4,
        deep=16,
        reach=20,
        induction=1,
        given={"dut.records.read_data": "record_read", "dut.looked": "looked"},
        loose=("dut.crc",),
        seen={
            "in_cobs": "dut.in_cobs",
            "coded_kept": "dut.coded",
            "ended": "dut.closed",
            "run_kept": "dut.run",
            "length_kept": "dut.length",
            "record_write": "dut.records.write_index",
            "record_next": "dut.records.read_index",
            "is_full": "dut.records.full",
            "loads": "dut.records.load",
        }
        | {name: f"dut.{name}" for name in _RING},
        not_proven="the memory of the ring itself; other sizes of it; `many => false`: the benches test them",
        mutants=(
            # A wrong place: the ring is written a byte too far, or is read from the wrong one.
            Mutant(
                "frame_receiver.vhd",
                "write_index <= frame_index + resize(length, index_bits);",
                "write_index <= frame_index + resize(length, index_bits) + 1;",
            ),
            Mutant(
                "frame_receiver.vhd",
                "read_now <= start_index when rewind = '1' else read_index;",
                "read_now <= read_index;",
            ),
            Mutant(
                "frame_receiver.vhd",
                "index_then := next_index + resize(more, index_bits) + 1;",
                "index_then := next_index + resize(more, index_bits);",
            ),
            # A stale byte.
            Mutant("frame_receiver.vhd", "if fills = '1' or take = '1' then", "if take = '1' then"),
            # The frame that comes overtakes the first one at the wrap, because its bytes are not counted.
            Mutant("frame_receiver.vhd", "start_index - write_index - 1;", "start_index - frame_index - 1;"),
            # A dropped frame keeps its bytes, and the next one is not where it is looked for.
            Mutant("frame_receiver.vhd", "fits   <= judged and kept;", "fits   <= judged;"),
            # A zero comes out as its code.
            Mutant(
                "frame_receiver.vhd",
                "stored  <= delay(2) when at_code = '0' else (others => '0');",
                "stored  <= delay(2);",
            ),
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
        "`framed/frame_transmitter`, and any one place of its payloads",
        depth=2,
        deep=16,
        induction=1,
        given={"dut.looked": "looked"},
        seen={"pending": "dut.data", "kind_kept": "dut.kind"}
        | {name: f"dut.{name}" for name in _TRANSMITTER},
        not_proven="that the program puts at most 254 bytes, and that a frame ends if tx_ready comes: the "
        "benches test them",
        mutants=(
            Mutant(
                "frame_transmitter.vhd",
                "codes  <= ends or nor data;",
                "codes  <= ends;",
            ),
            Mutant("frame_transmitter.vhd", "or (crc16_t'range => outside);", "or (crc16_t'range => '0');"),
            Mutant("frame_transmitter.vhd", "if turn = 2 then", "if turn = 1 then"),
            Mutant("frame_transmitter.vhd", "byte_t(position - zero);", "byte_t(position - zero + 1);"),
            Mutant("frame_transmitter.vhd", "bank <= not bank;", "null;"),
            Mutant("frame_transmitter.vhd", "if unsent = 1 then", "if unsent <= 2 then"),
            Mutant(
                "frame_transmitter.vhd", "tx_publish <= kind(4) and not outside;", "tx_publish <= kind(4);"
            ),
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
        guided={"reply_ready": 1, "may_begin": 1, "receive_overrun": 0},
        **_COMPOSED,
        not_proven="that a task ends; LIST and POST_LIST, which have a row of their own "
        "(frame_application_lists); EXCHANGE and publishing: each access once and in order, no write for a "
        "repeat, which words an EXCHANGE has, and that the dead-man denies them; words of the memory, such "
        "as an epoch: tests compare with the reference",
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
    Block(
        "frame_application_lists",
        "`framed/frame_application` with its program, 8-bit address and data, dead-man, and lists",
        guided={
            "reset": "!begun",
            "reply_ready": 1,
            "reply_idle": 1,
            "may_begin": 1,
            "receive_overrun": 0,
            "chained_in": 0,
            "barrier_in": 0,
            "response_data": 0,
            "dead_man_running": 0,
            "dead_man_tripped_now": 0,
            "dead_man_uncounted": 0,
        },
        generics={"lists": True},
        **_COMPOSED,
        not_proven="that a task ends; the value that is written to a word which a mask or a sum changes; "
        "which words a reply has; wider addresses and data; EXCHANGE and publishing; words of the memory, "
        "such as an epoch: tests compare with the reference",
        mutants=(
            # A word more is written than the operation has.
            Mutant(
                "frame_list_pkg.vhd",
                "take(take_data) or times(s.data_bytes) or act(do_write) or counted);",
                "take(take_data) or times(s.data_bytes) or act(do_write));",
            ),
            # Reads are left out.
            Mutant(
                "frame_list_pkg.vhd",
                "put(p, also(address_up, word_done) or act(if_not), if_some_left, run_last);",
                "put(p, also(address_up, word_done), if_some_left, run_last);",
            ),
            # A list with a barrier is answered behind its first operation.
            Mutant(
                "frame_list_pkg.vhd",
                "put(p, nothing_done, if_missing, list_passed);",
                "put(p, nothing_done, if_barrier, list_passed);",
            ),
            # A list that was executed is forgotten.
            Mutant(
                "frame_program_pkg.vhd",
                "put(p, say(say_last) or number(device_kind_reply_c) or act(do_place) or act(do_done));",
                "put(p, say(say_last) or number(device_kind_reply_c) or act(do_done));",
            ),
            # A repeated list writes again.
            Mutant(
                "frame_list_pkg.vhd",
                "put(p, number(mark_repeated), if_mark, run_again);",
                "put(p, number(mark_fifo), if_mark, run_again);",
            ),
        ),
    ),
)
