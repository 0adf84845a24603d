-- SPDX-License-Identifier: BSD-3-Clause
--
-- bridge_gates: random sides, legs and dead times. The gates follow after exactly the dead time, and not while they are
-- held. A fault cuts within two clocks, and stays.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity bridge_gates_tb is
  generic (
    clock_hz    : positive             := 50_000_000;
    fault_level : natural range 0 to 1 := 1;
    seed        : positive             := 1
  );
end entity;

architecture test of bridge_gates_tb is

  constant clock_period    : time     := 20 ns;
  constant legs            : positive := 2;
  constant dead_minimum_ns : positive := 300;
  constant clock_ns        : positive := 1_000_000_000 / clock_hz;

  subtype legs_t is std_ulogic_vector(legs - 1 downto 0);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;

  signal enable, broken, fault               : std_ulogic := '0';
  signal dead                                : std_ulogic_vector(11 downto 0) := (others => '0');
  signal dead_write                          : std_ulogic := '1';
  signal hold                                : std_ulogic := '0';
  signal driven, sides                       : legs_t := (others => '0');
  signal running, tripped, trip, fault_seen  : std_ulogic;
  signal high, low                           : legs_t;
  signal trips                               : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;
  fault <= broken when fault_level = 1 else not broken;

  dut : entity work.bridge_gates
    generic map (
      clock_hz => clock_hz, legs => legs, dead_minimum_ns => dead_minimum_ns, fault_level => fault_level)
    port map (
      clock => clock, reset => reset, enable => enable, dead => dead, dead_write => dead_write, hold => hold,
      driven => driven, sides => sides, running => running, tripped => tripped, trip => trip,
      fault_seen => fault_seen, fault => fault, high => high, low => low);

  count_trips : process (clock) is
  begin
    if rising_edge(clock) and trip = '1' then
      trips <= trips + 1;
    end if;
  end process;

  stimuli : process is

    variable random : random_t;
    variable ns     : natural;
    variable clocks : positive;
    variable before : legs_t;

    procedure expect_off (what : string) is
    begin
      check(high = (legs_t'range => '0') and low = (legs_t'range => '0'), what);
    end procedure;

  begin
    random.seed(seed);
    wait for 1 ps;
    expect_off("a gate is on at power-up");
    wait_clocks(clock, 6);
    reset <= '0';
    driven <= (others => '1');
    tick(clock, 200);
    expect_off("a gate is on before enable");

    enable <= '1';
    for index in 1 to 60 loop
      ns     := random.integer_between(0, 4095);
      dead   <= std_ulogic_vector(to_unsigned(ns, 12));
      tick(clock, 2);
      dead_write <= '0';
      dead       <= random.vector(12); -- nobody takes it
      -- A table of codes has a place for each 8 ns.
      clocks := (maximum(ns / 8 * 8 + 7, dead_minimum_ns) + clock_ns - 1) / clock_ns;
      tick(clock, 4096 / clock_ns + 3);
      check_equal(high, sides and driven, "high gates at rest");
      check_equal(low, (not sides) and driven, "low gates at rest");

      before := sides;
      sides  <= not sides;
      tick(clock);
      for clock_index in 1 to clocks loop
        check_equal(high, legs_t'(others => '0'), "high gates in the dead time");
        check_equal(low, legs_t'(others => '0'), "low gates in the dead time");
        tick(clock);
      end loop;
      check_equal(high, (not before) and driven, "high gates after the dead time");
      check_equal(low, before and driven, "low gates after the dead time");

      -- A pulse that is shorter than the dead time.
      sides <= before;
      tick(clock, random.integer_between(1, clocks - 1));
      sides <= not before;
      for clock_index in 1 to clocks loop
        tick(clock);
        expect_off("a gate is on in a pulse that is too short");
      end loop;
      tick(clock);
      check_equal(high, (not before) and driven, "high gates after the short pulse");

      -- Nothing happens while `hold` is 1.
      hold  <= '1';
      sides <= random.vector(legs);
      tick(clock, random.integer_between(1, 2 * clocks));
      check_equal(high, (not before) and driven, "high gates while the sides are held");
      check_equal(low, before and driven, "low gates while the sides are held");
      sides <= not before;
      tick(clock);
      hold       <= '0';
      dead_write <= '1';

      driven <= random.vector(legs);
      if random.chance(40) then
        wait for clock_period / 3;
        broken <= '1';
        tick(clock, 2);
        expect_off("a gate is on two clocks after the fault");
        check_equal(fault_seen, '1', "fault_seen");
        pause(clock, random, 80);
        enable <= '0';
        tick(clock, 2);
        enable <= '1';
        tick(clock, 2);
        check_equal(running, '0', "running during a fault");
        broken <= '0';
        tick(clock, 4096 / clock_ns + 5);
        expect_off("a gate is on without a new rise of enable");
        check_equal(tripped, '1', "tripped");
        enable <= '0';
        tick(clock, 2);
        enable <= '1';
        tick(clock, 2);
        check_equal(tripped, '0', "tripped after a new start");
      end if;
    end loop;
    check(trips > 5, "too few faults");

    enable <= '0';
    tick(clock, 2);
    expect_off("a gate is on after enable fell");

    report_passed("bridge_gates_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 200000, "bridge_gates_tb");

end architecture;
