-- SPDX-License-Identifier: BSD-3-Clause
--
-- The dead time of a half bridge: a number of ns, and the clocks that it takes as a code of a shift register.
--
-- The register counts with one cell for each bit, and a code loads it without another one. It starts at the code of a
-- number of clocks, and steps in every clock with next_code. It is at `code_last` in the last of these clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;

package dead_time_pkg is

  constant dead_bits : positive := 12;
  constant dead_most : positive := 2 ** dead_bits - 1; -- ns

  subtype dead_t is std_ulogic_vector(dead_bits - 1 downto 0);
  subtype code_t is std_ulogic_vector; -- of code_bits bits

  -- A table of codes has a place for each 8 ns, so that it fits one block RAM.
  constant dead_step_ns : positive := 8;
  subtype dead_place_t is natural range 0 to dead_most / dead_step_ns;

  function dead_place (dead : dead_t) return dead_place_t;

  -- A dead time, but at least `minimum_ns`.
  function at_least (dead : dead_t; minimum_ns : natural) return dead_t;

  -- The clocks of a place in the table: those of its longest time, and of at least `minimum_ns`. A clock counts as a
  -- whole number of ns, rounded down, so they are never too few.
  function dead_clocks (place : dead_place_t; minimum_ns : natural; clock_hz : positive) return positive;

  -- The codes. code_last is all ones.
  function code_bits (clock_hz : positive) return positive;
  function next_code (code : code_t) return code_t;
  function code_before (code : code_t) return code_t;

end package;

package body dead_time_pkg is

  function dead_place (dead : dead_t) return dead_place_t is
  begin
    return to_integer(unsigned(dead)) / dead_step_ns;
  end function;

  function at_least (dead : dead_t; minimum_ns : natural) return dead_t is
    constant minimum : dead_t := std_ulogic_vector(to_unsigned(minimum_ns, dead_bits));
    variable below   : std_ulogic := '0';
  begin
    -- Bit by bit: for `<` synthesis takes an adder, which is larger.
    for index in 0 to dead_bits - 1 loop
      if minimum(index) = '1' then
        below := below or not dead(index);
      else
        below := below and not dead(index);
      end if;
    end loop;
    if below = '1' then
      return minimum;
    end if;
    return dead;
  end function;

  function rounded_up_clocks (dead_ns : natural; clock_hz : positive) return positive is
    constant clock_ns : positive := 1_000_000_000 / clock_hz;
  begin
    return maximum(1, (dead_ns + clock_ns - 1) / clock_ns);
  end function;

  function dead_clocks (place : dead_place_t; minimum_ns : natural; clock_hz : positive) return positive is
  begin
    return rounded_up_clocks(maximum(minimum_ns, dead_step_ns * place + dead_step_ns - 1), clock_hz);
  end function;

  function code_bits (clock_hz : positive) return positive is
  begin
    return maximum(2, bits_for(rounded_up_clocks(dead_most, clock_hz) + 1));
  end function;

  -- The feedback with which a register of so many bits takes all values but 0.
  function feedback (bits : positive) return code_t is
    type feedbacks_t is array (2 to dead_bits) of natural;
    constant feedbacks : feedbacks_t := (
      2#11#, 2#110#, 2#1100#, 2#1_0100#, 2#11_0000#, 2#110_0000#, 2#1011_1000#, 2#1_0001_0000#, 2#10_0100_0000#,
      2#101_0000_0000#, 2#1110_0000_1000#);
  begin
    return std_ulogic_vector(to_unsigned(feedbacks(bits), bits));
  end function;

  function next_code (code : code_t) return code_t is
    constant now   : std_ulogic_vector(code'length - 1 downto 0) := code;
    constant mixed : std_ulogic_vector(code'length - 1 downto 0) := feedback(code'length);
  begin
    return ('0' & now(now'high downto 1)) xor (mixed and (now'range => now(0)));
  end function;

  function code_before (code : code_t) return code_t is
    constant now   : std_ulogic_vector(code'length - 1 downto 0) := code;
    constant mixed : std_ulogic_vector(code'length - 1 downto 0) := feedback(code'length);
    variable whole : std_ulogic_vector(code'length - 1 downto 0);
  begin
    whole := now xor (mixed and (now'range => now(now'high)));
    return whole(now'high - 1 downto 0) & now(now'high);
  end function;

end package body;
