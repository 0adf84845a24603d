-- SPDX-License-Identifier: BSD-3-Clause
--
-- frame_timing_pkg: which instructions it lets wait, and which programs it refuses. With `fault` above 0 the program
-- has one fault, and elaboration must stop.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_timing_pkg.all;

entity frame_timing_tb is
  generic (
    fault : natural := 0
  );
end entity;

architecture bench of frame_timing_tb is

  function waits(first, second : frame_instruction_t; condition : natural) return boolean is
    variable p : assembler_t := assembler_empty;
  begin
    for pass in 1 to 2 loop
      next_pass(p);
      put(p, first);
      put(p, second, condition, answer);
      go_to(p, cleared);
      at(p, answer);
      put(p, nothing_done);
      at(p, cleared);
      put(p, nothing_done);
    end loop;
    wait_for_conditions(p);
    return p.code(1)(times_f) = times_wait;
  end function;

  -- A program with the fault, or without one.
  function faulty return boolean is
    variable p : assembler_t := assembler_empty;
  begin
    for pass in 1 to 2 loop
      next_pass(p);
      case fault is
        when 1 =>  -- it is judged before its first time, so it cannot wait
          put(p, take(take_first));
          put(p, say(say_byte, from_top) or times(4) or number(7), if_low, answer);
        when 2 =>  -- the word is still being stored
          put(p, store(store_data, word_mask));
          load(p, word_mask);
        when 3 =>  -- in the clock of the jump, the memory reads another word
          put(p, number(word_mask), if_flag, head);
          at(p, head);
          put(p, data(data_word));
        when 4 =>  -- its caller is not known yet
          call(p, tail_ok);
          at(p, tail_ok);
          put(p, act(do_return));
        when others =>
          put(p, nothing_done);
      end case;
      at(p, answer);
      put(p, nothing_done);
    end loop;
    wait_for_conditions(p);
    return true;
  end function;

  constant elaborated : boolean := faulty;

begin

  play : process
  begin
    check(elaborated, "the program without a fault");
    check(waits(take(take_first), number(3), if_low), "a taken byte is compared");
    check(waits(take(take_first), take(take_data) or number(3), if_low), "even by one that takes another");
    check(waits(act(do_point_up), number(3), if_pointer), "a pointer is compared");
    check(waits(also(set_marks, 1), number(1), if_mark), "a mark is looked at");
    check(waits(act(do_count), nothing_done, if_some_left), "a count is looked at");
    check(waits(act(do_rewind), number(3), if_left_not), "bytes left are counted");
    check(waits(say(say_end), nothing_done, if_busy), "the transmitter has just got something");
    check(waits(store(store_data, word_mask), number(word_mask), never), "a word is read that is still being stored");
    check(not waits(store(store_data, word_mask), number(word_one), never), "another word is read");
    check(not waits(take(take_skip), number(3), if_low), "a skipped byte is not compared");
    check(not waits(take(take_skip), nothing_done, if_missing), "this one is seen in the same clock");
    check(not waits(also(set_marks, 1), number(1), if_flag), "a flag is not a mark");
    report_passed("frame_timing_tb");
    wait;
  end process;

end architecture;
