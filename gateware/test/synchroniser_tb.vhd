-- SPDX-License-Identifier: BSD-3-Clause
--
-- synchroniser: bits that change at any moment, compared with a model; resets, and the levels at power-up.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity synchroniser_tb is
  generic (
    width : positive   := 3;
    idle  : std_ulogic := '0';
    seed  : positive   := 1
  );
end entity;

architecture test of synchroniser_tb is

  constant clock_period : time := 20 ns;

  subtype bits_t is std_ulogic_vector(width - 1 downto 0);

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '0';
  signal pins   : bits_t     := (others => not idle);
  signal levels : bits_t;
  signal done   : boolean := false;

  signal sampled, expected : bits_t := (others => idle); -- at the last edge, and at the one before

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.synchroniser
    generic map (width => width, idle => idle)
    port map (clock => clock, reset => reset, asynchronous => pins, levels => levels);

  -- What stood at the pins at one edge is on the levels after the next.
  model : process (clock) is
  begin
    if rising_edge(clock) then
      sampled  <= pins;
      expected <= sampled;
      if reset = '1' then
        sampled  <= (others => idle);
        expected <= (others => idle);
      end if;
    end if;
  end process;

  compare : process is
  begin
    wait for 1 ps;
    check_equal(levels, expected, "levels at power-up");
    loop
      wait until falling_edge(clock);
      check_equal(levels, expected, "levels");
    end loop;
  end process;

  stimulus : process is
    variable random : random_t;
  begin
    random.seed(seed);
    for index in 1 to 500 loop
      wait for random.integer_between(1, 50_000) * 1 ps;
      if clock'last_event = 0 ps then
        wait for 1 ps; -- not at the edge itself: there the flip-flop sees the old level or the new one
      end if;
      pins <= random.vector(width);
      if random.chance(5) then
        reset <= '1';
        for clocks in 1 to random.integer_between(1, 4) loop
          wait until falling_edge(clock);
        end loop;
        reset <= '0';
      end if;
    end loop;
    report_passed("synchroniser_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "synchroniser_tb");

end architecture;
