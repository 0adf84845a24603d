-- SPDX-License-Identifier: BSD-3-Clause
--
-- frame_judge: each condition holds in one state and does not hold in another one, and only its instruction jumps.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_judge_tb is
end entity;

architecture bench of frame_judge_tb is

  signal clock : std_ulogic := '0';
  signal ended : boolean := false;

  signal judges, steps, reply_idle, new_id, repeated, not_kept, unordered, failed, silent_bus, denied_write, half,
         holds : std_ulogic := '0';
  signal instruction : frame_instruction_t := nothing_done;
  signal request : frame_request_t := (entry => "00000", length => x"00", left => x"00", data => x"00", others => '0');
  signal data, word : word32_t := x"00000000";
  signal pointer : unsigned(9 downto 0) := (others => '0');
  signal count   : unsigned(7 downto 0) := x"00";
  signal flags, marks, shape : byte_t := x"00";

begin

  clock <= not clock after 5 ns when not ended;

  judge : entity work.frame_judge
    generic map (lists => true, exchanges => true, deadman => true)
    port map (
      clock => clock, judges => judges, steps => steps, instruction => instruction, request => request,
      reply_idle => reply_idle, data => data, word => word, pointer => pointer, count => count,
      flags => flags, marks => marks, shape => shape, new_id => new_id, repeated => repeated, not_kept => not_kept,
      unordered => unordered, failed => failed, silent_bus => silent_bus, denied_write => denied_write, half => half,
      holds => holds);

  play : process

    -- The condition of the instruction is judged in its first clock, and counts from the next clock to its last one.
    procedure expects (condition, number_there : natural; value : std_ulogic; what : string;
                       inverted : std_ulogic := '0') is
      variable i : frame_instruction_t := number(number_there);
    begin
      i(condition_f) := std_ulogic_vector(to_unsigned(condition, 5));
      i(if_not)      := inverted;
      instruction <= i;
      judges      <= '1';
      wait for 1 ns;
      check_equal(holds, '0', what & ": nothing is judged yet");
      tick(clock);
      judges      <= '0';
      wait for 1 ns;
      check_equal(holds, value, what);
      tick(clock);
      check_equal(holds, value, what & ", also later");
      pulse(clock, steps);
      wait for 1 ns;
      check_equal(holds, '0', what & ": it is over");
    end procedure;

    procedure expects_state (condition : natural; signal state : out std_ulogic; what : string;
                             high : std_ulogic := '1') is
    begin
      state <= high;
      expects(condition, 0, '1', what);
      state <= not high;
      expects(condition, 0, '0', "not " & what);
      state <= '0';
    end procedure;
  begin
    tick(clock);
    expects(never, 0, '0', "no condition");
    expects_state(if_chained, request.chained, "chained");
    expects_state(if_barrier, request.barrier, "barrier");
    expects_state(if_not_plain, request.chained, "plain, but chained");
    expects_state(if_not_plain, request.barrier, "plain, but with a barrier");
    expects_state(if_missing, request.missing, "missing");
    expects_state(if_not_new, new_id, "not new", high => '0');
    expects_state(if_failed, failed, "failed");
    expects_state(if_duplicate, repeated, "a duplicate");
    expects_state(if_not_kept, not_kept, "not kept");
    expects_state(if_order, unordered, "out of order");
    expects_state(if_silent, silent_bus, "silent");
    expects_state(if_denied, denied_write, "denied");
    expects_state(if_busy, reply_idle, "busy", high => '0');
    expects_state(if_half_turn, half, "half a turn");

    request.left <= x"07";
    data         <= x"00000107";
    expects(if_left_not, 7, '0', "seven bytes are left");
    expects(if_left_not, 8, '1', "not eight");
    expects(if_not_plain, 7, '0', "plain");
    expects(if_not_plain, 6, '1', "not plain with six");
    expects(if_left_other, 0, '1', "nine bits count");
    data <= x"FFFF8007";
    expects(if_left_other, 0, '0', "as many as in data");
    expects(if_top, 0, '1', "the highest bit");
    expects(if_low, 7, '1', "the lowest byte");
    expects(if_low, 7, '0', "the lowest byte, inverted", inverted => '1');
    expects(if_low, 8, '0', "another byte");
    data <= x"00000007";
    expects(if_top, 0, '0', "no highest bit");
    expects(if_above, 6, '1', "above");
    expects(if_above, 7, '0', "not above");
    data <= x"00000100";
    expects(if_above, 16#FF#, '1', "above any byte");

    count <= x"01";
    expects(if_some_left, 0, '1', "some are left");
    expects(if_some_left, 0, '0', "some are left, inverted", inverted => '1');
    count <= x"00";
    expects(if_some_left, 0, '0', "none is left");
    expects(if_over, 0, '1', "none is left, so it is over");
    count <= x"01";
    expects_state(if_over, failed, "it failed, so it is over");

    word <= x"12340100";
    expects(if_half_not, 0, '0', "equal halves");
    expects(if_half_lower, 0, '0', "an equal number is not lower");
    data <= x"000000FF";
    expects(if_half_not, 0, '1', "other halves");
    expects(if_half_lower, 0, '1', "lower");
    data <= x"00000101";
    expects(if_half_lower, 0, '0', "higher");
    data <= x"00008100";
    expects(if_half_lower, 0, '1', "half way around");
    data <= x"000080FF";
    expects(if_half_lower, 0, '0', "less than half way around");

    flags <= x"04";
    expects(if_flag, 6, '1', "a flag");
    expects(if_flag, 3, '0', "no such flag");
    marks <= x"10";
    expects(if_mark, 16, '1', "a mark");
    expects(if_mark, 4, '0', "a flag is no mark");
    shape <= x"80";
    expects(if_shape, 128, '1', "a shape");
    expects(if_shape, 16, '0', "a mark is no shape");

    for place in 0 to 255 loop
      pointer <= to_unsigned(place, 10);
      if place <= control_spec_hash_low_c or (place >= control_frames_c and place <= control_deadman_trips_c) or
          (place >= control_time_low_c and place <= control_publish_c) then
        expects(if_no_register, 0, '0', "register " & integer'image(place));
      else
        expects(if_no_register, 0, '1', "no register " & integer'image(place));
      end if;
    end loop;
    expects(if_pointer, 255, '1', "the pointer");
    expects(if_pointer, 254, '0', "another pointer");

    report_passed("frame_judge_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "frame_judge_tb");

end architecture;
