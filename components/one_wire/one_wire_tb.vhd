-- SPDX-License-Identifier: BSD-3-Clause
--
-- one_wire: temperatures, 85 degC that is true and that is not, CRC, no answer, shorts, conversions that do not begin
-- or end, blocks, enable, errors.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity one_wire_tb is
  generic (
    clock_hz   : positive := 1_000_000;
    period_ms  : positive := 120;
    resolution : positive := 9;
    parasite   : natural  := 0;
    seed       : positive := 1
  );
end entity;

architecture test of one_wire_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant period       : time     := period_ms * 1 ms;
  constant step         : positive := 2 ** (12 - resolution); -- of a temperature, in 1/16 degC
  constant hot          : integer  := 85 * 16;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal line_in, line_out, line_drive : std_ulogic;
  signal temperature       : signed(15 downto 0) := to_signed(25 * 16, 16);
  signal fault, tries      : natural := 0;
  signal restart           : std_ulogic := '0';
  signal sampled, failed   : std_ulogic;
  signal samples, failures : natural := 0; -- events

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.one_wire
    generic map (clock_hz => clock_hz, period_ms => period_ms, resolution => resolution, parasite => parasite)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      line_in => line_in, line_out => line_out, line_drive => line_drive);

  thermometer : entity work.one_wire_thermometer_model
    generic map (resolution => resolution, parasite => parasite)
    port map (
      line_out => line_out, line_drive => line_drive, line_in => line_in, temperature => temperature, fault => fault,
      restart => restart, done => done, tries => tries);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if sampled = '1' then
        samples <= samples + 1;
      end if;
      if failed = '1' then
        failures <= failures + 1;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random : random_t;
    variable before : natural;
    variable answer : bus_answer_t;
    variable last   : std_ulogic_vector(15 downto 0) := x"0000";

    procedure expect_state (is_valid : std_ulogic; reason, in_a_row : natural) is
    begin
      bus_expect(clock, m2s, s2m, 1,
                 x"0000" & is_valid & std_ulogic_vector(to_unsigned(reason, 3)) &
                 std_ulogic_vector(to_unsigned(in_a_row, 4)) & std_ulogic_vector(to_unsigned(failures mod 256, 8)));
    end procedure;

    -- The next try gives this temperature, in 1/16 degC.
    procedure measure (sixteenths : integer) is
      constant before : natural := samples;
    begin
      temperature <= to_signed(sixteenths, 16);
      last        := std_ulogic_vector(to_signed(sixteenths / step * step, 16));
      wait until samples > before for 2 * period;
      check_equal(samples, before + 1, "a reading is a sample");
      wait until rising_edge(clock);
      bus_expect(clock, m2s, s2m, 2, x"0000" & last);
      expect_state('1', 0, 0);
    end procedure;

    procedure fail (is_valid : std_ulogic; reason, in_a_row : natural; what : string) is
      constant before : natural := failures;
    begin
      wait until failures > before for 3 * period;
      check_equal(failures, before + 1, what);
      wait until rising_edge(clock);
      expect_state(is_valid, reason, in_a_row);
      bus_expect(clock, m2s, s2m, 2, x"0000" & last); -- the last one stays
    end procedure;

    -- The power is away for a moment, so long behind the next reset.
    procedure restart_after (delay : time) is
      constant first : natural := tries;
    begin
      wait until tries > first;
      wait for delay;
      restart <= '1';
      wait for 10 us;
      restart <= '0';
    end procedure;

  begin
    random.seed(seed);
    wait for clock_period / 10;
    check_equal(line_drive, '0', "the line is free from power-up on");
    wait for 5 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 0, 1);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);

    measure(25 * 16);
    check_equal(tries, 3, "each try has three resets");
    for value in 1 to 4 loop
      measure(random.integer_between(0, 125 * 16 / step) * step);
    end loop;
    measure(0);
    measure(-55 * 16);
    measure(-16);
    measure(125 * 16);
    check_equal(failures, 0, "none of these failed");

    -- 85 degC, once true and once the word of a thermometer that has restarted: before, in and behind its conversion.
    measure(hot);
    measure(-8);
    restart_after(7 ms);
    fail('1', 3, 1, "what has restarted before it converts says 85 degC");
    measure(30 * 16);
    restart_after(60 ms);
    fail('1', 3, 1, "what has restarted in its conversion says 85 degC");
    measure(hot);

    -- A wrong bit, and a thermometer that sends nothing.
    fault <= 3;
    fail('1', 2, 1, "a wrong bit is a failure");
    fault <= 6;
    if parasite = 1 then
      fail('1', 2, 2, "ones are a failure");
    else
      fail('1', 3, 2, "ones are a failure");
    end if;
    fault <= 0;
    measure(40 * 16);

    -- No thermometer. The value is not valid behind the third time.
    fault <= 1;
    fail('1', 1, 1, "no presence is a failure");
    fail('1', 1, 2, "no presence is a failure");
    fail('0', 1, 3, "no presence is a failure");
    fault <= 0;
    measure(41 * 16);

    -- A line that is shorted.
    fault <= 2;
    fail('1', 4, 1, "a short is a failure");
    fault <= 0;
    measure(42 * 16);

    -- A thermometer that does not convert, or never ends.
    if parasite = 0 then
      fault <= 4;
      fail('1', 3, 1, "a conversion that does not begin is a failure");
      fault <= 5;
      fail('1', 3, 2, "a conversion that does not end is a failure");
      fault <= 0;
      measure(43 * 16);
    end if;

    -- What ends in a block of accesses shows behind it.
    bus_expect(clock, m2s, s2m, 2, x"0000" & last, keep => true);
    before := samples;
    temperature <= to_signed(50 * 16, 16);
    wait for period + period / 2;
    check_equal(samples, before, "no sample comes in a block");
    bus_expect(clock, m2s, s2m, 2, x"0000" & last);
    wait for 4 * clock_period;
    check_equal(samples, before + 1, "it comes behind it");
    bus_expect(clock, m2s, s2m, 2, 50 * 16);

    -- Without enable the line is free, and there is no value.
    before := tries;
    wait until tries > before;
    wait for 2 ms;
    bus_write(clock, m2s, s2m, 0, 0);
    wait for 5 * clock_period;
    check_equal(line_drive, '0', "the line is free without enable");
    bus_read(clock, m2s, s2m, 1, answer);
    check_equal(answer.word(15), '0', "not valid without enable");
    before := tries;
    wait for 2 * period;
    check_equal(tries, before, "no try without enable");
    bus_expect(clock, m2s, s2m, 0, 0);
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"FFFFFFFF"));
    bus_expect(clock, m2s, s2m, 0, 1);
    measure(-10 * 16);

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the state");
    bus_refuse(clock, m2s, s2m, '1', 2, "a write of the value");
    bus_refuse(clock, m2s, s2m, '0', 3, "a read of +3");

    report_passed("one_wire_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 60 * period, "one_wire_tb");

end architecture;
