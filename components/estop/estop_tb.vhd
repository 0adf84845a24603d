-- SPDX-License-Identifier: BSD-3-Clause
--
-- estop: each contact alone stops, after the filter and not before. Closing starts nothing. The watchdog stops in time,
-- and not while it is fed. The causes can be told apart.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity estop_tb is
  generic (
    closed_level : natural range 0 to 1 := 1;
    seed         : positive             := 1
  );
end entity;

architecture test of estop_tb is

  constant clock_period    : time     := 20 ns;
  constant inputs          : positive := 5;
  constant filter_clocks   : positive := 20;  -- 10 us at 2 MHz
  constant watchdog_clocks : positive := 4000; -- 2 ms
  constant latency         : positive := 3;

  subtype chain_t is std_ulogic_vector(inputs - 1 downto 0);

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal m2s          : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m          : wishbone_s2m_t;
  signal closed       : chain_t := (others => '1');
  signal chain        : chain_t;
  signal run, tripped : std_ulogic;
  signal trips        : natural := 0;
  signal done         : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;
  chain <= closed when closed_level = 1 else not closed;

  dut : entity work.estop
    generic map (
      clock_hz => 2_000_000, inputs => inputs, closed_level => closed_level, filter_us => 10, watchdog_ms => 2)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped, chain => chain,
      run => run);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  process (clock) is
  begin
    if rising_edge(clock) and tripped = '1' then
      trips <= trips + 1;
    end if;
  end process;

  master : process is

    constant all_closed : chain_t := (others => '1');

    variable random  : random_t;
    variable contact : natural;
    variable count   : natural;

    procedure enable (on_off : natural) is
    begin
      bus_write(clock, m2s, s2m, 0, on_off);
    end procedure;

    procedure start is
    begin
      enable(0);
      enable(1);
      tick(clock, 2);
      check_equal(run, '1', "run after the start");
      bus_expect(clock, m2s, s2m, 1, 1);
      bus_expect(clock, m2s, s2m, 3, 0);
    end procedure;

  begin
    random.seed(seed);
    tick(clock, 3);
    check_equal(run, '0', "run in reset");
    reset <= '0';
    tick(clock, 5);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 2 ** inputs - 1);

    for index in 1 to 4 * inputs loop
      start;
      contact := index mod inputs;

      closed(contact) <= '0'; -- shorter than the filter, by a clock
      tick(clock, filter_clocks);
      closed(contact) <= '1';
      tick(clock, filter_clocks);
      check_equal(run, '1', "run after a short opening");

      closed(contact) <= '0';
      if random.chance(50) then
        closed((contact + 1) mod inputs) <= '0';
      end if;
      tick(clock, filter_clocks + latency - 1);
      check_equal(run, '1', "run before the filter is over");
      tick(clock, 1);
      check_equal(run, '0', "run after the filter");
      bus_expect(clock, m2s, s2m, 1, 2 + 8);
      bus_expect(clock, m2s, s2m, 3, std_ulogic_vector(resize(unsigned(not closed), 32)));

      enable(0); -- a rise of enable starts nothing while the chain is open
      enable(1);
      tick(clock, 4);
      check_equal(run, '0', "run with an open chain");
      closed <= all_closed; -- nor does closing
      tick(clock, 10);
      check_equal(run, '0', "run after closing");
      check_equal(trips, index, "trips");
      bus_expect(clock, m2s, s2m, 1, 2);
    end loop;

    -- The watchdog.
    count := trips;
    start;
    for index in 1 to 5 loop
      tick(clock, watchdog_clocks - 20 - random.integer_between(0, 100));
      bus_write(clock, m2s, s2m, 4, 1);
      check_equal(run, '1', "run while it is fed");
    end loop;
    tick(clock, watchdog_clocks - 8);
    check_equal(run, '1', "run shortly before the time is over");
    tick(clock, 12);
    check_equal(run, '0', "run after the time");
    bus_expect(clock, m2s, s2m, 1, 2 + 4);
    bus_expect(clock, m2s, s2m, 3, 0);
    bus_write(clock, m2s, s2m, 4, 1);
    tick(clock, 4);
    check_equal(run, '0', "run after a late feed");
    check_equal(trips, count + 1, "trips of the watchdog");

    -- To stop in order is no trip.
    start;
    enable(0);
    tick(clock, 2);
    check_equal(run, '0', "run without enable");
    bus_expect(clock, m2s, s2m, 1, 0);
    check_equal(trips, count + 1, "trips of a stop in order");

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '0', 5, "a read beyond the registers");
    wait_clocks(clock, 2);
    report_passed("estop_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "estop_tb");

end architecture;
