-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the pulse that makes an FTDI chip send at once. A clock is 20 ns here, and a pulse is 5 clocks.

library ieee;
  use ieee.std_logic_1164.all;

entity siwu_pulse_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    due   : in std_ulogic
  );
end entity;

architecture properties of siwu_pulse_formal is

  constant pulse_clocks : positive := 5;
  constant gap_clocks   : positive := 2;
  constant wait_most    : positive := pulse_clocks + gap_clocks - 1;  -- of a pulse that fell due with another one

  signal siwu_n : std_ulogic;
  signal begun  : std_ulogic := '0';                             -- the reset of power-up is over
  signal was    : std_ulogic := '1';                             -- siwu_n a clock ago
  signal low    : natural range 0 to pulse_clocks + 1 := 0;      -- clocks of this pulse so far
  signal high   : natural range 0 to gap_clocks := gap_clocks;   -- clocks since the last pulse
  signal owed   : std_ulogic := '0';                             -- a pulse is due since the last fall
  signal waited : natural range 0 to wait_most + 1 := 0;         -- clocks for which it has been due

begin

  default clock is rising_edge(clk);

  dut : entity work.siwu_pulse
    generic map (clock_hz => 50_000_000, pulse_ns => 100)
    port map (clock => clk, reset => reset, due => due, siwu_n => siwu_n);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      was   <= siwu_n;
      if siwu_n = '0' then
        high <= 0;
        if low <= pulse_clocks then
          low <= low + 1;
        end if;
      else
        low <= 0;
        if high < gap_clocks then
          high <= high + 1;
        end if;
      end if;
      if siwu_n = '0' and was = '1' then
        owed   <= due;
        waited <= 0;
      elsif due = '1' then
        owed <= '1';
      end if;
      if owed = '1' and not (siwu_n = '0' and was = '1') and waited <= wait_most then
        waited <= waited + 1;
      end if;
      if reset = '1' then
        was    <= '1';
        low    <= 0;
        high   <= gap_clocks;
        owed   <= '0';
        waited <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A pulse lasts exactly its number of clocks.
  pulse_lasts : assert always begun = '1' -> (siwu_n = '0' or low = 0 or low = pulse_clocks) and low <= pulse_clocks;

  -- Between two pulses siwu_n is high for at least two clocks.
  gap_between : assert always begun = '1' and siwu_n = '0' and was = '1' -> high = gap_clocks;

  -- siwu_n falls only if a pulse is due.
  only_when_due : assert always begun = '1' and siwu_n = '0' and was = '1' -> owed = '1';

  -- A pulse that is due comes in time: at once, or after the current pulse and its gap.
  never_forgotten : assert always begun = '1' -> waited <= wait_most;

  -- Two pulses come with the shortest gap between them.
  close_seen : cover {begun = '1' and siwu_n = '0' and was = '1' and high = gap_clocks and owed = '1' and waited > 1};

end architecture;
