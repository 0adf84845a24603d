-- SPDX-License-Identifier: BSD-3-Clause
--
-- Ticks at a rate: `tick` is high for one clock. If clock_hz is a multiple of rate_hz, each tick is exact, and this
-- takes the fewest cells. Otherwise the ticks are those of rate_pkg: at most one clock early or late, and 0.05 % wrong.
--
-- Latency   The first tick comes clock_hz / rate_hz clocks after the reset.
-- Reset     Begins anew.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;
  use work.width_pkg.all;

entity ticker is
  generic (
    clock_hz : positive := 50_000_000;
    rate_hz  : positive := 1_000_000
  );
  port (
    clock : in  std_ulogic;
    reset : in  std_ulogic; -- synchronous
    tick  : out std_ulogic
  );
end entity;

architecture rtl of ticker is

  constant clocks : positive := maximum(1, clock_hz / rate_hz); -- of a tick, if it is exact

begin

  exact : if clock_hz mod rate_hz = 0 generate
    signal count : unsigned(bits_for(clocks) - 1 downto 0) := (others => '0');
    signal ticks : std_ulogic := '0';
  begin
    process (clock) is
    begin
      if rising_edge(clock) then
        count <= count + 1;
        ticks <= to_bit(count = clocks - 1);
        if count = clocks - 1 then
          count <= (others => '0');
        end if;
        if reset = '1' then
          count <= (others => '0');
          ticks <= '0';
        end if;
      end if;
    end process;
    tick <= ticks;
  else generate
    constant bits  : positive := phase_bits(clock_hz, rate_hz);
    signal   phase : unsigned(bits downto 0) := (others => '0');
  begin
    process (clock) is
    begin
      if rising_edge(clock) then
        phase <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, rate_hz);
        if reset = '1' then
          phase <= (others => '0');
        end if;
      end if;
    end process;
    tick <= phase(bits);
  end generate;

end architecture;
