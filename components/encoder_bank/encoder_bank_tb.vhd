-- SPDX-License-Identifier: BSD-3-Clause
--
-- encoder_bank with a random walk on each channel, all at once: every step is counted, presets lose no step, impossible
-- steps, spikes, snapshots, the event.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity encoder_bank_tb is
  generic (
    channels   : positive := 6;
    data_width : positive := 32;
    filter_ns  : natural  := 0;
    seed       : positive := 1
  );
end entity;

architecture test of encoder_bank_tb is

  constant clock_period : time := 20 ns;

  -- What the page says of the sample time, for 50 MHz. 6 channels take the time of 8.
  pure function round_clocks return positive is
    variable found : positive := 4;
  begin
    while found < 2 * channels loop
      found := 2 * found;
    end loop;
    return found;
  end function;

  constant round  : positive := round_clocks;
  constant sample : positive := maximum(1, (filter_ns / 20 + round - 1) / round) * round; -- clocks

  type positions_t is array (0 to channels - 1) of integer;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal a, b     : std_ulogic_vector(channels - 1 downto 0) := (others => '0');
  signal failed   : std_ulogic;
  signal failures : natural := 0; -- events

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.encoder_bank
    generic map (channels => channels, filter_ns => filter_ns, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, failed => failed, a => a, b => b);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if failed = '1' then
        failures <= failures + 1;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random    : random_t;
    variable answer    : bus_answer_t;
    variable positions : positions_t := (others => 0);
    variable quarters  : positions_t := (others => 0);
    variable wrong     : positions_t := (others => 0);
    variable told      : natural     := 0; -- events that must have come
    variable picked    : natural;

    function as_word (value : integer) return std_ulogic_vector is
    begin
      return std_ulogic_vector(resize(unsigned(to_signed(value, 32)(data_width - 1 downto 0)), 32));
    end function;

    procedure turn (channel : natural; by : integer) is
    begin
      quarters(channel) := (quarters(channel) + by) mod 4;
      a(channel) <= '1' when quarters(channel) = 1 or quarters(channel) = 2 else '0';
      b(channel) <= '1' when quarters(channel) >= 2 else '0';
    end procedure;

    procedure step (channel : natural; by : integer) is
    begin
      turn(channel, by);
      positions(channel) := positions(channel) + by;
    end procedure;

    procedure settle is
    begin
      wait_clocks(clock, 2 * sample + 2 * round + 4);
    end procedure;

    procedure expect_all is
    begin
      settle;
      for channel in 0 to channels - 1 loop
        bus_expect(clock, m2s, s2m, channel, as_word(positions(channel)));
        bus_expect(clock, m2s, s2m, channels + channel, std_ulogic_vector(to_unsigned(wrong(channel) mod 4096, 32)));
      end loop;
      check_equal(failures, told, "events of impossible steps");
    end procedure;

  begin
    random.seed(seed);
    -- A level that is high from the begin is no step.
    turn(channels - 1, 1);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    expect_all;

    -- Random walks, a step in each sample time and a clock.
    for walk in 1 to 12 loop
      for count in 1 to random.integer_between(1, 40) loop
        for channel in 0 to channels - 1 loop
          if random.chance(50 + 40 * ((walk + channel) mod 2)) then
            step(channel, 1);
          elsif random.chance(80) then
            step(channel, -1);
          end if;
        end loop;
        -- Each level must last for two samples, also where the way turns back.
        wait for clock_period * ((2 * sample + 1) * 1000 + random.integer_between(10, 3000)) / 1000;
      end loop;
      expect_all;

      -- Runs one way, a step in each sample time.
      picked := random.integer_between(0, channels - 1);
      for count in 1 to 30 loop
        step(picked, 1 - 2 * (walk mod 2));
        wait for clock_period * (sample * 1000 + random.integer_between(1010, 2000)) / 1000;
      end loop;
      expect_all;

      picked := random.integer_between(0, channels - 1);
      case random.integer_between(0, 3) is
        when 0 =>
          turn(picked, 2);
          settle;
          wrong(picked) := wrong(picked) + 1;
          told          := told + 1;
        when 1 =>
          wrong(picked) := random.integer_between(0, 4095);
          bus_write(clock, m2s, s2m, channels + picked, as_word(wrong(picked) + 2 ** 12));
        when 2 =>
          positions(picked) := random.integer_between(-2 ** (data_width - 2), 2 ** (data_width - 2) - 1);
          bus_write(clock, m2s, s2m, picked, as_word(positions(picked)));
        when 3 =>
          -- A spike that is shorter than the sample time is not a step.
          for shift in 0 to sample - 1 loop
            a(picked) <= not a(picked);
            wait_clocks(clock, sample - 1);
            a(picked) <= not a(picked);
            wait_clocks(clock, 2 * sample + 2);
          end loop;
        when others =>
          null;
      end case;
      expect_all;
    end loop;

    -- The number of impossible steps wraps.
    bus_write(clock, m2s, s2m, channels, as_word(4095));
    wrong(0) := 4096;
    turn(0, 2);
    told := told + 1;
    expect_all;

    -- A preset meets a step, at every distance: the step counts before the preset or after it, but is never lost.
    for channel in 0 to channels - 1 loop
      for distance in 0 to 2 * sample + round + 4 loop
        exit when channel mod 5 /= 1 and channel /= channels - 1; -- some channels, among them the last one
        bus_write(clock, m2s, s2m, channel, as_word(0));
        settle;
        turn(channel, 1);
        wait_clocks(clock, distance);
        bus_write(clock, m2s, s2m, channel, as_word(100));
        bus_read(clock, m2s, s2m, channel, answer);
        check(answer.word = as_word(100) or answer.word = as_word(101), "the written word can be read");
        settle;
        bus_read(clock, m2s, s2m, channel, answer);
        check(answer.word = as_word(100) or answer.word = as_word(101),
              "a preset that met a step gave x" & to_hstring(answer.word));
        check((distance > 0 or answer.word = as_word(101)) and
              (distance < 2 * sample + round + 4 or answer.word = as_word(100)), "which of both came first");
        positions(channel) := to_integer(signed(answer.word(data_width - 1 downto 0)));
      end loop;
    end loop;
    expect_all;

    -- It wraps at the word.
    bus_write(clock, m2s, s2m, 1, as_word(2 ** (data_width - 2) + (2 ** (data_width - 2) - 1)));
    turn(1, 1);
    settle;
    bus_expect(clock, m2s, s2m, 1, std_ulogic_vector(shift_left(to_unsigned(1, 32), data_width - 1)));

    -- In a block, reads give the positions of the moment when cyc rose. A write thaws them.
    bus_write(clock, m2s, s2m, 0, as_word(7));
    bus_write(clock, m2s, s2m, 1, as_word(70));
    settle;
    bus_expect(clock, m2s, s2m, channels, as_word(wrong(0) mod 4096), keep => true);
    turn(0, 1);
    turn(1, -1);
    settle;
    bus_expect(clock, m2s, s2m, 0, as_word(7), keep => true);
    bus_expect(clock, m2s, s2m, 1, as_word(70), keep => true);
    bus_write(clock, m2s, s2m, channels + 1, as_word(wrong(1)), keep => true);
    bus_expect(clock, m2s, s2m, 0, as_word(8), keep => true);
    bus_expect(clock, m2s, s2m, 1, as_word(69));

    bus_refuse(clock, m2s, s2m, '0', 2 * channels, "a read behind the last word");
    bus_refuse(clock, m2s, s2m, '1', 2 * channels, "a write behind the last word");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "0111");

    -- A reset with high levels is not a step.
    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    positions := (others => 0);
    wrong     := (others => 0);
    expect_all;

    wait_clocks(clock, 2);
    report_passed("encoder_bank_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 400000, "encoder_bank_tb");

end architecture;
