-- SPDX-License-Identifier: BSD-3-Clause
--
-- hall with a rotor: sectors, positions and angles both ways, at a steady and at a changing speed, at rest, codes that
-- cannot be, short pulses, the velocity, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity hall_tb is
  generic (
    with_velocity : natural range 0 to 1 := 1
  );
end entity;

architecture test of hall_tb is

  constant clock_period : time     := 500 ns; -- 2 MHz, so a tick is 2 clocks
  constant full_time    : time     := 65_536 * 2 * clock_period;
  constant turn         : positive := 65_536;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal moved, failed, stopped : std_ulogic;
  signal position_wire, angle_wire, velocity_wire : wire_t;
  signal lines, model_lines, forced : std_ulogic_vector(2 downto 0) := "000";
  signal rate     : real := 0.0;
  signal fault    : natural := 0;
  signal angle    : real;
  signal forces   : boolean := true; -- the bench gives the lines
  signal follows  : boolean := false; -- the angle is compared with that of the rotor
  signal compared, moves, fails, stops : natural := 0;
  signal first    : natural := 0; -- the sector at the position 0
  signal in_order : boolean := true; -- no code has been left out

  -- The codes of the sectors, line 2 first.
  type codes_t is array (0 to 5) of std_ulogic_vector(2 downto 0);
  constant codes : codes_t := ("101", "001", "011", "010", "110", "100");

