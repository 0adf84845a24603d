-- SPDX-License-Identifier: BSD-3-Clause
--
-- The rates, words and times of stepgen.
--
-- All rates are powers of two, so that no value needs a division. A velocity is in 1/256 step/s. A phase is the
-- fraction of a step with 8 + base_bits bits. Each base period adds the velocity to the phase. There are 2**base_bits
-- base periods a second. The ramp computes new velocities in each of 2**ramp_bits ramp periods a second.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package stepgen_pkg is

  constant fraction_bits : positive := 8;  -- of a velocity
  constant speed_bits    : positive := 28; -- of its magnitude
  constant ramp_bits     : positive := 14;

  -- Words of an axis on the bus. The motion unit keeps position and latches, the others are parameters.
  subtype word_index_t is natural range 0 to 15;
  constant word_control         : word_index_t := 0;
  constant word_target          : word_index_t := 1;
  constant word_speed           : word_index_t := 2;
  constant word_acceleration    : word_index_t := 3;
  constant word_velocity_target : word_index_t := 4;
  constant word_position        : word_index_t := 5;
  constant word_velocity        : word_index_t := 6;
  constant word_status          : word_index_t := 7;
  constant word_latched         : word_index_t := 8;
  constant word_stamp           : word_index_t := 9;
  constant word_shift           : word_index_t := 10;

  -- Bits of the control word.
  constant control_enable        : natural := 0;
  constant control_velocity_mode : natural := 1;
  constant control_stop_at_limit : natural := 2;
  subtype control_source is natural range 4 downto 3; -- of the latch: none, low limit, high limit, home

  -- Bits of the status word.
  constant status_moving    : natural := 0;
  constant status_at_target : natural := 1;
  constant status_low       : natural := 2;
  constant status_high      : natural := 3;
  constant status_home      : natural := 4;
  constant status_halted    : natural := 5;
  constant status_latched   : natural := 6;
  constant status_late      : natural := 7;

  -- Bits of an acceleration, in 64 step/s**2. A ramp period changes a velocity by as many 1/256 step/s.
  constant acceleration_bits : positive := 20;

  -- Words of an axis for the ramp alone. The velocity has two places: one is in use, the ramp writes the other one.
  constant word_next     : word_index_t := 7;
  constant word_goal     : word_index_t := 12;
  constant word_reserve  : word_index_t := 13;
  constant word_zero     : word_index_t := 15;

  -- Words of an axis in the motion unit.
  subtype motion_word_t is unsigned(2 downto 0);
  constant motion_position : motion_word_t := "000";
  constant motion_phase    : motion_word_t := "001";
  constant motion_latched  : motion_word_t := "010";
  constant motion_stamp    : motion_word_t := "011";
  constant motion_now      : motion_word_t := "100"; -- of axis 0: the clock

  -- Bits that number the axes, at least two: the constants of the motion unit need them.
  function axis_bits (axes : positive) return positive;

  -- Clocks of a base period that its work needs.
  function work_clocks (axes : positive) return positive;

  -- The base rate is the largest that leaves the clocks for the work. At most 2**22 Hz: in a word of 32 bits, a phase
  -- needs a bit above it for the carry, and one for the borrow.
  function base_bits (axes : positive; clock_hz : positive) return positive;

  -- Clocks that last at least `time_ns`, and at least one. Any time up to 100 us.
  function clocks_of (time_ns : natural; clock_hz : positive) return positive;

end package;

package body stepgen_pkg is

  function axis_bits (axes : positive) return positive is
  begin
    for bits in 2 to 5 loop
      if 2 ** bits >= axes then
        return bits;
      end if;
    end loop;
    return 6;
  end function;

  function work_clocks (axes : positive) return positive is
  begin
    return 3 + maximum(axes, 3) + axes;
  end function;

  function base_bits (axes : positive; clock_hz : positive) return positive is
  begin
    for bits in 22 downto 20 loop
      if clock_hz / 2 ** bits >= work_clocks(axes) then
        return bits;
      end if;
    end loop;
    report "stepgen: a clock of " & integer'image(clock_hz) & " Hz is too slow for " & integer'image(axes) & " axes"
      severity failure;
    return 20;
  end function;

  function clocks_of (time_ns : natural; clock_hz : positive) return positive is
    constant clock_khz : positive := (clock_hz + 999) / 1000; -- in Hz the products would not fit an integer
    constant thousands : natural  := (time_ns / 1000) * clock_khz;
  begin
    assert time_ns <= 100_000
      report "stepgen: a time of " & integer'image(time_ns) & " ns is above 100 us"
      severity failure;
    return maximum(1, thousands / 1000 +
                      ((thousands mod 1000) * 1000 + (time_ns mod 1000) * clock_khz + 999_999) / 1_000_000);
  end function;

end package body;
