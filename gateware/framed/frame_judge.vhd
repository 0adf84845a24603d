-- SPDX-License-Identifier: BSD-3-Clause
--
-- Judges the conditions of the framed application's instructions (frame_instruction_pkg).
--
-- Ports     judges: the condition of `instruction` is judged in this clock, which is its first one. The result counts
--           from the next clock on, until `steps`, which is its last clock. holds: the condition holds.
--           All others are what the conditions are about, by the names of frame_application.
-- Latency   One clock. The conditions that are seen in the same clock have none, after the first one.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_judge is
  generic (
    lists     : boolean;
    exchanges : boolean;
    deadman   : boolean
  );
  port (
    clock        : in  std_ulogic;
    judges       : in  std_ulogic;
    steps        : in  std_ulogic;
    instruction  : in  frame_instruction_t;
    request      : in  frame_request_t;
    reply_idle   : in  std_ulogic;
    data         : in  word32_t;
    word         : in  word32_t;
    pointer      : in  unsigned(9 downto 0);
    count        : in  unsigned(7 downto 0);
    flags        : in  byte_t;
    marks        : in  byte_t;
    shape        : in  byte_t;
    new_id       : in  std_ulogic;
    repeated     : in  std_ulogic;
    not_kept     : in  std_ulogic;
    unordered    : in  std_ulogic;
    failed       : in  std_ulogic;
    silent_bus   : in  std_ulogic;
    denied_write : in  std_ulogic;
    half         : in  std_ulogic;
    holds        : out std_ulogic
  );
end entity;

architecture rtl of frame_judge is

  -- What was judged: each is high if the instruction has such a condition, and that holds.
  signal if_bytes, if_bits, if_value, if_above_low, if_above_high, if_place, if_half, if_state : std_ulogic := '0';
  -- It has a condition of this sort, which is seen in the same clock.
  signal sees_missing, sees_not_new, sees_failed : std_ulogic := '0';

  signal distance : unsigned(15 downto 0);  -- from the lower half of `data` to that of the word, less 1

begin

  distance <= unsigned(word(15 downto 0)) + not unsigned(data(15 downto 0));

  -- What changes in this clock is not seen.
  judge : process (clock)
    variable condition : std_ulogic_vector(condition_f);
    variable number    : byte_t;
    variable known     : word32_t;
    variable left_not, low, above, pointed, known_place, state : std_ulogic;
  begin
    if rising_edge(clock) then
      condition := instruction(condition_f);
      number    := instruction(number_f);
      known     := to_stdulogicvector(to_bitvector(data));  -- also what an unknown slave gave

      left_not    := to_bit(request.left /= unsigned(number));
      low         := to_bit(known(7 downto 0) = number);
      above       := to_bit(unsigned(known(7 downto 0)) > unsigned(number));
      pointed     := to_bit(resize(pointer, 8) = unsigned(number));
      known_place := '0';
      for register_number in 0 to control_publish_c loop  -- fewer gates than comparisons
        if register_number <= control_spec_hash_low_c or
            (register_number >= control_frames_c and register_number <= control_deadman_trips_c) or
            register_number >= control_time_low_c then
          known_place := known_place or to_bit(pointer = register_number);
        end if;
      end loop;
      case to_integer(unsigned(condition)) is
        when if_chained      => state := request.chained;
        when if_barrier      => state := request.barrier;
        when if_some_left    => state := or count;
        when if_left_other   =>
          state := to_bit(resize(request.left, 9) /= unsigned(known(8 downto 0))) and to_bit(exchanges);
        when if_duplicate    => state := repeated;
        when if_not_kept     => state := not_kept;
        when if_order        => state := unordered;
        when if_top          => state := known(31) and to_bit(exchanges);
        when if_silent       => state := silent_bus;
        when if_denied       => state := denied_write and to_bit(deadman);
        when if_busy         => state := not reply_idle;
        when if_half_turn    => state := half;
        when if_over         => state := nor count;
        when others          => state := '0';
      end case;

      if judges = '1' or steps = '1' then
        if_bytes      <= '0';
        if_value      <= '0';
        if_place      <= '0';
        if_bits       <= '0';
        if_half       <= '0';
        if_above_low  <= '0';
        if_above_high <= '0';
        if_state      <= '0';
        sees_missing  <= '0';
        sees_not_new  <= '0';
        sees_failed   <= '0';
      end if;
      if judges = '1' and steps = '0' then
        if_state      <= condition(condition'left) and (state xor instruction(if_not));
        case to_integer(unsigned(condition)) is
          when if_missing     => sees_missing <= '1';
          when if_not_new     => sees_not_new <= '1';
          when if_failed | if_over => sees_failed <= '1';
          when if_left_not    => if_bytes <= left_not;
          when if_not_plain   => if_bytes <= left_not or request.chained or request.barrier;
          when if_low         => if_value <= low xor instruction(if_not);
          when if_above       =>
            if_above_low  <= above;
            if_above_high <= or known(31 downto 8);
          when if_pointer     => if_place <= pointed;
          when if_half_not    => if_half <= to_bit(data(15 downto 0) /= word(15 downto 0));  -- faster than the distance
          when if_half_lower  => if_half <= not distance(15);
          when if_no_register => if_place <= not known_place;
          when if_flag        => if_bits  <= or (flags and number);
          when if_mark        => if_bits  <= or (marks and number);
          when if_shape       => if_bits  <= or (shape and number) and to_bit(lists);
          when others         => null;
        end case;
      end if;
    end if;
  end process;

  holds <= (sees_missing and request.missing) or (sees_not_new and not new_id) or (sees_failed and failed) or
           if_bytes or if_bits or if_value or if_above_low or if_above_high or if_place or if_half or if_state;

end architecture;
