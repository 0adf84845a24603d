-- SPDX-License-Identifier: BSD-3-Clause
--
-- The time of the framed application: a count of clocks since reset.
--
-- Ports     time_now: the lower half of the clock. half: its highest bit at the last `look`. turned: the highest bit
--           differs from `half`. Whoever keeps the upper half has 2**31 clocks to look.
-- Latency   None.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity frame_clock is
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    time_now : out unsigned(31 downto 0);
    half     : out std_ulogic;
    look     : in  std_ulogic;
    turned   : out std_ulogic
  );
end entity;

architecture rtl of frame_clock is

  signal clocks : unsigned(31 downto 0) := (others => '0');
  signal looked : std_ulogic := '0';

begin

  time_now <= clocks;
  half     <= looked;
  turned   <= clocks(31) xor looked;

  count : process (clock)
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if look = '1' then
        looked <= clocks(31);
      end if;
      if reset = '1' then
        clocks <= (others => '0');
        looked <= '0';
      end if;
    end if;
  end process;

end architecture;
