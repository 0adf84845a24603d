-- SPDX-License-Identifier: BSD-3-Clause
--
-- position_compare: rows of places in both directions, passed one by one and several at once, one place, levels, a wire
-- that is lost, pulses that are cut, differences that wrap, and a random walk beside a reference.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity position_compare_tb is
  generic (
    active_level : natural  := 1;
    seed         : positive := 1
  );
end entity;

architecture test of position_compare_tb is

  constant clock_period : time     := 20 ns;
  constant pulse_clocks : positive := 7;

  constant enable : natural := 1;
  constant down   : natural := 2;
  constant level  : natural := 4;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal position : wire_t := no_wire;
  signal reached  : std_ulogic;
  signal line     : std_ulogic;
  signal active   : std_ulogic;

  signal events : natural := 0;
  signal pulses : natural := 0;               -- that have begun
  signal high   : natural := 0;               -- clocks of this pulse
  signal last   : natural := 0;               -- and of the one before

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.position_compare
    generic map (clock_hz => 50_000_000, pulse_ns => 20 * pulse_clocks - 15, active_level => active_level)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, reached => reached,
      position_wire => position, line => line);

  active <= line when active_level = 1 else not line;

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if reached = '1' then
        events <= events + 1;
      end if;
      if active = '1' then
        high <= high + 1;
        if high = 0 then
          pulses <= pulses + 1;
        end if;
      else
        high <= 0;
        if high /= 0 then
          last <= high;
        end if;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random : random_t;
    variable given  : natural := 0; -- pulses and levels that must have come
    variable answer : bus_answer_t;
    variable here   : integer;
    variable place  : integer;
    variable apart  : positive;
    variable is_down : boolean;

    procedure move (where : integer) is
    begin
      position <= wire_of(to_signed(where, 32));
      wait_clocks(clock, 1);
    end procedure;

    procedure set (address : natural; value : integer) is
    begin
      bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    -- Long enough for so many pulses.
    procedure expect (more : natural; what : string) is
    begin
      wait_clocks(clock, 6 + more * (pulse_clocks + 1));
      given := given + more;
      check_equal(pulses, given, what);
      check_equal(events, given, what & ", events");
      bus_read(clock, m2s, s2m, 3, answer);
      check_equal(to_integer(unsigned(answer.word)), given, what & ", +3");
    end procedure;

    procedure expect_place (value : integer) is
    begin
      bus_expect(clock, m2s, s2m, 1, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 4);
    check_equal(active, '0', "the line rests in a reset");
    reset <= '0';
    wait_clocks(clock, 2);

    -- Without a position nothing is reached.
    set(0, enable);
    expect(0, "no wire");
    bus_expect(clock, m2s, s2m, 0, std_ulogic_vector(to_unsigned(enable, 32)));

    -- A row of places, up.
    move(0);
    set(1, 3);
    set(2, 3);
    expect(0, "before the place");
    for now in 1 to 20 loop
      move(now);
      expect(boolean'pos(now mod 3 = 0), "a place at each third count, at" & integer'image(now));
      if now mod 3 = 0 then
        check_equal(last, pulse_clocks, "clocks of a pulse");
      end if;
      expect_place(3 * (now / 3 + 1));
    end loop;
    for now in 19 downto 0 loop
      move(now);
    end loop;
    expect(0, "no place is reached on the way back");
    expect_place(21);

    -- The line follows the wire by 3 clocks.
    move(20);
    wait_clocks(clock, 5);
    wait until falling_edge(clock);
    position <= wire_of(to_signed(21, 32));
    for clocks in 1 to 3 loop
      check_equal(active, '0', "the line is early");
      wait until falling_edge(clock);
    end loop;
    check_equal(active, '1', "the line is late");
    expect(1, "the place of the latency");

    -- Several places at once.
    move(21 + 3 * 9 + 2);
    expect(9, "nine places at once");
    check_equal(last, pulse_clocks, "clocks of such a pulse");
    expect_place(51);

    -- Behind a place from the begin: it is reached only after the position has been before it.
    set(1, 40);
    expect(0, "behind the place");
    move(39);
    move(39);
    wait_clocks(clock, 3);
    move(40);
    expect(1, "it has been before the place");

    -- Down, where one place has no successor.
    set(0, enable + down);
    set(1, 10);
    set(2, 0);
    for passing in 1 to 3 loop
      move(11);
      expect(0, "before the place, from above");
      move(10 - passing);
      expect(1, "one pulse at each passing down");
      expect_place(10);
    end loop;
    move(12);
    set(2, 4);
    expect(0, "before a row down");
    move(1);
    expect(3, "three places down");
    expect_place(-2);

    -- Differences wrap.
    set(0, enable);
    set(2, 2 ** 30);
    set(1, -(2 ** 30) - (2 ** 30));
    move(2 ** 30 + (2 ** 30 - 1));
    expect(0, "before the wrap");
    move(-(2 ** 30) - (2 ** 30));
    expect(1, "behind the wrap");
    expect_place(-(2 ** 30));

    -- A wire that was lost must come back before the place.
    set(1, 100);
    move(99);
    wait_clocks(clock, 4);
    position <= no_wire;
    wait_clocks(clock, 4);
    move(101);
    expect(0, "the wire was lost");

    -- A pulse is cut when the compare is disabled.
    move(0);
    wait_clocks(clock, 4);
    move(100);
    wait_clocks(clock, 4);
    check_equal(active, '1', "in the pulse");
    set(0, 0);
    wait_clocks(clock, 2);
    check_equal(active, '0', "the pulse is cut");
    expect(1, "the pulse that was cut");

    -- A level.
    set(0, enable + level);
    set(1, 5);
    move(4);
    expect(0, "before the level");
    move(5);
    expect(1, "the level begins");
    check_equal(active, '1', "at the place");
    move(1000);
    set(1, 6);
    set(0, enable + level);
    expect(0, "the level stays");
    check_equal(active, '1', "behind the place");
    position <= no_wire;
    expect(0, "the wire was lost");
    check_equal(active, '0', "the level rests without a wire");
    move(1000);
    expect(1, "the wire is back");
    set(0, enable + level + down);
    expect(0, "the other direction");
    check_equal(active, '0', "above the place");
    set(0, 0);

    -- Random walks: there are as many pulses as places were reached.
    for walk in 1 to 60 loop
      here    := random.integer_between(-1000, 1000);
      is_down := random.chance(50);
      apart   := random.integer_between(1, 9);
      place   := here + random.integer_between(1, 20) * (1 - 2 * boolean'pos(is_down));
      set(0, 0);
      set(1, place);
      set(2, apart);
      move(here);
      set(0, enable + down * boolean'pos(is_down));
      wait_clocks(clock, 4);
      for steps in 1 to 10 loop
        here := here + random.integer_between(-6, 12) * (1 - 2 * boolean'pos(is_down));
        move(here);
        while (here >= place and not is_down) or (here <= place and is_down) loop
          given := given + 1;
          place := place + apart * (1 - 2 * boolean'pos(is_down));
          wait_clocks(clock, pulse_clocks + 1);
        end loop;
        expect(0, "a random walk");
        expect_place(place);
      end loop;
    end loop;

    bus_refuse(clock, m2s, s2m, '1', 3, "a write of +3");
    bus_refuse(clock, m2s, s2m, '0', 4, "a read of +4");

    reset <= '1';
    wait_clocks(clock, 2);
    reset <= '0';
    for address in 0 to 3 loop
      bus_expect(clock, m2s, s2m, address, x"00000000");
    end loop;

    wait_clocks(clock, 2);
    report_passed("position_compare_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "position_compare_tb");

end architecture;
