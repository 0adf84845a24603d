-- SPDX-License-Identifier: BSD-3-Clause
--
-- quadrature_encoder on a random walk: every step is counted, presets lose no step, index, impossible steps, snapshots,
-- time stamps, events.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity quadrature_encoder_tb is
  generic (
    data_width    : positive range 8 to 32 := 32;
    stable_clocks : positive := 2; -- at 50 MHz
    with_index    : natural  := 1;
    with_stamps   : natural  := 1;
    seed          : positive := 1
  );
end entity;

architecture test of quadrature_encoder_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal a, b, index : std_ulogic := '0';

  signal indexed, failed   : std_ulogic;
  signal indices, failures : natural := 0; -- events

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.quadrature_encoder
    generic map (
      data_width => data_width, filter_ns => 20 * stable_clocks, with_index => with_index, with_stamps => with_stamps)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, indexed => indexed, failed => failed,
      a => a, b => b, index => index);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if indexed = '1' then
        indices <= indices + 1;
      end if;
      if failed = '1' then
        failures <= failures + 1;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random  : random_t;
    variable answer : bus_answer_t;

    variable quarter  : natural range 0 to 3 := 0; -- of a period
    variable position : integer := 0;
    variable indexed_position : integer := 0;
    variable turns    : natural := 0;
    variable wrong    : natural := 0;
    variable events   : natural := 0; -- that must have come: an index
    variable told     : natural := 0; -- that must have come: an impossible step
    variable first    : unsigned(data_width - 1 downto 0); -- a stamp

    function as_word (value : integer) return std_ulogic_vector is
    begin
      return std_ulogic_vector(resize(unsigned(to_signed(value, 32)(data_width - 1 downto 0)), 32));
    end function;

    procedure step (by : integer) is
    begin
      quarter := (quarter + by) mod 4;
      a <= '1' when quarter = 1 or quarter = 2 else '0';
      b <= '1' when quarter >= 2 else '0';
    end procedure;

    procedure settle is
    begin
      wait_clocks(clock, stable_clocks + 40);
    end procedure;

    procedure expect_all is
    begin
      settle;
      bus_expect(clock, m2s, s2m, 0, as_word(position));
      bus_expect(clock, m2s, s2m, 1, as_word(indexed_position));
      bus_expect(clock, m2s, s2m, 2, as_word(turns));
      bus_expect(clock, m2s, s2m, 3, as_word(wrong));
      check(indices = events and failures = told, "each event comes once");
    end procedure;

    procedure expect_index (at : integer) is
    begin
      if with_index = 1 then
        indexed_position := at;
        turns            := turns + 1;
        events           := events + 1;
      end if;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    expect_all;

    -- A random walk, as fast as the filter allows, with edges anywhere in a clock.
    for walk in 1 to 60 loop
      for count in 1 to random.integer_between(1, 30) loop
        if random.chance(50 + 40 * (walk mod 2)) then
          step(1);
          position := position + 1;
        else
          step(-1);
          position := position - 1;
        end if;
        wait for clock_period * (stable_clocks * 1000 + random.integer_between(1010, 3000)) / 1000;
      end loop;
      case random.integer_between(0, 5) is
        when 0 =>
          settle;
          index <= '1';
          settle;
          index <= '0';
          expect_index(position);
        when 1 =>
          settle;
          position := random.integer_between(-2 ** (data_width - 2), 2 ** (data_width - 2) - 1);
          bus_write(clock, m2s, s2m, 0, as_word(position));
        when 2 =>
          settle;
          step(2);
          wrong := wrong + 1;
          told  := told + 1;
        when 3 =>
          wrong := random.integer_between(0, 5);
          bus_write(clock, m2s, s2m, 3, as_word(wrong));
        when 4 =>
          -- A spike shorter than the filter is not a step.
          settle;
          if stable_clocks > 1 then
            wait until rising_edge(clock);
            a <= not a;
            wait until rising_edge(clock);
            a <= not a;
          end if;
        when others =>
          null;
      end case;
      expect_all;
    end loop;

    -- A preset meets a step, at every distance: the step counts before the preset or after it, but is never lost.
    for distance in 0 to stable_clocks + 24 loop
      settle;
      bus_write(clock, m2s, s2m, 0, as_word(0));
      settle;
      step(1);
      wait_clocks(clock, distance);
      bus_write(clock, m2s, s2m, 0, as_word(100));
      settle;
      bus_read(clock, m2s, s2m, 0, answer);
      check(answer.word = as_word(100) or answer.word = as_word(101),
            "a preset that met a step gave x" & to_hstring(answer.word));
      check((distance > 0 or answer.word = as_word(101)) and
            (distance < stable_clocks + 20 or answer.word = as_word(100)),
            "which of both came first");
    end loop;

    -- An index between two steps latches the position between them, at each place of a round. So does one in the clock
    -- of a step, and one that meets a preset.
    for distance in 0 to 40 loop
      position := 1000;
      bus_write(clock, m2s, s2m, 0, as_word(position));
      wait_clocks(clock, distance);
      step(1);
      wait_clocks(clock, (distance mod 3) * stable_clocks);
      index <= '1';
      wait_clocks(clock, stable_clocks + 1);
      step(1);
      position := position + 2;
      expect_index(position - 1);
      expect_all;
      index <= '0';
      settle;

      index <= '1';
      wait_clocks(clock, distance);
      bus_write(clock, m2s, s2m, 0, as_word(-7));
      if with_index = 1 then
        settle;
        bus_read(clock, m2s, s2m, 1, answer);
        check(answer.word = as_word(position) or answer.word = as_word(-7), "an index meets a preset");
        check(distance < stable_clocks + 20 or answer.word = as_word(position), "the index came first");
        expect_index(position);
        if answer.word = as_word(-7) then
          indexed_position := -7;
        end if;
      end if;
      index <= '0';
      position := -7;
      settle;
    end loop;
    expect_all;

    -- The stamps of two steps are as far apart as the steps.
    if with_stamps = 1 then
      for apart in stable_clocks + 1 to stable_clocks + 40 loop
        step(1);
        wait_clocks(clock, apart + 60);
        bus_read(clock, m2s, s2m, 4, answer);
        first := unsigned(answer.word(first'range));
        wait_clocks(clock, 70 - apart);
        wait until rising_edge(clock);
        step(1);
        wait_clocks(clock, apart);
        step(-1);
        settle;
        bus_read(clock, m2s, s2m, 4, answer);
        check(unsigned(answer.word(first'range)) - first > apart + 60, "the stamp is of the last step");
        first := unsigned(answer.word(first'range));
        step(1);
        index <= '1';
        settle;
        bus_read(clock, m2s, s2m, 5, answer);
        check(with_index = 0 or unsigned(answer.word(first'range)) - first = 42 + stable_clocks,
              "the index has its own stamp: " & to_string(to_integer(unsigned(answer.word(first'range)) - first)));
        expect_index(position + 2);
        position := position + 2;
        index <= '0';
        settle;
      end loop;
    end if;

    -- It wraps at the word.
    bus_write(clock, m2s, s2m, 0, as_word(2 ** (data_width - 2) + (2 ** (data_width - 2) - 1)));
    settle;
    step(1);
    settle;
    bus_expect(clock, m2s, s2m, 0, std_ulogic_vector(shift_left(to_unsigned(1, 32), data_width - 1)));

    -- In a block, reads give the position of the moment when cyc rose.
    bus_write(clock, m2s, s2m, 0, as_word(7));
    settle;
    bus_expect(clock, m2s, s2m, 3, as_word(wrong), keep => true);
    step(1);
    settle;
    bus_expect(clock, m2s, s2m, 0, as_word(7), keep => true);
    bus_expect(clock, m2s, s2m, 0, as_word(7));
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 0, as_word(8));

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the index position");
    bus_refuse(clock, m2s, s2m, '0', 6, "a read of +6");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read of +8");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "0111");

    -- A reset with the signals high is not a step.
    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    settle;
    position := 0;
    indexed_position := 0;
    turns    := 0;
    wrong    := 0;
    expect_all;

    wait_clocks(clock, 2);
    report_passed("quadrature_encoder_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "quadrature_encoder_tb");

end architecture;
