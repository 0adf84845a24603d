-- SPDX-License-Identifier: BSD-3-Clause
--
-- input_filter, compared with a count of how long each pin was stable.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity input_filter_tb is
  generic (
    width         : positive := 3;
    stable_clocks : positive := 4;
    seed          : positive := 1
  );
end entity;

architecture test of input_filter_tb is

  constant clock_period : time := 20 ns;

  type history_t is array (0 to stable_clocks + 2) of std_ulogic_vector(width - 1 downto 0); -- newest first

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '1';
  signal pins   : std_ulogic_vector(width - 1 downto 0) := (others => '1');
  signal levels : std_ulogic_vector(width - 1 downto 0);
  signal done   : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.input_filter
    generic map (width => width, stable_clocks => stable_clocks)
    port map (clock => clock, reset => reset, pins => pins, levels => levels);

  process is
    variable random   : random_t;
    variable history  : history_t;
    variable expected : std_ulogic_vector(width - 1 downto 0) := (others => '1');
    variable held     : boolean;
    variable changes  : natural := 0;
  begin
    random.seed(seed);
    wait_clocks(clock, 5);
    check_equal(levels, pins, "levels after a reset");
    reset   <= '0';
    history := (others => pins);
    for index in 1 to 3000 loop
      wait until rising_edge(clock);
      -- The levels come from the samples of the last clock, which are up to two clocks older.
      for pin in 0 to width - 1 loop
        held := true;
        for age in 2 to stable_clocks + 1 loop
          held := held and history(age)(pin) = not expected(pin);
        end loop;
        if held then
          expected(pin) := not expected(pin);
          changes := changes + 1;
        end if;
      end loop;
      check_equal(levels, expected, "levels in clock " & integer'image(index));
      history(1 to history'high) := history(0 to history'high - 1);
      history(0) := pins;
      wait for clock_period * random.integer_between(1, 9) / 10;
      for pin in 0 to width - 1 loop
        if random.chance(20) then
          pins(pin) <= not pins(pin);
        end if;
      end loop;
    end loop;
    check(changes > 100, "the bench made too few changes");
    report_passed("input_filter_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 5000, "input_filter_tb");

end architecture;
