-- SPDX-License-Identifier: BSD-3-Clause
--
-- pulse_generator: every pulse comes in the clock that the frequency says, and has its width to the clock; bursts and
-- triggers give as many pulses as they say, the stop and the safe value.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_generator_tb is
  generic (
    clock_hz     : positive := 4_700_000;
    maximum_hz   : positive := 1_000_000;
    time_hz      : positive := 1_000_000;
    active_level : natural  := 1;
    data_width   : positive range 16 to 32 := 32;
    seed         : positive := 1
  );
end entity;

architecture test of pulse_generator_tb is

  constant clock_period : time := 100 ns; -- all is counted in clocks
  constant filter       : positive := 1;  -- of the pins, in clocks

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal trigger, stop        : std_ulogic := '0';
  signal line, begun, finished : std_ulogic;
  signal active               : std_ulogic;

  signal now_clock   : natural := 0;
  signal begins      : natural := 0;  -- pulses that have begun
  signal ends        : natural := 0;
  signal finishes    : natural := 0;  -- events
  signal began_at    : natural := 0;
  signal before_that : natural := 0;  -- when the pulse before had begun
  signal lasted      : natural := 0;  -- clocks of the last pulse

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.pulse_generator
    generic map (
      clock_hz => clock_hz, maximum_hz => maximum_hz, time_hz => time_hz, active_level => active_level, filter_ns => 0,
      data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, begun => begun, finished => finished,
      trigger => trigger, stop => stop, line => line);

  active <= line when active_level = 1 else not line;

  -- What is on the line, clock by clock.
  observe : process (clock) is
    variable was : std_ulogic := '0';
  begin
    if rising_edge(clock) then
      now_clock <= now_clock + 1;
      check_equal(begun, active and not was, "begun comes with the pulse");
      if active = '1' and was = '0' then
        begins      <= begins + 1;
        began_at    <= now_clock;
        before_that <= began_at;
      elsif active = '0' and was = '1' then
        ends   <= ends + 1;
        lasted <= now_clock - began_at;
      end if;
      if finished = '1' then
        finishes <= finishes + 1;
        check(active = '0' and was = '1', "finished comes with the end of a pulse");
      end if;
      was := active;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random : random_t;

    -- Clocks until so many halves of a period are over.
    function halves (count : natural; frequency : positive) return natural is
    begin
      return integer(ceil(real(count) * 128.0 * real(clock_hz) / real(frequency)));
    end function;

    function clocks_of (width : positive) return positive is
    begin
      return integer(ceil(real(width) * real(clock_hz) / real(time_hz)));
    end function;

    procedure put (address : natural; value : natural) is
    begin
      bus_write(clock, m2s, s2m, address, value);
    end procedure;

    procedure expect (address : natural; value : natural) is
    begin
      bus_expect(clock, m2s, s2m, address, value);
    end procedure;

    procedure await_begin is
    begin
      wait on begins for 20_000 * clock_period;
      check(begins'event, "a pulse begins");
    end procedure;

    procedure await_end is
    begin
      if active = '1' or begins /= ends then
        wait on ends for 20_000 * clock_period;
      end if;
      check(begins = ends, "a pulse ends");
    end procedure;

    -- No pulse comes any more.
    procedure expect_rest (clocks : positive; what : string) is
      constant before : natural := begins;
    begin
      wait_clocks(clock, clocks);
      check_equal(begins, before, what & ": no pulse comes");
      check(active = '0', what & ": the line rests");
    end procedure;

    procedure go_off is
    begin
      put(0, 0);
      wait_clocks(clock, 4);
      await_end;
    end procedure;

    variable frequency, width, first, before, number, finishes_before : natural;
    variable answer : bus_answer_t;

  begin
    random.seed(seed);
    wait_clocks(clock, 1);
    check(active = '0', "the line rests from power-up on");
    wait_clocks(clock, 5);
    reset <= '0';
    wait_clocks(clock, 2);
    for address in 0 to 5 loop
      expect(address, 0);
    end loop;
    expect_rest(50, "after the reset");

    -- Steady pulses of half a period: each edge in its clock.
    for round in 1 to 12 loop
      frequency := random.integer_between(maximum_hz, 256 * maximum_hz);
      if round = 1 then
        frequency := 256 * maximum_hz;
      end if;
      put(0, frequency);
      await_begin;
      first  := began_at;
      before := begins;
      for count in 1 to 60 loop
        wait on ends;
        check_equal(began_at + lasted - first, halves(2 * count - 1, frequency), "the end of a pulse");
        wait on begins;
        check_equal(began_at - first, halves(2 * count, frequency), "the begin of a pulse");
      end loop;
      go_off;
      check(begins <= before + 61, "a frequency of 0 ends it behind the pulse");
      expect_rest(500, "a frequency of 0");
    end loop;
    bus_read(clock, m2s, s2m, 4, answer);
    check_equal(to_integer(unsigned(answer.word)), begins, "the number of pulses");

    -- Widths, exact to the clock. A new one waits for the next pulse, and a frequency of 0 cuts none.
    for round in 1 to 40 loop
      width := random.integer_between(1, 60);
      put(1, width);
      put(0, 256 * maximum_hz / 200);
      await_begin;
      if round mod 2 = 0 then
        put(1, width + 7);
      end if;
      if round mod 3 = 0 then
        put(0, 0);
      end if;
      await_end;
      check_equal(lasted, clocks_of(width), "the width of a pulse");
      if round mod 3 /= 0 then
        await_begin;
        check_equal(began_at - before_that, halves(2, 256 * maximum_hz / 200), "the period");
      end if;
      go_off;
      expect_rest(halves(3, 256 * maximum_hz / 200), "off");
    end loop;

    -- A new frequency is in force in the midst of a period.
    put(1, 2);
    put(0, 256 * maximum_hz / 1000);
    await_begin;
    put(0, 256 * maximum_hz / 20);
    await_begin;
    check(began_at - before_that <= halves(2, 256 * maximum_hz / 20) + 8, "a new frequency does not wait");
    put(0, 256 * maximum_hz / 1000);
    await_begin;
    check(began_at - before_that > halves(2, 256 * maximum_hz / 1000) / 10 * 9, "nor does a lower one");
    go_off;

    -- Pulses that are as long as their period, or longer: some are left out, and none is cut.
    put(0, 256 * maximum_hz / 20);
    await_begin;
    await_end;
    expect(5, 16#100#);
    width := integer(floor(real(halves(4, 256 * maximum_hz / 20)) * real(time_hz) / real(clock_hz))) + 1;
    put(1, width);
    await_begin;
    await_begin;
    check_equal(lasted, clocks_of(width), "a long pulse is not cut");
    check_equal(began_at - before_that, halves(6, 256 * maximum_hz / 20), "two of three are left out");
    expect(5, 16#102#);
    go_off;
    put(1, 3);

    -- Bursts of any length.
    put(2, 4);
    put(0, 256 * maximum_hz / 20);
    expect_rest(500, "no burst has begun");
    for round in 1 to 10 loop
      before          := begins;
      finishes_before := finishes;
      number          := random.integer_between(1, 12);
      put(3, number);
      wait until finishes /= finishes_before for (number + 2) * halves(2, 256 * maximum_hz / 20) * clock_period;
      check_equal(begins - before, number, "the pulses of a burst");
      check_equal(finishes - finishes_before, 1, "finished comes");
      expect_rest(500, "a burst is over");
      expect(3, 0);
      check_equal(finishes - finishes_before, 1, "finished comes once");
    end loop;

    -- A burst that is changed while it runs, and one that is ended.
    before := begins;
    put(3, 100);
    for pulse in 1 to 3 loop
      await_begin;
    end loop;
    bus_read(clock, m2s, s2m, 3, answer);
    check_equal(to_integer(unsigned(answer.word)), 97, "what is to go");
    put(3, 2);
    await_begin;
    await_begin;
    await_end;
    expect_rest(500, "the burst has a new length");
    check_equal(begins - before, 5, "the pulses that had begun count");
    put(3, 100);
    await_begin;
    put(3, 0);
    await_end;
    check_equal(lasted, clocks_of(3), "an end of the burst cuts no pulse");
    expect_rest(500, "the burst has been ended");

    -- A frequency of 0 ends the burst, too: the next frequency begins nothing.
    put(3, 100);
    await_begin;
    go_off;
    expect(3, 0);
    put(0, 256 * maximum_hz / 20);
    expect_rest(500, "the burst is not resumed");

    -- But a burst can be made ready.
    put(0, 0);
    put(3, 2);
    expect_rest(500, "without a frequency");
    before := begins;
    put(0, 256 * maximum_hz / 20);
    await_begin;
    await_begin;
    await_end;
    expect_rest(500, "the burst is over");

    -- A trigger gives a burst. One that comes within a burst is ignored, one in its last period keeps the distance.
    before  := begins;
    first   := now_clock + 1;
    trigger <= '1';
    await_begin;
    check_equal(began_at - first, 5 + filter, "clocks from the trigger to the pulse");
    trigger <= '0';
    wait_clocks(clock, 10);
    trigger <= '1';
    for pulse in 2 to 4 loop
      await_begin;
    end loop;
    trigger <= '0';
    await_end;
    check_equal(begins - before, 4, "a trigger gives a burst");
    wait_clocks(clock, 4);
    trigger <= '1';
    await_begin;
    check_equal(began_at - before_that, halves(2, 256 * maximum_hz / 20), "two bursts keep the distance of a period");
    trigger <= '0';
    for pulse in 2 to 4 loop
      await_begin;
    end loop;
    await_end;
    expect_rest(500, "the level of the trigger is no edge");

    -- A stop cuts the pulse, and ends the burst. A frequency starts again, but not while it is there.
    put(1, 5000);
    trigger <= '1';
    await_begin;
    wait_clocks(clock, 30);
    check(active = '1', "a long pulse");
    stop  <= '1';
    first := now_clock + 1;
    wait on ends;
    check_equal(began_at + lasted - first, 3 + filter, "clocks from the stop to the rest");
    expect(5, 16#202#);
    expect(3, 0);
    put(0, 256 * maximum_hz / 20);
    put(2, 0);
    expect_rest(500, "while it is stopped");
    stop <= '0';
    expect_rest(500, "the stop is gone");
    trigger <= '0';
    wait_clocks(clock, 10);
    trigger <= '1';
    expect_rest(500, "a trigger does not start again");
    put(1, 1);
    put(0, 256 * maximum_hz / 20);
    await_begin;
    await_end;
    check_equal(lasted, clocks_of(1), "a short pulse");
    go_off;
    put(2, 1);
    trigger <= '0';
    wait_clocks(clock, 10);
    trigger <= '1';
    wait_clocks(clock, 10);
    expect(3, 0);
    put(0, 256);
    expect_rest(500, "a trigger without a frequency");

    -- Refused.
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector(to_unsigned(256 * maximum_hz + 1, 32)), answer);
    check(answer.refused, "a frequency that is too high is refused");
    expect(0, 256);
    bus_refuse(clock, m2s, s2m, '1', 4, "a write of the pulses");
    bus_refuse(clock, m2s, s2m, '1', 5, "a write of the state");
    bus_refuse(clock, m2s, s2m, '0', 6, "a read of +6");

    -- A reset ends all.
    put(2, 0);
    put(1, 1000);
    put(0, 256 * maximum_hz / 20);
    await_begin;
    reset <= '1';
    wait_clocks(clock, 2);
    check(active = '0', "the line rests after a reset");
    reset <= '0';
    wait_clocks(clock, 2);
    for address in 0 to 5 loop
      expect(address, 0);
    end loop;
    expect_rest(500, "after a reset");

    report_passed("pulse_generator_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 2_000_000, "pulse_generator_tb");

end architecture;
