-- SPDX-License-Identifier: BSD-3-Clause
--
-- three_phase_pwm: pulses and dead times are measured at the gates. Duties change together. A fault at any clock cuts
-- within two clocks, and so does a wire that ends. Only a new rise of enable starts again.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity three_phase_pwm_tb is
  generic (
    clock_hz     : positive               := 10_000_000;
    frequency_hz : positive               := 40_000;
    fault_level  : natural range 0 to 1   := 1;
    seed         : positive               := 1
  );
end entity;

architecture test of three_phase_pwm_tb is

  constant clock_period    : time     := 20 ns;  -- of the bench; the design believes in clock_hz
  constant dead_minimum_ns : positive := 730;
  constant duty_bits       : positive := 9;
  constant duty_most       : positive := 2 ** (duty_bits - 1) - 1;
  constant clock_ns        : positive := 1_000_000_000 / clock_hz;
  constant period          : positive := clock_hz / frequency_hz;
  constant turn            : positive := 4; -- clocks at the start of a period, in which the counter stands
  constant off             : natural  := 0;
  constant run             : natural  := 1;
  constant run_sampling    : natural  := 7;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal fault           : std_ulogic;
  signal broken          : std_ulogic := '0'; -- there is a fault
  signal sample, tripped : std_ulogic;
  signal high, low       : std_ulogic_vector(2 downto 0);
  signal wires           : wire_vector_t(0 to 2) := (others => no_wire);

  type numbers_t is array (0 to 2) of integer;
  signal high_clocks, low_clocks, edges : numbers_t := (others => 0); -- since `clear`
  signal middles          : numbers_t := (others => 0);               -- of the last high pulse, twice the clock
  signal samples, trips   : natural := 0;
  signal now_clock        : natural := 0;
  signal clear            : boolean := false;
  signal dead_least       : natural := 1;                             -- clocks that the monitor asks for

  function clocks_of (ns : natural) return natural is
  begin
    return (ns / 8 * 8 + 7 + clock_ns - 1) / clock_ns;
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  fault <= broken when fault_level = 1 else not broken;

  dut : entity work.three_phase_pwm
    generic map (
      clock_hz => clock_hz, frequency_hz => frequency_hz, duty_bits => duty_bits, dead_minimum_ns => dead_minimum_ns,
      fault_level => fault_level)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sample => sample, tripped => tripped,
      duty_0_wire => wires(0), duty_1_wire => wires(1), duty_2_wire => wires(2), fault => fault, high => high,
      low => low);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  meters : process (clock) is
    variable before         : std_ulogic_vector(2 downto 0) := "000";
    variable since_high     : numbers_t := (others => 1000);
    variable since_low      : numbers_t := (others => 1000);
    variable rose           : numbers_t := (others => 0);
  begin
    if rising_edge(clock) then
      now_clock <= now_clock + 1;
      for phase in 0 to 2 loop
        check((high(phase) and low(phase)) = '0', "both gates of a phase are on");
        if high(phase) = '1' then
          check(since_low(phase) >= dead_least, "a high gate is on too soon");
          high_clocks(phase) <= high_clocks(phase) + 1;
          since_high(phase)  := 0;
        else
          since_high(phase) := since_high(phase) + 1;
        end if;
        if low(phase) = '1' then
          check(since_high(phase) > dead_least, "a low gate is on too soon");
          low_clocks(phase) <= low_clocks(phase) + 1;
          since_low(phase)  := 0;
        else
          since_low(phase) := since_low(phase) + 1;
        end if;
        if high(phase) = '1' and before(phase) = '0' then
          rose(phase) := now_clock;
        elsif high(phase) = '0' and before(phase) = '1' then
          middles(phase) <= rose(phase) + now_clock;
        end if;
        if high(phase) /= before(phase) then
          edges(phase) <= edges(phase) + 1;
        end if;
      end loop;
      before := high;
      if sample = '1' then
        samples <= samples + 1;
      end if;
      if tripped = '1' then
        trips <= trips + 1;
      end if;
      if clear then
        high_clocks <= (others => 0);
        low_clocks  <= (others => 0);
        edges       <= (others => 0);
        samples     <= 0;
      end if;
    end if;
  end process;

  master : process is

    variable random : random_t;
    variable duties : numbers_t;
    variable width  : natural;

    procedure write_duty (phase : natural; duty : integer) is
    begin
      bus_write(clock, m2s, s2m, 3 + phase, std_ulogic_vector(to_signed(duty, 32)));
    end procedure;

    procedure start_measuring is
    begin
      clear <= true;
      wait_clocks(clock, 1);
      clear <= false;
    end procedure;

    -- The levels of the counter: a power of two, so that each lasts a clock or more.
    function levels return positive is
      variable found : positive := 2;
    begin
      while found < 2 ** (duty_bits - 2) and 4 * found + turn <= period loop
        found := 2 * found;
      end loop;
      return found;
    end function;

    -- Clocks for which the high side is wanted in one period. The duty is rounded to levels.
    function wanted (duty : integer) return natural is
      constant level : natural := (2 * levels * (duty + duty_most + 1) / (2 * duty_most + 2) + 1) / 2;
    begin
      return integer(real(period - turn) * real(level) / real(levels));
    end function;

    procedure expect_near (got : integer; expected : integer; slack : natural; what : string) is
    begin
      check(abs (got - expected) <= slack,
            what & ": " & integer'image(got) & " clocks, expected " & integer'image(expected));
    end procedure;

    -- Measures ten periods.
    procedure measure is
    begin
      wait_clocks(clock, 3 * period);
      start_measuring;
      wait_clocks(clock, 10 * period - 1);
      tick(clock);
    end procedure;

    -- The gates over ten periods, with a dead time of so many clocks.
    procedure expect_gates (dead : natural; what : string) is
    begin
      measure;
      for phase in 0 to 2 loop
        width := wanted(duties(phase));
        expect_near(high_clocks(phase), 10 * maximum(0, width - dead), 35, what & ", high");
        expect_near(low_clocks(phase), 10 * maximum(0, period - width - dead), 35, what & ", low");
      end loop;
    end procedure;

    procedure expect_off (clocks : natural; what : string) is
    begin
      for index in 1 to clocks loop
        tick(clock);
        check(high = "000" and low = "000", what);
      end loop;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    -- Off until it is enabled; a dead time below the least one is the least one.
    bus_expect(clock, m2s, s2m, 2, dead_minimum_ns);
    bus_write(clock, m2s, s2m, 2, 1);
    bus_expect(clock, m2s, s2m, 2, dead_minimum_ns);
    write_duty(0, -5);
    bus_expect(clock, m2s, s2m, 3, x"FFFFFFFB");
    bus_write(clock, m2s, s2m, 3, x"00000000");
    expect_off(2 * period, "a gate is on before enable");
    dead_least <= clocks_of(dead_minimum_ns);

    bus_write(clock, m2s, s2m, 0, run);
    for index in 1 to 8 loop
      for phase in 0 to 2 loop
        duties(phase) := random.integer_between(-duty_most * 3 / 4, duty_most * 3 / 4);
        write_duty(phase, duties(phase));
      end loop;
      expect_gates(clocks_of(dead_minimum_ns), "gates");
      expect_near(middles(1), middles(0), 4, "twice the middle of phase 1");
      expect_near(middles(2), middles(0), 4, "twice the middle of phase 2");
    end loop;

    -- All and nothing have no edges. A pulse shorter than the dead time vanishes.
    duties := (duty_most, -duty_most, -duty_most + 6);
    for phase in 0 to 2 loop
      write_duty(phase, duties(phase));
    end loop;
    measure;
    check_equal(edges(0), 0, "edges at 100 %");
    check_equal(high_clocks(0), 10 * period, "high clocks at 100 %");
    check_equal(edges(1), 0, "edges at 0 %");
    check_equal(low_clocks(1), 10 * period, "low clocks at 0 %");
    check_equal(high_clocks(2), 0, "high clocks of a pulse that is too short");
    check(low_clocks(2) < 10 * period, "the short pulse takes no time from the low gate");
    write_duty(1, -duty_most - 1);
    wait_clocks(clock, 2 * period);
    start_measuring;
    wait_clocks(clock, 4 * period);
    check_equal(edges(1), 0, "edges at the smallest number");

    -- A longer dead time.
    bus_write(clock, m2s, s2m, 2, 2500);
    bus_expect(clock, m2s, s2m, 2, 2500);
    duties := (0, 20, -30);
    for phase in 0 to 2 loop
      write_duty(phase, duties(phase));
    end loop;
    wait_clocks(clock, period);
    dead_least <= clocks_of(2500);
    expect_gates(clocks_of(2500), "a long dead time");
    dead_least <= clocks_of(dead_minimum_ns);
    bus_write(clock, m2s, s2m, 2, 0);

    -- Duties that are written in one period change together, where the counter is largest.
    bus_write(clock, m2s, s2m, 0, 3);
    for phase in 0 to 2 loop
      write_duty(phase, 0);
    end loop;
    wait_clocks(clock, 3 * period);
    for index in 1 to 6 loop
      duties(0) := random.integer_between(-duty_most / 2, duty_most / 2);
      duties    := (others => duties(0));
      wait until rising_edge(clock) and sample = '1';
      wait_clocks(clock, random.integer_between(0, period / 2));
      for phase in 0 to 2 loop
        write_duty(phase, duties(phase));
      end loop;
      for clock_index in 1 to 2 * period loop
        tick(clock);
        check((high = "000" or high = "111") and (low = "000" or low = "111"), "the phases change at different clocks");
      end loop;
    end loop;

    -- Samples at the start, when low sides are on, and in the middle.
    bus_write(clock, m2s, s2m, 0, run_sampling);
    wait_clocks(clock, 10);
    start_measuring;
    for index in 1 to 10 loop
      wait until rising_edge(clock) and sample = '1';
      check(high = "111" or low = "111", "a sample during a dead time");
    end loop;
    wait_clocks(clock, 4);
    start_measuring;
    wait_clocks(clock, 10 * period);
    expect_near(samples, 20, 1, "samples");
    bus_write(clock, m2s, s2m, 0, run);
    wait_clocks(clock, 4);
    start_measuring;
    wait_clocks(clock, 3 * period);
    check_equal(samples, 0, "samples that nobody asked for");

    -- A fault at any clock, and a bus that does not give up.
    for index in 1 to 25 loop
      wait_clocks(clock, random.integer_between(1, 2 * period));
      wait for clock_period / 3;
      broken <= '1';
      tick(clock, 2);
      check(high = "000" and low = "000", "a gate is on two clocks after the fault");
      expect_off(random.integer_between(0, 30), "a gate is on during the fault");
      if random.chance(50) then
        bus_write(clock, m2s, s2m, 0, off);
        bus_write(clock, m2s, s2m, 0, run);
        expect_off(period, "enable rose during the fault");
        bus_expect(clock, m2s, s2m, 1, 6);
      end if;
      broken <= '0';
      bus_write(clock, m2s, s2m, 0, run);
      write_duty(0, duty_most);
      expect_off(2 * period, "a gate is on without a new rise of enable");
      bus_expect(clock, m2s, s2m, 1, 2);
      write_duty(0, duties(0));
      bus_write(clock, m2s, s2m, 0, off);
      bus_write(clock, m2s, s2m, 0, run);
      wait_clocks(clock, period);
      bus_expect(clock, m2s, s2m, 1, 1);
      start_measuring;
      wait_clocks(clock, 2 * period);
      check(edges(1) > 0, "nothing runs after the fault");
      check(trips >= index, "no event of the fault");
    end loop;

    -- Wires bring the duties. One that ends cuts, and only a new rise of enable starts again.
    for index in 1 to 12 loop
      wires <= (wire_of(to_signed(duty_most, 32)), wire_of(to_signed(-duty_most - 1, 32)), wire_of(to_signed(0, 32)));
      bus_write(clock, m2s, s2m, 0, off);
      bus_write(clock, m2s, s2m, 0, run);
      bus_expect(clock, m2s, s2m, 3, duty_most);
      bus_expect(clock, m2s, s2m, 5, 0);
      wait_clocks(clock, 2 * period);
      bus_expect(clock, m2s, s2m, 1, 1);
      start_measuring;
      wait_clocks(clock, 4 * period);
      check(edges(0) = 0 and edges(1) = 0 and edges(2) > 0, "the gates follow the wires");
      check(high(0) = '1' and low(1) = '1', "always high, and always low");
      wait_clocks(clock, random.integer_between(1, 2 * period));
      wires(index mod 3)(wire_bits - 1) <= '0';
      tick(clock, 2);
      check(high = "000" and low = "000", "a gate is on two clocks after a wire has ended");
      bus_expect(clock, m2s, s2m, 1, 8);
      wires(index mod 3)(wire_bits - 1) <= '1';
      bus_write(clock, m2s, s2m, 0, run);
      expect_off(2 * period, "a gate is on without a new rise of enable");
      bus_write(clock, m2s, s2m, 0, off);
      wires(index mod 3)(wire_bits - 1) <= '0'; -- without enable that is nothing
      wait_clocks(clock, 3);
      bus_expect(clock, m2s, s2m, 1, 8);
    end loop;
    wires <= (others => no_wire);
    bus_write(clock, m2s, s2m, 0, run);
    wait_clocks(clock, period);
    bus_expect(clock, m2s, s2m, 1, 1);

    -- Off, the errors of the bus, and a reset.
    bus_write(clock, m2s, s2m, 0, off);
    wait_clocks(clock, 2);
    expect_off(period, "a gate is on after enable fell");
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '0', 6, "a read beyond the registers");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read beyond the registers");
    bus_write(clock, m2s, s2m, 0, run);
    wait_clocks(clock, period);
    pulse(clock, reset);
    expect_off(period, "a gate is on after a reset");
    bus_expect(clock, m2s, s2m, 4, 0);
    bus_expect(clock, m2s, s2m, 0, 0);

    wait_clocks(clock, 2);
    report_passed("three_phase_pwm_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 2000000, "three_phase_pwm_tb");

end architecture;
