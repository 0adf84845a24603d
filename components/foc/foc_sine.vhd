-- SPDX-License-Identifier: BSD-3-Clause
--
-- Sine and cosine of an angle: a table of 256 values for a quarter of a turn, which a block memory holds. A value is
-- that of the middle of its 1/1024 turn, so the angle is at most 0.18 degrees wrong.
--
-- Latency   sine and cosine 3 or 4 clocks after the angle. They are right while the angle stands.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;

entity foc_sine is
  port (
    clock  : in  std_ulogic;
    angle  : in  unsigned(15 downto 0); -- a turn is 2**16
    sine   : out signed(15 downto 0);   -- 1 is 32767
    cosine : out signed(15 downto 0)
  );
end entity;

architecture rtl of foc_sine is

  type table_t is array (0 to 255) of unsigned(15 downto 0);

  function quarter return table_t is
    variable found : table_t;
  begin
    for place in found'range loop
      found(place) := to_unsigned(integer(round(32767.0 * sin((real(place) + 0.5) * math_pi / 512.0))), 16);
    end loop;
    return found;
  end function;

  constant sines : table_t := quarter;

  signal which       : std_ulogic := '0'; -- 1: the place of the cosine is looked up
  signal looks_up    : std_ulogic := '0'; -- which one has come from the table
  signal back        : std_ulogic := '0'; -- it is below 0
  signal looked_up   : unsigned(15 downto 0) := (others => '0');

  -- The same, a clock later: the block RAM is slow.
  signal is_cosine   : std_ulogic := '0';
  signal below       : std_ulogic := '0';
  signal value       : unsigned(15 downto 0) := (others => '0');

begin

  process (clock) is
    variable quadrant : unsigned(1 downto 0);
    variable place    : unsigned(7 downto 0);
    variable found    : signed(15 downto 0);
  begin
    if rising_edge(clock) then
      which     <= not which;
      looks_up  <= which;
      quadrant  := angle(15 downto 14) + ('0' & which);
      place     := angle(13 downto 6) xor (7 downto 0 => quadrant(0));
      looked_up <= sines(to_integer(place));
      back      <= quadrant(1);

      is_cosine <= looks_up;
      below     <= back;
      value     <= looked_up;

      found := signed(value);
      if below = '1' then
        found := -found;
      end if;
      if is_cosine = '1' then
        cosine <= found;
      else
        sine <= found;
      end if;
    end if;
  end process;

end architecture;
