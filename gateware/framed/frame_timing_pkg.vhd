-- SPDX-License-Identifier: BSD-3-Clause
--
-- Refuses a program in which an instruction would come too early.
--
-- A condition is judged in the first clock of its instruction. A jump leads away in its last clock. So an instruction
-- with a condition needs two clocks. One with do_begin has them only if it is executed twice.
--
-- A word comes two clocks after its address. It is stored a clock late (frame_memory). So if an instruction stores a
-- word, the next one does not get that word in its first clock.
--
-- A jump costs a clock, and in that clock the memory reads another word. So an instruction that uses a word at once
-- must not be the target of a jump.
--
-- The next byte of a frame comes two clocks after a rewind or after many bytes were taken (frame_receiver).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;

package frame_timing_pkg is

  procedure check_timing(p : assembler_t);

end package;

package body frame_timing_pkg is

  function condition_of(i : frame_instruction_t) return natural is
  begin
    return to_integer(unsigned(i(condition_f)));
  end function;

  function once(i : frame_instruction_t) return boolean is
  begin
    return i(times_f) = nothing_done(times_f);
  end function;

  function uses_word(i : frame_instruction_t) return boolean is
  begin
    return i(data_f) = data_word or i(data_f) = data_add or i(data_f) = data_and or i(data_f) = data_and_not or
           i(special_f) = load_size or i(do_load_address) = '1';
  end function;

  function counts_word(i : frame_instruction_t) return boolean is
  begin
    return i(store_f) = store_count or i(store_f) = store_next;
  end function;

  -- It uses a word that the instruction before must have addressed.
  function uses_word_at_once(i : frame_instruction_t) return boolean is
  begin
    return (i(source_f) = from_half and unsigned(i(times_f)) < 2) or
           condition_of(i) = if_half_not or condition_of(i) = if_half_lower or
           (uses_word(i) and unsigned(i(times_f)) < 2);
  end function;

  -- It addresses the word that the instruction before stores, and not long enough to get it.
  function reads_what_is_stored(before, i : frame_instruction_t) return boolean is
    variable clocks : natural := 3;
  begin
    if counts_word(i) then
      clocks := 3;
    elsif uses_word(i) then
      clocks := 4;
    end if;
    return before(store_f) /= store_nothing and (before(do_pointer) or i(do_pointer)) = '0' and
           before(number_f) = i(number_f) and (i(store_f) /= store_data or uses_word(i)) and
           (to_integer(unsigned(i(times_f))) + 1 < clocks or i(source_f) = from_half);
  end function;

  -- It takes the next byte in its first clock, when that byte is not yet there.
  function takes_too_early(before, i : frame_instruction_t) return boolean is
  begin
    return before(take_f) = take_many and i(take_f) /= take_nothing and i(take_f) /= take_many and not once(i);
  end function;

  function at_place(p : assembler_t; place : natural) return string is
    variable near : label_t := label_t'left;
  begin
    for label_name in label_t loop
      if p.labels(label_name) <= place and p.labels(label_name) > p.labels(near) then
        near := label_name;
      end if;
    end loop;
    return "frame_timing_pkg: instruction " & integer'image(place) & ", after the label " & label_t'image(near) & ", ";
  end function;

  procedure check_timing(p : assembler_t) is

    procedure follow(before : frame_instruction_t; place : natural) is
    begin
      assert not reads_what_is_stored(before, p.code(place))
        report at_place(p, place) & "reads what the one before it stores; put another one between them"
        severity failure;
      assert not takes_too_early(before, p.code(place))
        report at_place(p, place) & "takes a byte at once after many were taken; put another one between them"
        severity failure;
    end procedure;

    variable i         : frame_instruction_t;
    variable following : natural;
  begin
    for place in 0 to p.free - 1 loop
      i         := p.code(place);
      following := to_integer(unsigned(i(following_f)));
      assert not (i(do_begin) = '1' and once(i) and condition_of(i) /= never)
        report at_place(p, place) & "jumps or ends the work in one clock; let it be executed twice" severity failure;
      assert not (i(do_rewind) = '1' and i(take_f) /= take_nothing)
        report at_place(p, place) & "rewinds and takes a byte; take it later" severity failure;
      if i(do_dispatch) = '1' then
        for operation in 0 to 15 loop
          follow(i, following + operation);
        end loop;
      elsif i(do_return) = '1' then
        for caller in 0 to p.free - 1 loop
          if p.code(caller)(do_call) = '1' then
            follow(i, to_integer(unsigned(p.code(caller)(target_f))));
          end if;
        end loop;
      elsif i(do_begin) = '0' then
        follow(i, following);
      end if;
      if condition_of(i) /= never then
        assert not uses_word_at_once(p.code(to_integer(unsigned(i(target_f)))))
          report at_place(p, to_integer(unsigned(i(target_f)))) & "uses a word at once after a jump; address it before"
          severity failure;
      end if;
    end loop;
  end procedure;

end package body;
