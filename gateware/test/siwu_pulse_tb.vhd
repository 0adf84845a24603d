-- SPDX-License-Identifier: BSD-3-Clause
--
-- siwu_pulse: a pulse after each `due`, of the right width. A `due` during a wait shares the pulse. There is a gap
-- between two pulses.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity siwu_pulse_tb is
  generic (
    clock_hz : positive := 50_000_000;
    pulse_ns : positive := 250;
    seed     : positive := 1
  );
end entity;

architecture test of siwu_pulse_tb is

  constant clock_period : time := 1 sec / clock_hz;

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '1';
  signal due    : std_ulogic := '0';
  signal siwu_n : std_ulogic;
  signal owed   : boolean := false; -- a pulse is due and has not begun
  signal pulses : natural := 0;
  signal done   : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.siwu_pulse
    generic map (clock_hz => clock_hz, pulse_ns => pulse_ns)
    port map (clock => clock, reset => reset, due => due, siwu_n => siwu_n);

  watch : process is
    variable rose : time := 0 ns;
    variable fell : time;
  begin
    wait until falling_edge(siwu_n);
    fell := now;
    check(owed, "a pulse that nobody is owed");
    check(pulses = 0 or now - rose >= 2 * clock_period - 1 ps, "the gap between two pulses");
    wait until rising_edge(siwu_n);
    rose := now;
    check(reset = '1' or now - fell >= pulse_ns * 1 ns - 1 ps, "a pulse of " & time'image(now - fell));
    check(now - fell < pulse_ns * 1 ns + clock_period + 1 ps, "a pulse of " & time'image(now - fell));
  end process;

  owe : process (clock) is
    variable before : std_ulogic := '1';
  begin
    if rising_edge(clock) then
      if due = '1' then
        owed <= true;
      elsif siwu_n = '0' and before = '1' then
        owed   <= false;
        pulses <= pulses + 1;
      end if;
      before := siwu_n;
    end if;
  end process;

  play : process is
    variable random : random_t;

  begin
    random.seed(seed);
    wait_clocks(clock, 3);
    reset <= '0';
    wait_clocks(clock, 3);
    check_equal(pulses, 0, "pulses before any was due");

    -- At once: low in the next clock.
    pulse(clock, due);
    wait until rising_edge(clock);
    check_equal(siwu_n, '0', "siwu_n a clock behind due");

    -- Three during a pulse make one more.
    pulse(clock, due);
    pulse(clock, due);
    pulse(clock, due);
    wait for 5 * pulse_ns * 1 ns + 10 * clock_period;
    check_equal(pulses, 2, "pulses of four that came together");

    -- As many pulses as are due, if that is not too often, and never none at all.
    for index in 1 to 100 loop
      pulse(clock, due);
      wait_clocks(clock, random.integer_between(0, 30));
    end loop;
    wait for 5 * pulse_ns * 1 ns + 10 * clock_period;
    check(not owed, "the last one was given");

    pulse(clock, due);
    wait_clocks(clock, 1);
    reset <= '1';
    wait_clocks(clock, 2);
    check_equal(siwu_n, '1', "siwu_n in reset");

    report_passed("siwu_pulse_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 20000 * clock_period + 1 ms, "siwu_pulse_tb");

end architecture;
