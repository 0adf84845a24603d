-- SPDX-License-Identifier: BSD-3-Clause
--
-- The time of the framed application: clocks since reset, and ticks for the dead-man.
--
-- Ports     time_now: the lower half of the clock. half: its highest bit when `look` was last given; turned: it is another
--           one now, so that whoever keeps the upper half has 2**31 clocks to look. running: ticks are wanted; ticking: one has
--           come and has not been `seen`.
-- Latency   A tick every clock_hz / base_hz clocks since reset.
-- Errors    None. A tick that comes before the last one was seen joins it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

entity frame_clock is
  generic (
    clock_hz : positive := limits_clock_hz_default_c;
    base_hz  : positive := limits_base_hz_default_c;
    ticks    : boolean  := true  -- there are any
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    time_now : out unsigned(31 downto 0);
    half     : out std_ulogic;
    look     : in  std_ulogic;
    turned   : out std_ulogic;
    running  : in  std_ulogic;
    ticking  : out std_ulogic;
    seen     : in  std_ulogic
  );
end entity;

architecture rtl of frame_clock is

  constant period : positive := clock_hz / base_hz;

  signal clocks  : unsigned(31 downto 0) := (others => '0');
  signal divider : natural range 0 to period - 1 := 0;
  signal tick    : std_ulogic := '0';
  signal looked  : std_ulogic := '0';

begin

  time_now <= clocks;
  half     <= looked;
  turned   <= clocks(31) xor looked;
  ticking  <= tick;

  count : process (clock)
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if look = '1' then
        looked <= clocks(31);
      end if;
      if seen = '1' then
        tick <= '0';
      end if;
      if divider = period - 1 then
        divider <= 0;
        if ticks then
          tick <= running;
        end if;
      else
        divider <= divider + 1;
      end if;
      if reset = '1' then
        clocks  <= (others => '0');
        looked  <= '0';
        divider <= 0;
        tick    <= '0';
      end if;
    end if;
  end process;

end architecture;
