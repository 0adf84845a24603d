-- SPDX-License-Identifier: BSD-3-Clause
--
-- Makes an assembled program wait where an instruction would come too early. Refuses a program in which it cannot.
--
-- A condition is judged in the clock before its instruction (frame_instruction_pkg). If the instruction before changes
-- what the condition reads, the one with the condition waits for a clock. Only an instruction that is executed once can
-- wait.
--
-- A word is stored a clock late (frame_memory). So the instruction after that must not read it.
--
-- A jump costs a clock, and in that clock the memory reads another word. So an instruction that uses a word at once
-- must not be the target of a jump.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;

package frame_timing_pkg is

  procedure wait_for_conditions(p : inout assembler_t);

end package;

package body frame_timing_pkg is

  function takes(i : frame_instruction_t) return boolean is
  begin
    return i(take_f) /= take_nothing;
  end function;

  function condition_of(i : frame_instruction_t) return natural is
  begin
    return to_integer(unsigned(i(condition_f)));
  end function;

  function once(i : frame_instruction_t) return boolean is
  begin
    return i(times_f) = nothing_done(times_f);
  end function;

  function changes_data(i : frame_instruction_t) return boolean is
  begin
    return i(data_f) /= data_stays or i(take_f) = take_data or i(take_f) = take_first or i(source_f) = from_top or
           i(source_f) = from_word;
  end function;

  function changes_pointer(i : frame_instruction_t) return boolean is
  begin
    return (i(do_point) or i(do_point_data) or i(do_point_up)) = '1';
  end function;

  -- The last time of `before` changes what the condition reads.
  function conflict(before : frame_instruction_t; condition : natural) return boolean is
    constant special : std_ulogic_vector(special_f) := before(special_f);
  begin
    case condition is
      when if_left_not | if_not_plain => return takes(before) or before(do_rewind) = '1';
      when if_left_other => return takes(before) or before(do_rewind) = '1' or changes_data(before);
      when if_low | if_above | if_half_not | if_half_lower | if_top => return changes_data(before);
      when if_pointer | if_no_register => return changes_pointer(before);
      when if_flag =>
        return special = set_flags or special = clear_flags or special = start_dead_man or
               before(manage_f) = manage_publish;
      when if_mark      => return special = set_marks or special = load_shape;
      when if_shape     => return special = load_shape;
      when if_some_left => return before(do_count) = '1' or special = load_count or special = load_kept;
      when if_busy      => return before(say_f) /= say_nothing;
      when if_half_turn => return special = half_turn;
      when others       => return false;
    end case;
  end function;

  function reads_what_is_stored(before, i : frame_instruction_t) return boolean is
  begin
    return before(store_f) /= store_nothing and (before(do_pointer) or i(do_pointer)) = '0' and
           before(number_f) = i(number_f) and i(store_f) /= store_data;
  end function;

  function uses_word_at_once(i : frame_instruction_t) return boolean is
  begin
    return i(source_f) = from_half or
           (once(i) and (i(data_f) = data_word or i(data_f) = data_add or i(data_f) = data_and or
                         i(data_f) = data_and_not or i(store_f) = store_count or i(store_f) = store_next or
                         i(special_f) = load_size or i(do_load_address) = '1' or
                         condition_of(i) = if_half_not or condition_of(i) = if_half_lower));
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

  procedure wait_for_conditions(p : inout assembler_t) is

    procedure follow(before : frame_instruction_t; place : natural) is
    begin
      if conflict(before, condition_of(p.code(place))) or reads_what_is_stored(before, p.code(place)) then
        assert once(p.code(place)) or p.code(place)(times_f) = times_wait
          report at_place(p, place) & "needs what the one before it changes; put another one between them"
          severity failure;
        p.code(place) := p.code(place) or for_size(times_wait);
      end if;
    end procedure;

    variable i         : frame_instruction_t;
    variable following : natural;
  begin
    for place in 0 to p.free - 1 loop
      i         := p.code(place);
      following := to_integer(unsigned(i(following_f)));
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
      if i(do_call) = '1' then
        assert p.code(following)(do_return) = '0'
          report at_place(p, place) & "calls a routine of one instruction; give it a second one" severity failure;
      end if;
      if condition_of(i) /= never then
        assert not uses_word_at_once(p.code(to_integer(unsigned(i(target_f)))))
          report at_place(p, to_integer(unsigned(i(target_f)))) & "uses a word at once after a jump; address it before"
          severity failure;
      end if;
    end loop;
  end procedure;

end package body;
