-- SPDX-License-Identifier: BSD-3-Clause
--
-- sonar: the length of echoes, no answer, too long ones, a stuck line, spikes, blocks, enable, errors.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity sonar_tb is
  generic (
    clock_hz   : positive := 4_000_000;
    period_us  : positive := 2000;
    timeout_us : positive := 700;
    seed       : positive := 1
  );
end entity;

architecture test of sonar_tb is

  constant clock_period : time := 1 sec / clock_hz;
  constant period       : time := period_us * 1 us;
  constant valid_bit    : natural := 15;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal trigger, answered, echo : std_ulogic;
  signal forced                  : std_ulogic := '0'; -- echo is high
  signal length, spike           : time := 0 ns;
  signal triggers                : natural;
  signal sampled, failed         : std_ulogic;
  signal samples, failures       : natural := 0;      -- events
  signal echo_wire               : wire_t;

begin

  clock <= not clock after clock_period / 2 when not done;
  echo  <= answered or forced;

  dut : entity work.sonar
    generic map (clock_hz => clock_hz, period_us => period_us, timeout_us => timeout_us)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      echo_wire => echo_wire, trigger => trigger, echo => echo);

  sensor : entity work.sonar_sensor_model
    generic map (cycle_least => period - 2 us) -- a rate that is rounded
    port map (trigger => trigger, echo => answered, length => length, spike => spike, triggers => triggers);

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
    variable value  : natural := 0;

    procedure expect_state (is_valid : std_ulogic; reason, in_a_row : natural) is
    begin
      bus_expect(clock, m2s, s2m, 1,
                 x"0000" & is_valid & std_ulogic_vector(to_unsigned(reason, 3)) &
                 std_ulogic_vector(to_unsigned(in_a_row, 4)) & std_ulogic_vector(to_unsigned(failures mod 256, 8)));
    end procedure;

    -- The next try with an echo of this length, which is a sample.
    procedure measure (time_us : natural) is
      variable got : bus_answer_t;
      constant before : natural := samples;
    begin
      length <= time_us * 1 us;
      wait until samples > before for 3 * period;
      check_equal(samples, before + 1, "an echo is a sample");
      wait until rising_edge(clock);
      bus_read(clock, m2s, s2m, 2, got);
      value := to_integer(unsigned(got.word));
      check(abs (value - time_us) <= 1,
            "an echo of " & integer'image(time_us) & " us is measured as " & integer'image(value));
      check(is_valid(echo_wire) = '1' and value_of(echo_wire) = value, "the wire has the value");
    end procedure;

    -- The next try fails.
    procedure fail (is_valid : std_ulogic; reason, in_a_row : natural; what : string) is
      constant before : natural := failures;
    begin
      wait until failures > before for 3 * period;
      check_equal(failures, before + 1, what);
      wait until rising_edge(clock);
      expect_state(is_valid, reason, in_a_row);
      bus_expect(clock, m2s, s2m, 2, value); -- the last one stays
    end procedure;

  begin
    random.seed(seed);
    wait for 5 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 0, 1);
    expect_state('0', 0, 0);
    bus_expect(clock, m2s, s2m, 2, 0);

    -- Lengths from the shortest to the longest.
    for number in 1 to 12 loop
      measure(random.integer_between(20, timeout_us - 2));
      expect_state('1', 0, 0);
    end loop;
    measure(2);
    measure(timeout_us - 2);
    check_equal(failures, 0, "none of these failed");
    check_equal(triggers, samples, "each sample had its trigger");

    -- A spike is no echo.
    if clock_hz < 10_000_000 then
      spike <= 900 ns;
      for number in 1 to 5 loop
        measure(random.integer_between(20, timeout_us - 2));
      end loop;
      spike <= 0 ns;
    end if;

    -- No answer: the value stays, and is not valid behind the third time.
    length <= 0 ns;
    fail('1', 1, 1, "no echo is a failure");
    fail('1', 1, 2, "no echo is a failure");
    fail('0', 1, 3, "no echo is a failure");
    check(is_valid(echo_wire) = '0', "the wire is not valid either");
    for number in 4 to 17 loop
      fail('0', 1, minimum(15, number), "no echo is a failure");
    end loop;
    measure(300);
    expect_state('1', 0, 0);

    -- Out of range.
    length <= (timeout_us + 2) * 1 us;
    fail('1', 2, 1, "a long echo is a failure");
    fail('1', 2, 2, "a long echo is a failure");
    measure(100);

    -- A line that stays high: there is no trigger, which the sensor checks.
    wait until falling_edge(trigger);
    wait for 50 us;
    forced <= '1';
    length <= 0 ns;
    before := triggers;
    fail('1', 3, 1, "a line that is stuck is a failure");
    fail('1', 3, 2, "a line that is stuck is a failure");
    check(triggers <= before + 1, "a line that is stuck has no trigger");
    wait for 10 us;
    forced <= '0';
    measure(400);

    -- What ends in a block of accesses shows behind it.
    bus_expect(clock, m2s, s2m, 2, value, keep => true);
    before := samples;
    length <= 500 us;
    wait for period + 400 us;
    check_equal(samples, before, "no sample comes in a block");
    bus_expect(clock, m2s, s2m, 2, value);
    wait for 4 * clock_period;
    check_equal(samples, before + 1, "it comes behind it");
    bus_read(clock, m2s, s2m, 2, answer);
    check(abs (to_integer(unsigned(answer.word)) - 500) <= 1, "the value that waited");

    -- Without enable there is no trigger, and no value.
    wait until falling_edge(trigger);
    bus_write(clock, m2s, s2m, 0, 0);
    wait for 5 * clock_period;
    bus_read(clock, m2s, s2m, 1, answer);
    check_equal(answer.word(valid_bit), '0', "not valid without enable");
    before := triggers;
    wait for 3 * period;
    check_equal(triggers, before, "no trigger without enable");
    bus_expect(clock, m2s, s2m, 0, 0);
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"FFFFFFFF"));
    bus_expect(clock, m2s, s2m, 0, 1);
    measure(600);
    expect_state('1', 0, 0);

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the state");
    bus_refuse(clock, m2s, s2m, '1', 2, "a write of the value");
    bus_refuse(clock, m2s, s2m, '0', 3, "a read of +3");

    -- A reset in the middle of an echo.
    wait until rising_edge(answered);
    wait for 20 us;
    reset <= '1';
    wait for 3 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    measure(250);

    report_passed("sonar_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, period * 200, "sonar_tb");

end architecture;
