-- SPDX-License-Identifier: BSD-3-Clause
--
-- Assembles the program of the framed application: its instructions in order, and their jump targets.
--
-- The program starts at position 0. The code for an entry of frame_pkg is at 32 + entry. At 64 plus the operation of a
-- kind is the check of its form, and at 80 plus the operation is its execution. All other code uses the free positions.
-- The program is written in three passes. The first shows which positions the tables use, and the second shows the
-- positions of the labels.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;

package frame_assembler_pkg is

  constant first_of_entries : natural := 32;
  constant first_of_forms   : natural := 64;
  constant first_of_checks  : natural := 80;

  type frame_program_t is array (natural range <>) of frame_instruction_t;

  type label_t is (
    -- shared
    next_work, head, counted, answer, tail_ok, end_ok, end_plain, end_counted, end_failed, finish_ok,
    write_ok, write_failed, write_denied,
    invalid, invalid_too, bad_address, denied, denied_too, too_long, order,
    behind, no_group, failed, count_failure, load_failure, count_denial, drop_kind, drop_stale, drop_done,
    tell_closed, clear_next,
    cleared,
    -- sessions
    hello_none, hello_more, hello_next, open_new, open_offered, open_begin, open_answer,
    close_wait, session_begins, begin_next, begin_rest,
    forget_next, forgotten,
    -- requests
    general, general_taken, form_dispatch, form_end, take_barrier, places, past_order, skip_check, check_dispatch,
    skip_barrier, check_order, check_barrier, not_new, duplicate, duplicate_next, repeat, exec_read, exec_write,
    -- control registers, time, dead-man
    registers_next, registers_free, registers_word, registers_time, registers_turn, registers_high, registers_said,
    registers_kept, registers_say, turn_down, write_arm,
    write_publish, write_ticks,
    -- posts
    post_other, post_old, post_denied, post_stopped, post_failed, post_note, post_noted, post_formed, post_end,
    -- lists
    list_start, list_op, list_pass, list_values, list_more, list_passed, list_masks, list_once, list_reads, list_plain,
    list_free,
    list_tripped, list_has_fifo, list_ok, list_say, list_execute, run, run_go, run_words, run_write, run_over,
    run_reads, run_read, run_last, run_change, run_mask, run_value, run_operand, run_add, run_once, run_again,
    list_executed, list_failed, list_done,
    -- exchange groups
    define_member, define_second, define_entries,
    exchange_defined, exchange_tripped, exchange_free, exchange_go, exchange_out, exchange_outputs, exchange_in,
    exchange_inputs,
    -- publish groups
    group_words, group_go, group_store, group_filled, group_end, publish_word, publish_end, publish_failed);

  type labels_t is array (label_t) of natural;

  type positions_t is array (natural range <>) of boolean;

  type assembler_t is record
    code   : frame_program_t(0 to 511);
    taken  : positions_t(0 to 511);  -- used by the tables
    labels : labels_t;
    free   : natural;  -- the first free position
    here   : natural;  -- position of the next instruction
    last   : natural;  -- position of the last instruction
  end record;

  constant assembler_empty : assembler_t := (
    code => (others => nothing_done), taken => (others => false), labels => (others => 0), free => 0,
    here => 0, last => 0);

  -- Starts another pass. The labels and the positions of the tables are kept.
  procedure next_pass(p : inout assembler_t);

  procedure put(p : inout assembler_t; i : frame_instruction_t;
                condition : natural := never; target : label_t := next_work);

  -- Places the next instruction at the label.
  procedure at(p : inout assembler_t; label_name : label_t);
  procedure at_entry(p : inout assembler_t; entry : natural);
  procedure at_form(p : inout assembler_t; kind : natural);
  procedure at_check(p : inout assembler_t; kind : natural);

  -- Lets the last instruction continue at the label. After `next_work`, which is no place, it begins the next work.
  procedure go_to(p : inout assembler_t; label_name : label_t);

  -- Sets `pointer` to a place in the memory.
  procedure point(p : inout assembler_t; place : natural; i : frame_instruction_t := nothing_done);

  -- The same, by the last instruction.
  procedure also_point(p : inout assembler_t; place : natural);

  -- An instruction that loads a word of the memory into `data`.
  function loaded(place : natural) return frame_instruction_t;

  -- Increments a counter of the control registers.
  procedure bump(p : inout assembler_t; counter : natural; i : frame_instruction_t := nothing_done);

  -- Loads a word of the memory into `data`.
  procedure load(p : inout assembler_t; place : natural; i : frame_instruction_t := nothing_done);

  -- Takes so many bytes into `data`, and sets its other bytes to zero.
  procedure take_bytes(p : inout assembler_t; bytes : positive;
                       condition : natural := never; target : label_t := next_work);

  -- Calls the routine at the label, then goes to the next instruction.
  procedure call(p : inout assembler_t; label_name : label_t; i : frame_instruction_t := nothing_done);

  -- Sends the lower half of a word that the instruction before has addressed.
  procedure say_half(p : inout assembler_t; what : std_ulogic_vector(2 downto 0); place : natural);

  -- Addresses a word, and sends its lower half.
  procedure find_half(p : inout assembler_t; what : std_ulogic_vector(2 downto 0); place : natural);

  -- Sends id and count of posts, with which every reply begins.
  procedure say_head(p : inout assembler_t);