begin

  clock <= not clock after clock_period / 2 when not done;
  lines <= forced when forces else model_lines;

  rotor : entity work.hall_model
    generic map (period => clock_period, bounce => 1500 ns)
    port map (clock => clock, rate => rate, fault => fault, lines => model_lines, angle => angle);

  dut : entity work.hall
    generic map (
      clock_hz => 2_000_000, filter_ns => 2000, with_velocity => with_velocity, velocity_us => 1000, stall_us => 40_000)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, moved => moved, failed => failed,
      stopped => stopped, position_wire => position_wire, angle_wire => angle_wire, velocity_wire => velocity_wire,
      lines => lines);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  watch : process (clock) is
    variable sector, inside, found : integer;
    variable off    : real;
    variable before : integer := 0;
  begin
    if rising_edge(clock) and reset = '1' then
      before := 0;
    elsif rising_edge(clock) then
      moves <= moves + 1 when moved = '1';
      fails <= fails + 1 when failed = '1';
      stops <= stops + 1 when stopped = '1';
      found := to_integer(value_of(position_wire));
      check(abs (found - before) <= 1, "one sector at a time");
      check(found = before or moved = '1', "each step is told");
      before := found;
      if is_valid(angle_wire) = '1' and in_order then
        sector := (first + found) mod 6;
        inside := (to_integer(value_of(angle_wire)) - (sector * turn) / 6 + turn) mod turn;
        check(inside <= turn / 6 + 1 or inside = turn - 1, "the angle " & to_string(inside) & " is in its sector");
        if follows then
          off := real(to_integer(value_of(angle_wire))) / real(turn) - angle;
          off := (off - round(off)) * 360.0;
          check(abs off < 4.5, "the angle is that of the rotor, not off by " & to_string(off, 2) & " deg");
          compared <= compared + 1;
        end if;
      end if;
    end if;
  end process;

  master : process is

    variable answer : bus_answer_t;
    constant any    : natural := 12;
    variable count, before : integer;
    variable speed  : real;

    -- The lines go to a sector, and the words say so. The angle is in twelfths of a turn.
    procedure go_to (sector : natural; position : integer; status : natural; place : natural) is
    begin
      forced <= codes(sector);
      wait for 200 us;
      bus_expect(clock, m2s, s2m, 0, status + sector);
      bus_read(clock, m2s, s2m, 1, answer);
      check_equal(to_integer(signed(answer.word)), position, "the position");
      bus_read(clock, m2s, s2m, 2, answer);
      check(place = any or abs (to_integer(unsigned(answer.word)) - (place * turn) / 12) <= 1, "the angle " &
            to_string(to_integer(unsigned(answer.word))) & " is " & to_string(place) & " twelfths");
    end procedure;

    procedure expect_speed (counts_s : real) is
    begin
      if with_velocity = 1 then
        bus_read(clock, m2s, s2m, 4, answer);
        speed := real(to_integer(signed(answer.word))) / 256.0;
        check(abs (speed - counts_s) <= 0.01 * abs counts_s, "the speed is " & to_string(speed, 1) & " count/s, not " &
              to_string(counts_s, 1));
        check(value_of(velocity_wire) = signed(answer.word), "the wire has it");
      end if;
    end procedure;

  begin
    forced <= codes(2);
    wait_clocks(clock, 8);
    reset <= '0';
    first <= 2;
    wait_clocks(clock, 2);

    -- By hand, with a pause of 200 us and more in each sector: the first way has no period.
    go_to(2, 0, 8, 5);
    check(is_valid(position_wire) = '1' and fails = 0 and moves = 0, "it begins without a step");
    go_to(3, 1, 8, 7);
    forced <= codes(4);
    wait for 5 us;
    bus_expect(clock, m2s, s2m, 0, 8 + 32 + 4);
    go_to(3, 1, 8 + 16, 7);
    go_to(2, 0, 8 + 16 + 32, any);
    go_to(1, -1, 8 + 16 + 32, any);

    -- A pulse that is shorter than the filter is none, and a code that cannot be is told.
    forced <= codes(0);
    wait for 1500 ns;
    forced <= codes(1);
    wait for 20 us;
    check_equal(fails, 0, "failures");
    bus_expect(clock, m2s, s2m, 1, x"FFFFFFFF");
    for code in 0 to 1 loop
      forced <= "000" when code = 0 else "111";
      wait for 20 us;
      check_equal(fails, code + 1, "failures");
      check(is_valid(position_wire) = '0' and is_valid(angle_wire) = '0', "the wires end");
      bus_expect(clock, m2s, s2m, 0, 32 + 16 + 1);
      forced <= codes(1);
      wait for 20 us;
      bus_expect(clock, m2s, s2m, 0, 8 + 32 + 16 + 1);
      bus_expect(clock, m2s, s2m, 3, code + 1);
    end loop;
    in_order <= false;
    count := moves;
    forced <= codes(4); -- three sectors at once
    wait for 20 us;
    check_equal(fails, 3, "a sector that is no neighbour");
    check_equal(moves, count + 1, "moves");
    go_to(4, -1, 8 + 16, 9);

    -- A rotor.
    reset <= '1';
    forces <= false;
    wait_clocks(clock, 8);
    reset <= '0';
    first <= 0;
    in_order <= true;
    wait for 20 us;
    bus_expect(clock, m2s, s2m, 0, 8);
    for way in 1 to 2 loop
      for number in 2 to 3 loop
        speed := real(3 - 2 * way) * 15.0 * real(4 ** number);
        rate <= speed;
        wait for 40 ms / 4 ** number * 3; -- the old speed is forgotten
        follows <= true;
        wait for 8 ms;
        follows <= false;
        expect_speed(6.0 * speed);
      end loop;
    end loop;
    check(compared > 40_000, "angles were compared");
    bus_expect(clock, m2s, s2m, 3, 0);
    count := fails;

    -- It slows down, and the angle waits at the end of the sector.
    rate <= -40.0;
    wait for 12 ms;
    rate <= 0.0;
    before := stops;
    wait for full_time + 10 ms;
    check_equal(stops, before + with_velocity, "it has stopped");
    if with_velocity = 1 then
      bus_expect(clock, m2s, s2m, 4, 0);
    end if;
    bus_read(clock, m2s, s2m, 0, answer);
    check(answer.word(5) = '0' and answer.word(4) = '1', "the angle stands");
    before := 2 * to_integer(unsigned(answer.word(2 downto 0))) + 1;
    bus_read(clock, m2s, s2m, 2, answer);
    check(abs (to_integer(unsigned(answer.word)) - (before * turn) / 12) <= 1, "it is the middle of the sector");
    fault <= 2;
    wait for 20 us;
    check_equal(fails, count + 1, "all lines high");

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the position");
    bus_refuse(clock, m2s, s2m, '0', 4 + with_velocity, "a read beyond the registers");

    -- A reset with lines that are broken: not valid, and told once.
    fault <= 1;
    reset <= '1';
    wait_clocks(clock, 8);
    reset <= '0';
    wait for 20 us;
    check_equal(fails, count + 2, "broken lines are told");
    bus_expect(clock, m2s, s2m, 0, 0);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    bus_expect(clock, m2s, s2m, 3, 1);
    check(is_valid(position_wire) = '0', "no valid position");
    report_passed("hall_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 2 sec, "hall_tb");

end architecture;
