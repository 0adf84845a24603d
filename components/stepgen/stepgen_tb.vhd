-- SPDX-License-Identifier: BSD-3-Clause
--
-- stepgen with drivers that count and check its pins: moves that are checked against the equations of motion, targets,
-- speeds, accelerations and modes changed at any moment, limits, halts, latches, shifts, the wrap of a position, and
-- the safe state. A position is compared with the driver's count whenever an axis is at rest.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;
  use work.bench_pkg.all;
  use work.stepgen_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity stepgen_tb is
  generic (
    axes     : positive := 2;
    clock_hz : positive := 12_000_000;
    seed     : positive := 1;
    rounds   : natural  := 1
  );
end entity;

architecture test of stepgen_tb is

  constant clock_period : time := 1 sec / clock_hz;
  constant step_len     : natural := 300; -- in ns
  constant step_space   : natural := 3000;
  constant dir_setup    : natural := 700;
  constant dir_hold     : natural := 900;
  constant ramp_clocks  : positive := clock_hz / 2 ** ramp_bits + 1;
  constant speed_unit   : positive := 2 ** fraction_bits;
  constant acceleration_unit : positive := 64; -- step/s**2

  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal m2s     : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m     : wishbone_s2m_t;
  signal settled : std_ulogic;
  signal done    : boolean := false;

  signal step, direction             : std_ulogic_vector(axes - 1 downto 0);
  signal limit_low, limit_high, home : std_ulogic_vector(axes - 1 downto 0) := (others => '0');
  signal stop                        : std_ulogic := '0';

  type counts_t is array (0 to axes - 1) of integer;
  signal counts  : counts_t;
  signal clocks  : natural := 0; -- since the reset
  signal rests   : natural := 0; -- events so far

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.stepgen
    generic map (
      clock_hz => clock_hz, axes => axes, step_len_ns => step_len, step_space_ns => step_space,
      dir_setup_ns => dir_setup, dir_hold_ns => dir_hold, stable_clocks => 2)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, settled => settled,
      step => step, direction => direction, limit_low => limit_low, limit_high => limit_high, home => home,
      stop => stop);

  drivers : for number in 0 to axes - 1 generate
    driver : entity work.stepgen_driver_model
      generic map (
        step_len => step_len * 1 ns, step_space => step_space * 1 ns,
        dir_setup => dir_setup * 1 ns, dir_hold => dir_hold * 1 ns)
      port map (step => step(number), direction => direction(number), position => counts(number));
  end generate;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  watch : process (clock) is
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if reset = '1' then
        clocks <= 0;
      end if;
      if settled = '1' then
        rests <= rests + 1;
      end if;
    end if;
  end process;

  master : process is

    variable random  : random_t;
    variable offsets : counts_t := (others => 0); -- position minus count: what was shifted

    procedure put (axis : natural; word : word_index_t; value : integer) is
    begin
      bus_write(clock, m2s, s2m, axis * 16 + word, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    procedure get (axis : natural; word : word_index_t; value : out integer) is
      variable answer : bus_answer_t;
    begin
      bus_read(clock, m2s, s2m, axis * 16 + word, answer);
      check(not answer.refused, "a read was refused");
      value := to_integer(signed(answer.word));
    end procedure;

    procedure expect (axis : natural; word : word_index_t; value : integer; what : string) is
      variable got : integer;
    begin
      get(axis, word, got);
      check_equal(got, value, what & " of axis " & integer'image(axis));
    end procedure;

    procedure expect_status (axis : natural; bits : natural; value : std_ulogic; what : string) is
      variable got : integer;
    begin
      get(axis, word_status, got);
      check_equal(to_unsigned(got, 8)(bits), value, what & " of axis " & integer'image(axis));
    end procedure;

    procedure wait_rest (axis : natural; ticks_most : positive := 6000) is
      variable status : integer;
    begin
      wait_clocks(clock, 3 * ramp_clocks);
      for tick in 1 to ticks_most loop
        get(axis, word_status, status);
        exit when to_unsigned(status, 8)(status_moving) = '0';
        check(tick < ticks_most, "an axis does not come to rest");
        wait_clocks(clock, ramp_clocks);
      end loop;
      wait_clocks(clock, 2 * ramp_clocks);
    end procedure;

    procedure expect_count (axis : natural) is
    begin
      expect(axis, word_position, counts(axis) + offsets(axis), "the position");
    end procedure;

    -- A move from rest to rest takes the time of a trapezoid or a triangle. The end takes some ramp periods longer.
    procedure move (axis : natural; target, speed, acceleration : integer) is
      variable way, seconds, top : real;
      variable began : natural;
      variable velocity, before, from : integer;
    begin
      put(axis, word_speed, speed * speed_unit);
      put(axis, word_acceleration, acceleration / acceleration_unit);
      get(axis, word_position, from);
      way := abs (real(target) - real(from));
      top := real(speed);
      if way < top ** 2 / real(acceleration) then
        top := sqrt(way * real(acceleration));
      end if;
      seconds := way / top + top / real(acceleration);
      put(axis, word_target, target);
      put(axis, word_control, 1);
      began  := clocks;
      before := 0;
      loop
        get(axis, word_velocity, velocity);
        check(abs velocity <= speed * speed_unit, "a velocity beyond the speed limit");
        check(abs (velocity - before) <= 2 * (acceleration / acceleration_unit),
              "a velocity changed by " & integer'image(velocity - before));
        exit when velocity = 0 and before = 0 and clocks - began > 3 * ramp_clocks;
        check(real(clocks - began) < (seconds + 0.001) * 2.0 * real(clock_hz), "a move does not end");
        before := velocity;
        wait_clocks(clock, ramp_clocks - 20);
      end loop;
      expect(axis, word_position, target, "the end of a move");
      expect_status(axis, status_at_target, '1', "at target");
      expect_count(axis);
      check(abs (real(clocks - began) / real(clock_hz) - seconds) <
            (8.0 + 2.0 * log(maximum(1.0, top * 2.0 ** ramp_bits / real(acceleration)))) / 2.0 ** ramp_bits,
            "a move took " & real'image(real(clocks - began) / real(clock_hz)) & " s, not " & real'image(seconds));
    end procedure;

    variable got, first, second : integer;
    variable was                : counts_t;

  begin
    random.seed(seed);
    wait_clocks(clock, 5);
    reset <= '0';

    -- After the reset all words are zero, and nothing moves.
    wait_clocks(clock, 300);
    for axis in 0 to axes - 1 loop
      for word in 0 to word_shift loop
        expect(axis, word, 0, "word " & integer'image(word) & " after the reset");
      end loop;
    end loop;
    bus_refuse(clock, m2s, s2m, '0', 11, "a read of +11");
    bus_refuse(clock, m2s, s2m, '0', axes * 16, "a read of an axis that is not there");
    bus_refuse(clock, m2s, s2m, '1', word_position, "a write of the position");
    bus_refuse(clock, m2s, s2m, '1', word_acceleration, "an acceleration of zero", x"FFF00000");
    bus_refuse(clock, m2s, s2m, '1', word_target, "a write of half a word", x"00000001", "0011");
    put(0, word_speed, -1);
    expect(0, word_speed, 2 ** speed_bits - 1, "the bits of the speed limit");

    -- Moves: a trapezoid, one that is shorter than its ramps, single steps, and there and back.
    move(0, 200, 80_000, 64_000_000);
    move(0, 140, 200_000, 64_000_000);
    move(0, 141, 200_000, 32_000_000);
    move(0, 120, 50_000, 16_000_000);
    move(axes - 1, -60, 50_000, 64_000_000);
    check(rests >= 5, "an event for each rest");

    -- The rate of a velocity is exact. A target velocity beyond the speed limit gives the speed limit.
    put(0, word_speed, 100_000 * speed_unit);
    put(0, word_acceleration, 64_000_000 / acceleration_unit);
    put(0, word_velocity_target, 33_333 * speed_unit + 85);
    put(0, word_control, 3);
    wait_clocks(clock, 15 * ramp_clocks);
    expect(0, word_velocity, 33_333 * speed_unit + 85, "a velocity");
    first := counts(0);
    wait_clocks(clock, clock_hz / 400);
    check(abs (counts(0) - first - 83) <= 1, "the rate: " & integer'image(counts(0) - first) & " steps in 2.5 ms");
    put(0, word_velocity_target, -integer'high);
    wait_clocks(clock, 40 * ramp_clocks);
    expect(0, word_velocity, -100_000 * speed_unit, "a limited velocity");

    -- The safe value of the control word: the axis brakes as its acceleration says, and stays at rest.
    put(0, word_control, 0);
    wait_rest(0);
    expect_count(0);
    was := counts;
    wait_clocks(clock, 10 * ramp_clocks);
    check(was = counts, "a disabled axis moved");

    -- Anything may change at any moment. No step is lost or doubled, and the axis ends at its target.
    for round in 1 to rounds loop
      for change in 1 to random.integer_between(2, 8) loop
        for axis in 0 to axes - 1 loop
          case random.integer_between(0, 6) is
            when 0 | 1 =>
              put(axis, word_target, counts(axis) + offsets(axis) + random.integer_between(-500, 500));
            when 2 =>
              put(axis, word_speed, random.integer_between(1, 250_000) * speed_unit);
            when 3 =>
              put(axis, word_acceleration, random.integer_between(100_000, 1_000_000));
            when 4 =>
              put(axis, word_velocity_target, random.integer_between(-200_000, 200_000) * speed_unit);
            when 5 =>
              first := random.integer_between(-50, 50);
              put(axis, word_shift, first);
              offsets(axis) := offsets(axis) + first;
              bus_refuse(clock, m2s, s2m, '1', axis * 16 + word_shift, "a shift before the one before was done");
            when others =>
              put(axis, word_control, random.integer_between(0, 3));
          end case;
        end loop;
        wait_clocks(clock, random.integer_between(1, 20 * ramp_clocks));
        wait_clocks(clock, 2 * ramp_clocks);
        for axis in 0 to axes - 1 loop
          first := counts(axis);
          get(axis, word_position, got);
          check(got - offsets(axis) >= minimum(first, counts(axis)) - 1 and
                got - offsets(axis) <= maximum(first, counts(axis)) + 1, "a position in flight");
        end loop;
      end loop;
      for axis in 0 to axes - 1 loop
        first := counts(axis) + offsets(axis) + random.integer_between(-300, 300);
        put(axis, word_speed, 200_000 * speed_unit);
        put(axis, word_acceleration, 500_000);
        put(axis, word_target, first);
        put(axis, word_control, 1);
        wait_rest(axis);
        expect(axis, word_position, first, "the target");
        expect_count(axis);
        expect_status(axis, status_late, '0', "late");
      end loop;
    end loop;

    -- A limit in the ramp halts the axis, also if it opens again. Only a write of the control word ends the halt.
    put(0, word_speed, 100_000 * speed_unit);
    put(0, word_acceleration, 64_000_000 / acceleration_unit);
    get(0, word_position, first);
    put(0, word_target, first + 1000);
    put(0, word_control, 2#01101#); -- latch the low limit: never
    wait_clocks(clock, 20 * ramp_clocks);
    limit_low(0) <= '1'; -- behind: no matter
    wait_clocks(clock, 5 * ramp_clocks);
    expect_status(0, status_halted, '0', "halted by the limit behind");
    expect_status(0, status_latched, '1', "the latch");
    limit_low(0)  <= '0';
    limit_high(0) <= '1';
    wait_clocks(clock, 4 * ramp_clocks);
    limit_high(0) <= '0';
    wait_rest(0);
    expect_status(0, status_halted, '1', "halted");
    get(0, word_position, got);
    check(got < first + 1000 and got > first, "a halt on the way");
    expect_count(0);
    was := counts;
    put(0, word_target, first + 2000);
    wait_clocks(clock, 10 * ramp_clocks);
    check(was = counts, "a halted axis moved");
    limit_high(0) <= '1';
    put(0, word_target, first);
    put(0, word_control, 2#00101#);
    wait_rest(0);
    expect(0, word_position, first, "away from an active limit");
    expect_status(0, status_halted, '0', "halted");
    limit_high(0) <= '0';

    -- The position and the time of the edge of home. Only the first edge counts, and a level is no edge.
    home(0) <= '1';
    wait_clocks(clock, 10);
    put(0, word_target, first + 400);
    put(0, word_control, 2#11001#);
    wait_clocks(clock, 10 * ramp_clocks);
    home(0) <= '0';
    wait_clocks(clock, 15 * ramp_clocks);
    expect_status(0, status_latched, '0', "latched by a level");
    home(0) <= '1';
    got    := counts(0) + offsets(0);
    second := clocks;
    wait_clocks(clock, 50);
    home(0) <= '0';
    wait_clocks(clock, 50);
    home(0) <= '1';
    wait_clocks(clock, 100);
    expect_status(0, status_latched, '1', "latched");
    expect_status(0, status_home, '1', "home");
    get(0, word_latched, first);
    check(abs (first - got) <= 1, "latched " & integer'image(first) & " at " & integer'image(got));
    get(0, word_stamp, got);
    check(got >= second + 4 and got <= second + 7 + (axes + 1) * (clock_hz / 2 ** base_bits(axes, clock_hz) + 1),
          "the stamp is " & integer'image(got - second) & " clocks after the edge");
    wait_rest(0);

    -- `stop` halts all axes, and the control word does not end the halt while it is high.
    for axis in 0 to axes - 1 loop
      put(axis, word_speed, 50_000 * speed_unit);
      put(axis, word_acceleration, 1_000_000);
      put(axis, word_velocity_target, 50_000 * speed_unit);
      put(axis, word_control, 3);
    end loop;
    wait_clocks(clock, 20 * ramp_clocks);
    stop <= '1';
    wait_clocks(clock, 10);
    put(0, word_control, 3);
    for axis in 0 to axes - 1 loop
      wait_rest(axis);
      expect_status(axis, status_halted, '1', "halted by stop");
      expect_count(axis);
    end loop;
    stop <= '0';
    wait_clocks(clock, 5 * ramp_clocks);
    was := counts;
    wait_clocks(clock, 10 * ramp_clocks);
    check(was = counts, "an axis moved after stop");
    put(0, word_control, 3);
    wait_clocks(clock, 10 * ramp_clocks);
    check(was /= counts, "the halt ended");

    -- Too fast for the pulses: the axis is slower, and says so, but loses no step.
    put(0, word_speed, 2 ** speed_bits - 1);
    put(0, word_acceleration, 2 ** acceleration_bits - 1);
    put(0, word_velocity_target, 2 ** speed_bits - 1);
    wait_clocks(clock, 85 * ramp_clocks);
    expect_status(0, status_late, '1', "late");
    put(0, word_control, 0);
    wait_rest(0);
    expect_count(0);

    -- The position wraps, and a target beyond the wrap is near.
    get(0, word_position, got);
    put(0, word_shift, integer'high - got - 100);
    wait_clocks(clock, 2 * ramp_clocks);
    expect(0, word_position, integer'high - 100, "a shifted position");
    first := counts(0);
    put(0, word_speed, 100_000 * speed_unit);
    put(0, word_acceleration, 1_000_000);
    put(0, word_target, integer'low + 100);
    put(0, word_control, 1);
    wait_rest(0);
    expect(0, word_position, integer'low + 100, "beyond the wrap");
    check_equal(counts(0) - first, 201, "the steps across the wrap");

    -- A reset stops at once.
    put(0, word_target, 1000 - integer'high);
    wait_clocks(clock, 20 * ramp_clocks);
    reset <= '1';
    wait_clocks(clock, 3);
    reset <= '0';
    wait_clocks(clock, 300);
    was := counts;
    expect(0, word_position, 0, "the position after a reset");
    expect(0, word_velocity, 0, "the velocity after a reset");
    wait_clocks(clock, 10 * ramp_clocks);
    check(was = counts, "an axis moved after a reset");

    wait_clocks(clock, 2);
    report_passed("stepgen_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 5 sec, "stepgen_tb");

end architecture;
