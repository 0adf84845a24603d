-- SPDX-License-Identifier: BSD-3-Clause
--
-- pulse_counter: every pulse counts once, presets lose none, periods and stamps are those of the pulses, the timeout,
-- pause and gate, snapshots, the frequency, events.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_counter_tb is
  generic (
    data_width     : positive range 16 to 32 := 32;
    stable_clocks  : positive := 2; -- at 4 MHz
    time_hz        : positive := 800_000;
    timeout_ms     : positive := 1;
    with_gate      : natural  := 1;
    with_frequency : natural  := 0;
    seed           : positive := 1
  );
end entity;

architecture test of pulse_counter_tb is

  constant clock_period   : time     := 250 ns;
  constant clock_hz       : positive := 4_000_000;
  constant tick_clocks    : positive := clock_hz / time_hz;
  constant timeout_clocks : positive := timeout_ms * (clock_hz / 1000);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal line : std_ulogic := '0';
  signal gate : std_ulogic := '1';

  signal counted, stopped           : std_ulogic;
  signal pulses, stops              : natural := 0; -- events
  signal count_wire, frequency_wire : wire_t;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.pulse_counter
    generic map (
      clock_hz => clock_hz, data_width => data_width, filter_ns => 250 * stable_clocks, time_hz => time_hz,
      timeout_ms => timeout_ms, with_gate => with_gate, with_frequency => with_frequency,
      frequency_us => 200)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, counted => counted, stopped => stopped,
      count_wire => count_wire, frequency_wire => frequency_wire, line => line, gate => gate);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if counted = '1' then
        pulses <= pulses + 1;
      end if;
      if stopped = '1' then
        stops <= stops + 1;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random : random_t;
    variable count  : unsigned(data_width - 1 downto 0) := (others => '0');
    variable events : natural := 0; -- that must have come
    variable before : natural;
    variable clocks : natural;

    function as_word (value : unsigned) return std_ulogic_vector is
    begin
      return std_ulogic_vector(resize(value, 32));
    end function;

    procedure settle is
    begin
      wait_clocks(clock, stable_clocks + 40);
    end procedure;

    -- A pulse whose line is high for so many clocks.
    procedure beat (high : positive) is
    begin
      line <= '1';
      wait_clocks(clock, high);
      line <= '0';
    end procedure;

    procedure expect_count is
    begin
      settle;
      bus_expect(clock, m2s, s2m, 0, as_word(count));
      check(unsigned(value_of(count_wire)(count'range)) = count, "the wire has the count");
      check_equal(pulses, events, "each pulse has its event");
    end procedure;

    procedure read (address : natural; value : out natural; keep : boolean := false) is
      variable got : bus_answer_t;
    begin
      bus_read(clock, m2s, s2m, address, got, keep => keep);
      check(not got.refused, "a read");
      value := to_integer(unsigned(got.word));
    end procedure;

    -- A length in clocks shows as ticks, one more or less.
    procedure expect_ticks (got : natural; clocks : natural; what : string) is
    begin
      check(abs (got * tick_clocks - clocks) <= tick_clocks,
            what & ": " & integer'image(got) & " ticks are not " & integer'image(clocks) & " clocks");
    end procedure;

    variable first, second, period : natural;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    expect_count;
    bus_expect(clock, m2s, s2m, 3, 0);

    -- Bursts, as fast as the filter allows, and presets between them.
    for burst in 1 to 40 loop
      for pulse in 1 to random.integer_between(1, 30) loop
        beat(stable_clocks + random.integer_between(0, 2));
        wait_clocks(clock, stable_clocks + random.integer_between(0, 3));
        count  := count + 1;
        events := events + 1;
      end loop;
      if burst mod 4 = 0 then
        settle;
        count := to_unsigned(random.integer_between(0, 60_000), data_width);
        if burst mod 8 = 0 then
          count := not count;
        end if;
        bus_write(clock, m2s, s2m, 0, as_word(count));
      elsif burst mod 4 = 1 and stable_clocks > 1 then
        beat(stable_clocks - 1); -- a spike is no pulse
      end if;
      expect_count;
    end loop;

    -- A preset meets a pulse at every distance: the pulse counts before it or after it, and is never lost.
    for distance in 0 to stable_clocks + 24 loop
      settle;
      line <= '1';
      wait_clocks(clock, distance);
      bus_write(clock, m2s, s2m, 0, 100);
      settle;
      line <= '0';
      read(0, first);
      check(first = 100 or first = 101, "a preset that met a pulse gave " & integer'image(first));
      check((distance > 0 or first = 100 or first = 101) and (distance < stable_clocks + 20 or first = 100),
            "which of both came first");
      count  := to_unsigned(first, data_width);
      events := events + 1;
      expect_count;
    end loop;

    -- Periods and stamps, also of two pulses in a round.
    for number in 0 to 30 loop
      clocks := 2 * stable_clocks + 3 * number * number;
      beat(stable_clocks);
      settle;
      read(2, first);
      wait_clocks(clock, 50);
      beat(stable_clocks);
      wait_clocks(clock, clocks - stable_clocks);
      beat(stable_clocks);
      count  := count + 3;
      events := events + 3;
      settle;
      read(3, period, keep => true);
      read(2, second, keep => true);
      bus_expect(clock, m2s, s2m, 0, as_word(count));
      expect_ticks(period, clocks, "the period");
      check(second > first + clocks / tick_clocks, "the stamp is of the last pulse");
    end loop;

    -- No pulse for the timeout: no period, and one event. It needs two pulses again.
    before := stops;
    wait_clocks(clock, timeout_clocks - 200);
    read(3, period);
    check(period /= 0 and stops = before, "before the timeout the period stands");
    wait_clocks(clock, timeout_clocks / 32 + 300);
    bus_expect(clock, m2s, s2m, 3, 0);
    check_equal(stops, before + 1, "it stops");
    wait_clocks(clock, timeout_clocks);
    check_equal(stops, before + 1, "it stops once");
    beat(stable_clocks);
    settle;
    bus_expect(clock, m2s, s2m, 3, 0);
    wait_clocks(clock, 400);
    beat(stable_clocks);
    settle;
    read(3, period);
    check(period /= 0, "two pulses have a period");
    count  := count + 2;
    events := events + 2;

    -- A pause hides pulses, and what comes after it has no old period.
    bus_write(clock, m2s, s2m, 1, 1);
    settle;
    bus_expect(clock, m2s, s2m, 1, 1);
    bus_expect(clock, m2s, s2m, 3, 0);
    beat(stable_clocks);
    settle;
    bus_write(clock, m2s, s2m, 1, 0);
    settle;
    beat(stable_clocks);
    settle;
    bus_expect(clock, m2s, s2m, 3, 0);
    count  := count + 1;
    events := events + 1;
    expect_count;

    -- So does the gate, if there is one.
    gate <= '0';
    settle;
    beat(stable_clocks);
    settle;
    gate <= '1';
    settle;
    if with_gate = 0 then
      count  := count + 1;
      events := events + 1;
    end if;
    expect_count;

    -- It wraps at the word, and a block is of one moment.
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"FFFFFFFF"));
    settle;
    beat(stable_clocks);
    settle;
    bus_expect(clock, m2s, s2m, 0, 0, keep => true);
    beat(stable_clocks);
    settle;
    bus_expect(clock, m2s, s2m, 0, 0);
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 0, 1);

    -- 10 kHz, then silence.
    if with_frequency = 1 then
      for pulse in 1 to 12 loop
        beat(200);
        wait_clocks(clock, 200);
      end loop;
      bus_expect(clock, m2s, s2m, 6, 10_000 * 256);
      check(value_of(frequency_wire) = 10_000 * 256, "the wire has the frequency");
      wait_clocks(clock, timeout_clocks / 2);
      read(6, first);
      check(first > 0 and first < 4000 * 256, "the frequency falls while nothing comes");
      wait_clocks(clock, timeout_clocks);
      bus_expect(clock, m2s, s2m, 6, 0);
    else
      bus_refuse(clock, m2s, s2m, '0', 6, "a read of +6");
    end if;

    bus_refuse(clock, m2s, s2m, '1', 2, "a write of the stamp");
    bus_refuse(clock, m2s, s2m, '0', 4, "a read of +4");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read of +8");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "0111");

    -- A reset with the line high is no pulse.
    line  <= '1';
    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    settle;
    for address in 0 to 3 loop
      bus_expect(clock, m2s, s2m, address, 0);
    end loop;

    -- Behind a reset within a block whose words had thawed, they stand again.
    line <= '0';
    settle;
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"00000005"), keep => true);
    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    settle;
    bus_expect(clock, m2s, s2m, 0, 0, keep => true);
    beat(stable_clocks);
    settle;
    bus_expect(clock, m2s, s2m, 0, 0);
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 0, 1);

    wait_clocks(clock, 2);
    report_passed("pulse_counter_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 600_000, "pulse_counter_tb");

end architecture;
