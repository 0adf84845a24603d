-- SPDX-License-Identifier: BSD-3-Clause
--
-- pwm: each pulse and period is measured at the pins. Changes come only between periods. Servo pulses are in
-- microseconds and within limits.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity pwm_tb is
  generic (
    clock_hz : positive := 2_500_000;
    seed     : positive := 1
  );
end entity;

architecture test of pwm_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  constant channels     : positive := 3;
  constant counter_bits : positive := 16;

  signal pins : std_ulogic_vector(channels - 1 downto 0);

  -- For each channel: clocks of the last whole pulse, clocks between the last two rising edges, and the number of
  -- pulses.
  type numbers_t is array (0 to channels - 1) of natural;
  signal high_clocks, period_clocks, pulses : numbers_t := (others => 0);

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.pwm
    generic map (clock_hz => clock_hz, channels => channels, counter_bits => counter_bits)
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pins => pins);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  meters : for channel in 0 to channels - 1 generate
    process (clock) is
      variable before      : std_ulogic := '0';
      variable high, whole : natural := 0;
    begin
      if rising_edge(clock) then
        whole := whole + 1;
        if pins(channel) = '1' then
          high := high + 1;
        end if;
        if pins(channel) = '1' and before = '0' then
          period_clocks(channel) <= whole;
          whole := 0;
        elsif pins(channel) = '0' and before = '1' then
          high_clocks(channel) <= high;
          pulses(channel)      <= pulses(channel) + 1;
          high := 0;
        end if;
        before := pins(channel);
      end if;
    end process;
  end generate;

  master : process is

    variable random  : random_t;

    constant off   : natural := 0;
    constant on_pwm : natural := 1;
    constant servo : natural := 3;

    variable period : natural;
    variable widths, before : numbers_t;

    procedure expect_channel (channel : natural; high : natural; whole : natural; slack : natural) is
    begin
      check(abs (high_clocks(channel) - high) <= slack,
            "channel " & integer'image(channel) & ": a pulse of " & integer'image(high_clocks(channel)) &
            " clocks, not " & integer'image(high));
      check(abs (period_clocks(channel) - whole) <= slack,
            "channel " & integer'image(channel) & ": a period of " & integer'image(period_clocks(channel)) &
            " clocks, not " & integer'image(whole));
    end procedure;

    -- Checks the number of high clocks of one channel over some clocks.
    procedure count_high (channel : natural; over : positive; expected : natural; what : string) is
      variable high : natural := 0;
    begin
      for index in 1 to over loop
        wait until rising_edge(clock);
        if pins(channel) = '1' then
          high := high + 1;
        end if;
      end loop;
      check_equal(high, expected, what);
    end procedure;

    -- A servo pulse in clocks.
    function clocks_of (microseconds : natural) return natural is
    begin
      return integer(real(microseconds) * real(clock_hz) / 1.0e6);
    end function;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    count_high(0, 100, 0, "high before it is enabled");

    -- Off while the period is zero, for all widths.
    bus_write(clock, m2s, s2m, 2, 10);
    bus_write(clock, m2s, s2m, 0, on_pwm);
    count_high(0, 100, 0, "high with no period");

    for index in 1 to 12 loop
      period := random.integer_between(4, 300);
      bus_write(clock, m2s, s2m, 0, off);
      bus_write(clock, m2s, s2m, 1, period);
      for channel in 0 to channels - 1 loop
        widths(channel) := random.integer_between(1, period - 1);
        bus_write(clock, m2s, s2m, 2 + channel, widths(channel));
      end loop;
      bus_write(clock, m2s, s2m, 0, on_pwm);
      wait_clocks(clock, 3 * period + 10);
      for channel in 0 to channels - 1 loop
        expect_channel(channel, widths(channel), period, 0);
        bus_expect(clock, m2s, s2m, 2 + channel, widths(channel));
      end loop;
      -- A new width comes at any time: each pulse is a whole old one or a whole new one.
      before    := widths;
      widths(1) := random.integer_between(1, period - 1);
      wait_clocks(clock, random.integer_between(0, period));
      bus_write(clock, m2s, s2m, 3, widths(1));
      for clock_index in 1 to 3 * period loop
        wait_clocks(clock, 1);
        check(high_clocks(1) = before(1) or high_clocks(1) = widths(1), "a pulse of neither width");
        check_equal(period_clocks(1), period, "period while the width changes");
      end loop;
      expect_channel(1, widths(1), period, 0);
    end loop;

    -- Always high and never high.
    bus_write(clock, m2s, s2m, 1, 50);
    bus_write(clock, m2s, s2m, 2, 50);
    bus_write(clock, m2s, s2m, 3, 0);
    bus_write(clock, m2s, s2m, 4, 25);
    wait_clocks(clock, 700);
    count_high(0, 200, 200, "high clocks at a width of the whole period");
    count_high(1, 200, 0, "high clocks at a width of zero");
    count_high(2, 200, 100, "high clocks at half");

    -- Values beyond the counter's range become the longest possible, and a read gives this value.
    bus_write(clock, m2s, s2m, 2, x"FFFFFFFF");
    bus_expect(clock, m2s, s2m, 2, 2 ** counter_bits - 1);
    bus_write(clock, m2s, s2m, 1, x"00010000");
    bus_expect(clock, m2s, s2m, 1, 2 ** counter_bits - 1);

    -- Servo mode: microseconds at 50 Hz, within the limits; zero is no pulse.
    bus_write(clock, m2s, s2m, 2, 1500);
    bus_write(clock, m2s, s2m, 3, 10);
    bus_write(clock, m2s, s2m, 4, 60000);
    bus_write(clock, m2s, s2m, 0, servo);
    bus_expect(clock, m2s, s2m, 0, servo);
    wait_clocks(clock, clocks_of(20_000) * 5 / 2);
    expect_channel(0, clocks_of(1500), clocks_of(20_000), 1 + clocks_of(20_000) / 1000);
    expect_channel(1, clocks_of(500), clocks_of(20_000), 1 + clocks_of(20_000) / 1000);
    expect_channel(2, clocks_of(2500), clocks_of(20_000), 1 + clocks_of(20_000) / 1000);
    bus_write(clock, m2s, s2m, 2, 0);
    wait_clocks(clock, clocks_of(20_000));
    before := pulses;
    wait_clocks(clock, clocks_of(20_000));
    check_equal(pulses(0), before(0), "pulses of a limp servo");
    check(pulses(1) > before(1), "the others go on");

    bus_write(clock, m2s, s2m, 0, off);
    wait_clocks(clock, 3);
    count_high(1, 100, 0, "high after it was disabled");
    bus_refuse(clock, m2s, s2m, '0', 2 + channels, "a read beyond the channels");
    pulse(clock, reset);
    wait_clocks(clock, 1);
    bus_expect(clock, m2s, s2m, 2, 0);

    wait_clocks(clock, 2);
    report_passed("pwm_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 500000, "pwm_tb");

end architecture;