end package;

package body frame_assembler_pkg is

  procedure next_pass(p : inout assembler_t) is
  begin
    p.free := 0;
    p.here := 0;
  end procedure;

  procedure put(p : inout assembler_t; i : frame_instruction_t;
                condition : natural := never; target : label_t := next_work) is
  begin
    if p.here = p.free then
      loop
        p.free := p.free + 1;
        assert p.free < 512
          report "frame_assembler_pkg: the program has more than 511 instructions" severity failure;
        exit when not p.taken(p.free);
      end loop;
    end if;
    p.code(p.here) := i;
    p.code(p.here)(condition_f) := std_ulogic_vector(to_unsigned(condition, 5));
    if condition /= never then
      p.code(p.here)(target_f) := std_ulogic_vector(to_unsigned(p.labels(target), 9));
    end if;
    p.code(p.here)(following_f) := std_ulogic_vector(to_unsigned(p.free, 9));
    p.last := p.here;
    p.here := p.free;
  end procedure;

  procedure at(p : inout assembler_t; label_name : label_t) is
  begin
    p.here               := p.free;
    p.labels(label_name) := p.here;
  end procedure;

  procedure at_entry(p : inout assembler_t; entry : natural) is
  begin
    p.here := first_of_entries + entry;
    p.taken(p.here) := true;
  end procedure;

  procedure at_form(p : inout assembler_t; kind : natural) is
  begin
    p.here := first_of_forms + kind mod 16;
    p.taken(p.here) := true;
  end procedure;

  procedure at_check(p : inout assembler_t; kind : natural) is
  begin
    p.here := first_of_checks + kind mod 16;
    p.taken(p.here) := true;
  end procedure;

  procedure go_to(p : inout assembler_t; label_name : label_t) is
  begin
    if label_name = next_work then
      p.code(p.last)(do_begin) := '1';
    elsif p.code(p.last)(do_call) = '1' then  -- behind the routine
      p.code(p.last)(target_f) := std_ulogic_vector(to_unsigned(p.labels(label_name), 9));
    else
      p.code(p.last)(following_f) := std_ulogic_vector(to_unsigned(p.labels(label_name), 9));
    end if;
  end procedure;

  procedure point(p : inout assembler_t; place : natural; i : frame_instruction_t := nothing_done) is
  begin
    put(p, i);
    also_point(p, place);
  end procedure;

  procedure also_point(p : inout assembler_t; place : natural) is
  begin
    p.code(p.last)(do_point) := '1';
    p.code(p.last)(target_f) := std_ulogic_vector(to_unsigned(place mod 512, 9));
    p.code(p.last)(far_f)    := std_ulogic_vector(to_unsigned(place / 512, 1));
  end procedure;

  procedure bump(p : inout assembler_t; counter : natural; i : frame_instruction_t := nothing_done) is
  begin
    put(p, store(store_count, counter) or times(2) or i);
  end procedure;

  function loaded(place : natural) return frame_instruction_t is
  begin
    return data(data_word) or number(place) or times(3);
  end function;

  procedure load(p : inout assembler_t; place : natural; i : frame_instruction_t := nothing_done) is
  begin
    put(p, loaded(place) or i);
  end procedure;

  procedure take_bytes(p : inout assembler_t; bytes : positive;
                       condition : natural := never; target : label_t := next_work) is
  begin
    put(p, take(take_first) or times(bytes), condition, target);
  end procedure;

  procedure call(p : inout assembler_t; label_name : label_t; i : frame_instruction_t := nothing_done) is
  begin
    put(p, i or act(do_call));
    p.code(p.last)(target_f)    := std_ulogic_vector(to_unsigned(p.here, 9));
    p.code(p.last)(following_f) := std_ulogic_vector(to_unsigned(p.labels(label_name), 9));
  end procedure;

  procedure say_half(p : inout assembler_t; what : std_ulogic_vector(2 downto 0); place : natural) is
  begin
    put(p, say(what, from_half) or times(2) or number(place));
  end procedure;

  procedure find_half(p : inout assembler_t; what : std_ulogic_vector(2 downto 0); place : natural) is
  begin
    put(p, say(what, from_half) or times(4) or number(place));
  end procedure;

  procedure say_head(p : inout assembler_t) is
  begin
    put(p, say(say_byte, from_id) or times(2) or number(word_posts));
    say_half(p, say_byte, word_posts);
  end procedure;

end package body;
