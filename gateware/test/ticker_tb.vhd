-- SPDX-License-Identifier: BSD-3-Clause
--
-- ticker: the number of ticks, their distances, and a reset.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity ticker_tb is
  generic (
    clock_hz : positive := 12_000_000;
    rate_hz  : positive := 1_000_000
  );
end entity;

architecture test of ticker_tb is

  constant shortest : positive := clock_hz / rate_hz;
  constant longest  : positive := (clock_hz + rate_hz - 1) / rate_hz; -- the same, if the ticks are exact

  signal clock, reset : std_ulogic := '1';
  signal ticks        : std_ulogic;
  signal done         : boolean := false;

begin

  clock <= not clock after 10 ns when not done;

  dut : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => rate_hz)
    port map (clock => clock, reset => reset, tick => ticks);

  check_ticks : process is
    variable since, count : natural;
  begin
    for turn in 1 to 3 loop
      reset <= '1';
      wait_clocks(clock, 3);
      reset <= '0';
      since := 0;
      count := 0;
      for number in 1 to 1000 * longest loop
        tick(clock);
        since := since + 1;
        if ticks = '1' then
          check(since >= shortest and since <= longest, "a tick comes after " & integer'image(since) & " clocks");
          since := 0;
          count := count + 1;
        end if;
        check(since <= longest, "a tick is missing");
      end loop;
      check(count = 1000 or shortest /= longest, "ticks that divide the clock are exact");
      check(abs (real(count) - real(1000 * longest) * real(rate_hz) / real(clock_hz)) <= 1.0 + 0.0005 * real(count),
            "the rate");
      wait_clocks(clock, turn); -- the next reset is at another place
    end loop;
    report_passed("ticker_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "ticker_tb");

end architecture;
