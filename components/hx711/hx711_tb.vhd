-- SPDX-License-Identifier: BSD-3-Clause
--
-- hx711: values of all bits, inputs and settling, no answer, a stuck line, rails, spikes, power down, blocks, errors.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity hx711_tb is
  generic (
    clock_hz : positive := 8_000_000;
    settle   : natural  := 4;
    seed     : positive := 1
  );
end entity;

architecture test of hx711_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant conversion   : time     := 250 us;
  constant timeout_us   : positive := 800;

  subtype value_t is signed(23 downto 0);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sck, dout, spike  : std_ulogic := '0';
  signal fault             : natural := 0;
  signal a, b, c           : value_t := to_signed(1, 24);
  signal input, resets     : natural;
  signal sampled, failed   : std_ulogic;
  signal samples, failures : natural := 0; -- events
  signal value_wire        : wire_t;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.hx711
    generic map (clock_hz => clock_hz, settle => settle, timeout_us => timeout_us)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      value_wire => value_wire, sck => sck, dout => dout);

  chip : entity work.hx711_chip_model
    generic map (conversion_time => conversion, settle => settle)
    port map (
      sck => sck, dout => dout, value_0 => a, value_1 => b, value_2 => c, fault => fault, spike => spike,
      done => done, resets => resets, input => input);

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
    variable last   : value_t := (others => '0');

    procedure expect_state (is_valid : std_ulogic; reason, in_a_row : natural) is
    begin
      bus_expect(clock, m2s, s2m, 1,
                 x"0000" & is_valid & std_ulogic_vector(to_unsigned(reason, 3)) &
                 std_ulogic_vector(to_unsigned(in_a_row, 4)) & std_ulogic_vector(to_unsigned(failures mod 256, 8)));
    end procedure;

    -- The next sample is that of this input, and of what the chip showed.
    procedure expect_sample (from : natural; expected : value_t) is
      constant before : natural := samples;
    begin
      wait until samples > before for (settle + 8) * conversion;
      check_equal(samples, before + 1, "a conversion is a sample");
      check_equal(input, from, "the input");
      last := expected;
      wait until rising_edge(clock);
      bus_expect(clock, m2s, s2m, 2, x"00" & std_ulogic_vector(last));
      check(is_valid(value_wire) = '1' and value_of(value_wire) = resize(last, 32), "the wire has the value");
      expect_state('1', 0, 0);
    end procedure;

    procedure fail (is_valid : std_ulogic; reason, in_a_row : natural; what : string) is
      constant before : natural := failures;
    begin
      wait until failures > before for 2000 us;
      check_equal(failures, before + 1, what);
      wait until rising_edge(clock);
      expect_state(is_valid, reason, in_a_row);
      bus_expect(clock, m2s, s2m, 2, x"00" & std_ulogic_vector(last)); -- the last one stays
    end procedure;

    procedure choose (which : natural) is
    begin
      bus_write(clock, m2s, s2m, 0, 1 + 2 * which);
      wait until rising_edge(clock);
      wait until rising_edge(clock);
      check(is_valid(value_wire) = '0', "the value of another input is not valid");
    end procedure;

  begin
    random.seed(seed);
    a <= to_signed(-1_234_567, 24);
    check_equal(sck, '0', "sck is low from power-up on");
    wait for 5 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 0, 1);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    expect_sample(0, to_signed(-1_234_567, 24));
    check_equal(failures, 0, "settling is no failure");

    -- All bits.
    for number in 1 to 30 loop
      wait until falling_edge(dout) and sck = '0';
      wait for 100 us; -- it is read
      a <= signed(random.vector(24));
      if number <= 23 then
        a <= shift_left(to_signed(1, 24), number - 1);
      end if;
      wait for 0 ns;
      expect_sample(0, a);
    end loop;
    check_equal(failures, 0, "none of these failed");

    -- Other inputs: nothing of the last one is taken for theirs.
    b <= to_signed(5_555_555, 24);
    c <= to_signed(-7_777_777, 24);
    choose(1);
    expect_sample(1, to_signed(5_555_555, 24));
    expect_sample(1, to_signed(5_555_555, 24));
    choose(2);
    expect_sample(2, to_signed(-7_777_777, 24));
    choose(0);
    expect_sample(0, a);
    choose(3); -- is 2
    bus_expect(clock, m2s, s2m, 0, 7);
    expect_sample(2, to_signed(-7_777_777, 24));
    -- in the middle of a reading
    wait until falling_edge(dout) and sck = '0';
    wait for 30 us;
    choose(1);
    expect_sample(1, to_signed(5_555_555, 24));
    choose(0);
    expect_sample(0, a);

    -- The rails.
    wait until falling_edge(dout) and sck = '0';
    wait for 100 us;
    a <= x"7FFFFF";
    fail('1', 2, 1, "the largest value is out of range");
    wait for 30 us;
    a <= x"800000";
    fail('1', 2, 2, "the smallest value is out of range");
    wait for 30 us;
    a <= x"7FFFFE";
    expect_sample(0, x"7FFFFE");
    wait for 30 us;
    a <= x"800001";
    expect_sample(0, x"800001");
    wait for 30 us;
    a <= x"FFFFFF";
    expect_sample(0, x"FFFFFF");
    wait for 30 us;
    a <= x"000000";
    expect_sample(0, x"000000");

    -- Spikes while nothing is ready.
    for number in 1 to 3 loop
      wait for 30 us;
      spike <= '1';
      wait for 5 us;
      spike <= '0';
      expect_sample(0, x"000000");
    end loop;

    -- A line that is high, then one that is low: the chip is reset each time, and goes on by itself.
    wait for 30 us;
    before := resets;
    fault  <= 1;
    fail('1', 1, 1, "no conversion is a failure");
    fail('1', 1, 2, "no conversion is a failure");
    fail('0', 1, 3, "no conversion is a failure");
    check(is_valid(value_wire) = '0', "the wire is not valid either");
    wait for 100 us;
    check_equal(resets, before + 3, "each has a reset");
    fault <= 0;
    expect_sample(0, x"000000");
    wait for 30 us;
    fault <= 2;
    fail('1', 3, 1, "a line that stays low is a failure");
    fail('1', 3, 2, "a line that stays low is a failure");
    fault <= 0;
    wait for 100 us;
    expect_sample(0, x"000000");

    -- What ends in a block of accesses shows behind it.
    wait for 30 us;
    a <= to_signed(99, 24);
    bus_expect(clock, m2s, s2m, 2, 0, keep => true);
    before := samples;
    wait for 2 * conversion;
    check_equal(samples, before, "no sample comes in a block");
    bus_expect(clock, m2s, s2m, 2, 0);
    wait for 4 * clock_period;
    check_equal(samples, before + 1, "it comes behind it");
    bus_expect(clock, m2s, s2m, 2, 99);

    -- Power down, also in the middle of a reading and for a moment.
    wait until falling_edge(dout) and sck = '0';
    wait for 30 us;
    before := resets;
    bus_write(clock, m2s, s2m, 0, 0);
    wait for 4 us;
    check_equal(sck, '1', "sck is high in power down");
    bus_write(clock, m2s, s2m, 0, 1);
    wait for 70 us;
    check_equal(sck, '0', "sck falls again");
    check_equal(resets, before + 1, "the chip was reset");
    expect_sample(0, to_signed(99, 24));
    bus_write(clock, m2s, s2m, 0, 0);
    before := samples;
    wait for 5 ms;
    check_equal(sck, '1', "sck stays high in power down");
    check_equal(samples, before, "no sample in power down");
    check(is_valid(value_wire) = '0', "no value in power down");
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"FFFFFFF9"));
    bus_expect(clock, m2s, s2m, 0, 1);
    expect_sample(0, to_signed(99, 24));

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the state");
    bus_refuse(clock, m2s, s2m, '1', 2, "a write of the value");
    bus_refuse(clock, m2s, s2m, '0', 3, "a read of +3");

    -- A reset in the middle of a reading.
    wait until falling_edge(dout) and sck = '0';
    wait for 20 us;
    reset <= '1';
    wait for 3 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    wait until samples > before + 1 for (settle + 8) * conversion;
    bus_expect(clock, m2s, s2m, 2, 99);

    report_passed("hx711_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 200 ms, "hx711_tb");

end architecture;
