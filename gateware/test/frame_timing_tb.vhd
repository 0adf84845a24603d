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

  -- A program with the fault, or without one.
  function faulty return boolean is
    variable p : assembler_t := assembler_empty;
  begin
    for pass in 1 to 2 loop
      next_pass(p);
      case fault is
        when 1 =>  -- in its only clock, the condition is not judged yet
          put(p, number(7), if_low, answer);
          go_to(p, next_work);
        when 2 =>  -- the word is still being stored
          put(p, store(store_data, word_mask));
          load(p, word_mask);
        when 3 =>  -- in the clock of the jump, the memory reads another word
          put(p, number(word_mask), if_flag, head);
          at(p, head);
          put(p, data(data_word));
        when 4 =>  -- the byte behind the many is not there yet
          put(p, take(take_many));
          put(p, take(take_first) or times(2));
        when 5 =>  -- nor is the first byte again
          put(p, take(take_first) or act(do_rewind));
        when 6 =>  -- the word is still being stored when it is addressed
          put(p, store(store_next, word_mask) or times(2));
          put(p, number(word_mask));
          say_half(p, say_byte, word_mask);
        when others =>  -- the same, with enough clocks
          put(p, number(7) or times(2), if_low, answer);
          go_to(p, next_work);
          put(p, store(store_data, word_mask));
          put(p, data(data_word) or number(word_mask) or times(4));
          put(p, store(store_next, word_mask) or times(2));
          put(p, number(word_mask) or times(3));
          say_half(p, say_byte, word_mask);
          put(p, take(take_many) or times(2));
          put(p, take(take_first));
          put(p, number(word_mask), if_flag, head);
          at(p, head);
          put(p, data(data_word) or number(word_mask) or times(3));
      end case;
      at(p, answer);
      put(p, nothing_done);
    end loop;
    check_timing(p);
    return true;
  end function;

  constant elaborated : boolean := faulty;

begin

  play : process
  begin
    check(elaborated, "the program without a fault");
    report_passed("frame_timing_tb");
    wait;
  end process;

end architecture;
