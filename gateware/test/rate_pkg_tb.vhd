-- SPDX-License-Identifier: BSD-3-Clause
--
-- rate_pkg: the accumulator's rate for clocks and rates of every size, checked by real arithmetic and by counting
-- ticks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.rate_pkg.all;

entity rate_pkg_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture test of rate_pkg_tb is

begin

  process is
    variable random            : random_t;
    variable clock_hz, rate_hz : positive;
    variable bits, ticks       : natural;
    variable phase             : unsigned(40 downto 0);
    variable rate              : real;
  begin
    random.seed(seed);
    for index in 1 to 500 loop
      clock_hz := random.integer_between(1, 2 ** random.integer_between(1, 30) - 1);
      rate_hz  := random.integer_between(maximum(1, clock_hz / (2 ** random.integer_between(0, 19))), clock_hz);
      if index <= 10 then
        rate_hz := clock_hz;
      end if;
      bits := phase_bits(clock_hz, rate_hz);
      rate := real(phase_increment(clock_hz, rate_hz)) / 2.0 ** bits * real(clock_hz);
      check(abs (rate - real(rate_hz)) <= real(rate_hz) * 0.0005,
            integer'image(rate_hz) & " Hz of " & integer'image(clock_hz) & " became " & real'image(rate));
    end loop;

    for index in 1 to 500 loop
      clock_hz := random.integer_between(1, 1_000_000_000);
      bits     := random.integer_between(0, 2000); -- nanoseconds
      rate     := real(bits) * 1.0e-9 * real(clock_hz);
      ticks    := clocks_lasting(bits, clock_hz);
      check(real(ticks) >= rate and real(ticks) <= rate * 1.001 + 1.01,
            integer'image(bits) & " ns at " & integer'image(clock_hz) & " Hz became " &
            integer'image(ticks) & " clocks");
    end loop;
    check_equal(clocks_lasting(30, 50_000_000), 2, "clocks of 30 ns at 50 MHz");
    check_equal(clocks_lasting(40, 50_000_000), 2, "clocks of 40 ns at 50 MHz");

    bits  := phase_bits(50_000_000, 3_000_000);
    phase := (others => '0');
    ticks := 0;
    for index in 1 to 50_000 loop
      phase(bits downto 0) := ('0' & phase(bits - 1 downto 0)) + phase_increment(50_000_000, 3_000_000);
      if phase(bits) = '1' then
        ticks := ticks + 1;
      end if;
    end loop;
    check(abs (ticks - 3000) <= 2, "ticks in a millisecond at 3 MHz: " & integer'image(ticks));

    report_passed("rate_pkg_tb");
    wait;
  end process;

end architecture;
