-- SPDX-License-Identifier: BSD-3-Clause
--
-- gpio: outputs are set, cleared and read back; inputs are synchronised; only watched pins make an event.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity gpio_tb is
  generic (
    pins          : positive range 1 to 32 := 8;
    stable_clocks : positive := 2;
    seed          : positive := 1
  );
end entity;

architecture test of gpio_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  subtype pins_t is std_ulogic_vector(pins - 1 downto 0);

  signal changed   : std_ulogic;
  signal pin_in    : pins_t := (others => '0');
  signal pin_out   : pins_t;
  signal pin_drive : pins_t;
  signal events    : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.gpio
    generic map (pins => pins, stable_clocks => stable_clocks)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, changed => changed,
      pin_in => pin_in, pin_out => pin_out, pin_drive => pin_drive);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  count_events : process (clock) is
  begin
    if rising_edge(clock) and changed = '1' then
      events <= events + 1;
    end if;
  end process;

  master : process is

    variable random  : random_t;

    variable outputs, direction, watch, levels, new_levels : pins_t := (others => '0');
    variable expected : natural := 0;
    variable data     : std_ulogic_vector(31 downto 0);

    function extended (bits : pins_t) return std_ulogic_vector is
      variable result : std_ulogic_vector(31 downto 0) := (others => '0');
    begin
      result(pins_t'range) := bits;
      return result;
    end function;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    check_equal(pin_drive, pins_t'(others => '0'), "pin_drive after a reset");
    for index in 1 to 400 loop
      data := random.vector(32);
      case random.integer_between(0, 6) is
        when 0 =>
          bus_write(clock, m2s, s2m, 1, data);
          outputs := data(pins_t'range);
        when 1 =>
          bus_write(clock, m2s, s2m, 2, data);
          direction := data(pins_t'range);
        when 2 =>
          bus_write(clock, m2s, s2m, 3, data);
          outputs := outputs or data(pins_t'range);
        when 3 =>
          bus_write(clock, m2s, s2m, 4, data);
          outputs := outputs and not data(pins_t'range);
        when 4 =>
          bus_write(clock, m2s, s2m, 5, data);
          watch := data(pins_t'range);
        when 5 =>
          -- Pins change in the middle of a clock.
          new_levels := random.vector(pins);
          wait_clocks(clock, 4);
          wait for clock_period / 3;
          pin_in <= new_levels;
          wait_clocks(clock, stable_clocks + 6);
          if ((new_levels xor levels) and watch) /= pins_t'(others => '0') then
            expected := expected + 1;
          end if;
          levels := new_levels;
          check_equal(events, expected, "events");
        when others =>
          -- A spike shorter than stable_clocks is neither a level nor an event.
          if stable_clocks > 1 then
            wait until rising_edge(clock);
            pin_in <= not levels;
            wait until rising_edge(clock);
            pin_in <= levels;
            wait_clocks(clock, stable_clocks + 6);
            check_equal(events, expected, "events after a spike");
          end if;
      end case;
      wait_clocks(clock, 3);
      check_equal(pin_out, outputs, "pin_out");
      check_equal(pin_drive, direction, "pin_drive");
      bus_expect(clock, m2s, s2m, 0, extended(levels));
      bus_expect(clock, m2s, s2m, random.integer_between(3, 4), extended(outputs));
      bus_expect(clock, m2s, s2m, 1, extended(outputs));
      bus_expect(clock, m2s, s2m, 2, extended(direction));
      bus_expect(clock, m2s, s2m, 5, extended(watch));
    end loop;
    check(expected > 10, "the bench made too few events");

    bus_refuse(clock, m2s, s2m, '1', 0, "a write of the inputs");
    bus_refuse(clock, m2s, s2m, '0', 6, "a read of +6");
    pulse(clock, reset);
    wait_clocks(clock, 1);
    check_equal(pin_drive, pins_t'(others => '0'), "pin_drive after a reset");
    check_equal(pin_out, pins_t'(others => '0'), "pin_out after a reset");

    wait_clocks(clock, 2);
    report_passed("gpio_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "gpio_tb");

end architecture;
