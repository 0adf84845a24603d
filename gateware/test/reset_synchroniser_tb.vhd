-- SPDX-License-Identifier: BSD-3-Clause
--
-- reset_synchroniser: at power-up, at random moments within a clock, and with pulses shorter than a clock.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity reset_synchroniser_tb is
  generic (
    clocks : positive := 8;
    seed   : positive := 1
  );
end entity;

architecture test of reset_synchroniser_tb is

  constant clock_period : time := 20 ns;

  signal clock              : std_ulogic := '0';
  signal asynchronous_reset : std_ulogic := '0';
  signal reset              : std_ulogic;
  signal done               : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.reset_synchroniser
    generic map (clocks => clocks)
    port map (clock => clock, asynchronous_reset => asynchronous_reset, reset => reset);

  -- It may begin at any time, but ends at a rising edge of the clock.
  ends : process (reset) is
  begin
    assert not falling_edge(reset) or clock'last_event = 0 ns or now = 0 ns
      report "reset ended away from the clock"
      severity failure;
  end process;

  stimulus : process is

    variable random : random_t;

    -- From here on `reset` lasts for exactly `clocks` rising edges.
    procedure expect_reset is
    begin
      for edge in 1 to clocks loop
        wait for 1 ps;
        check_equal(reset, '1', "reset before edge " & integer'image(edge));
        wait until rising_edge(clock);
      end loop;
      wait for 1 ps;
      check_equal(reset, '0', "reset after all edges");
    end procedure;

  begin
    random.seed(seed);
    expect_reset; -- power-up: without a request
    for index in 1 to 200 loop
      wait until falling_edge(clock);
      wait for random.integer_between(0, 40000) * 1 ps;
      asynchronous_reset <= '1';
      wait for 1 ps;
      check_equal(reset, '1', "reset at once");
      if random.chance(50) then
        wait for random.integer_between(1, 100000) * 1 ps;
      end if;
      if clock'last_event < 2 ps then
        wait for 2 ps; -- not at the edge itself: there the flip-flop may or may not see it
      end if;
      asynchronous_reset <= '0';
      expect_reset;
    end loop;
    report_passed("reset_synchroniser_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "reset_synchroniser_tb");

end architecture;
