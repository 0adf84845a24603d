-- SPDX-License-Identifier: BSD-3-Clause
--
-- h_bridge: the time for which the motor is driven is measured in both directions, for all forms of pins. All and
-- nothing have no edges. A fault cuts within two clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity h_bridge_tb is
  generic (
    coast : natural range 0 to 1 := 0;
    seed  : positive             := 1
  );
end entity;

architecture test of h_bridge_tb is

  constant clock_period : time     := 20 ns;
  constant period       : positive := 250; -- clocks, at 10 MHz
  constant dead_clocks  : positive := 8;
  constant duty_most    : positive := 255;
  constant run          : natural  := 1 + 2 * coast;

  signal clock, fault : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal m2s          : wishbone_m2s_t := wishbone_m2s_idle;
  signal done, clear  : boolean := false;

  type s2m_t is array (0 to 2) of wishbone_s2m_t;
  type pins_t is array (0 to 2) of std_ulogic_vector(3 downto 0);
  type numbers_t is array (0 to 2) of natural;

  signal s2m             : s2m_t; -- of each form
  signal pins            : pins_t;
  signal tripped         : std_ulogic_vector(0 to 2);
  signal ahead, back     : numbers_t := (others => 0); -- clocks for which the motor is driven
  signal brakes          : natural := 0;
  signal edges           : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  forms : for form in 0 to 2 generate
    dut : entity work.h_bridge
      generic map (
        clock_hz => 10_000_000, frequency_hz => 40_000, duty_bits => 9, form => form, dead_minimum_ns => 800)
      port map (
        clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m(form), tripped => tripped(form),
        fault => fault, pins => pins(form));
  end generate;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m(0));

  meter : process (clock) is
    variable before         : std_ulogic_vector(3 downto 0) := "0000";
    type since_t is array (0 to 3) of natural;
    variable since          : since_t := (others => 100);
  begin
    if rising_edge(clock) and reset = '0' then
      for leg in 0 to 1 loop
        check((pins(0)(2 * leg) and pins(0)(2 * leg + 1)) = '0', "both gates of a leg are on");
      end loop;
      for gate in 0 to 3 loop
        since(gate) := since(gate) + 1;
        if pins(0)(gate) = '1' then
          since(gate) := 0;
        end if;
      end loop;
      for gate in 0 to 3 loop
        if pins(0)(gate) = '1' and before(gate) = '0' then
          check(since((gate / 2) * 2 + 1 - gate mod 2) > dead_clocks, "a gate is on too soon");
        end if;
      end loop;
      if pins(0) /= before then
        edges <= edges + 1;
      end if;
      before := pins(0);
      ahead(0) <= ahead(0) + boolean'pos(pins(0) = "1001");
      back(0)  <= back(0) + boolean'pos(pins(0) = "0110");
      ahead(1) <= ahead(1) + boolean'pos(pins(1) = "0001");
      back(1)  <= back(1) + boolean'pos(pins(1) = "0010");
      ahead(2) <= ahead(2) + boolean'pos(pins(2) = "0011");
      back(2)  <= back(2) + boolean'pos(pins(2) = "0010");
      brakes   <= brakes + boolean'pos(pins(0) = "1010" and pins(1) = "0011");
      if clear then
        ahead  <= (others => 0);
        back   <= (others => 0);
        brakes <= 0;
        edges  <= 0;
      end if;
    end if;
  end process;

  master : process is

    variable random : random_t;
    variable duty   : integer;
    variable driven : integer;

    procedure measure (of_duty : integer) is
    begin
      bus_write(clock, m2s, s2m(0), 3, std_ulogic_vector(to_signed(of_duty, 32)));
      wait_clocks(clock, 3 * period);
      clear <= true;
      wait_clocks(clock, 1);
      clear <= false;
      wait_clocks(clock, 10 * period - 1);
      tick(clock);
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    tick(clock, 2);
    bus_expect(clock, m2s, s2m(0), 2, 800);
    bus_write(clock, m2s, s2m(0), 2, 0);
    bus_expect(clock, m2s, s2m(0), 2, 800);
    measure(100);
    check_equal(edges, 0, "edges before enable");
    bus_write(clock, m2s, s2m(0), 0, run);

    for index in 1 to 10 loop
      duty := random.integer_between(30, duty_most - 30);
      if random.chance(50) then
        duty := -duty;
      end if;
      measure(duty);
      bus_expect(clock, m2s, s2m(0), 3, std_ulogic_vector(to_signed(duty, 32)));
      driven := 10 * (abs (duty) * period / 256 - dead_clocks);
      for form in 0 to 2 loop
        if duty > 0 then
          check(abs (ahead(form) - driven) < 40, "forward: " & integer'image(ahead(form)));
          check_equal(back(form), 0, "back while forward");
        else
          check(abs (back(form) - driven) < 40, "back: " & integer'image(back(form)));
          check_equal(ahead(form), 0, "forward while back");
        end if;
      end loop;
      check((brakes > 0) = (coast = 0), "brakes");
    end loop;

    measure(duty_most);
    check_equal(ahead(0), 10 * period, "clocks forward at 1");
    check_equal(edges, 0, "edges at 1");
    measure(-duty_most);
    check_equal(back(0), 10 * period, "clocks back at -1");
    measure(-duty_most - 1);
    check_equal(back(0), 10 * period, "clocks back at the smallest number");
    measure(0);
    check_equal(edges, 0, "edges at 0");
    check_equal(ahead(0) + back(0), 0, "clocks driven at 0");

    for index in 1 to 10 loop
      measure(duty_most / 2);
      wait_clocks(clock, random.integer_between(1, period));
      fault <= '1';
      tick(clock, 2);
      for form in 0 to 1 loop
        check_equal(pins(form), std_ulogic_vector'("0000"), "pins two clocks after the fault");
      end loop;
      check_equal(pins(2)(1), '0', "EN two clocks after the fault");
      fault <= '0';
      bus_write(clock, m2s, s2m(0), 0, run);
      measure(duty_most);
      check_equal(ahead(0) + ahead(1) + ahead(2), 0, "driven without a new rise of enable");
      bus_expect(clock, m2s, s2m(0), 1, 2);
      bus_write(clock, m2s, s2m(0), 0, 0);
      bus_write(clock, m2s, s2m(0), 0, run);
      bus_expect(clock, m2s, s2m(0), 0, run);
    end loop;

    bus_refuse(clock, m2s, s2m(0), '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m(0), '0', 4, "a read beyond the registers");
    wait_clocks(clock, 2);
    report_passed("h_bridge_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 500000, "h_bridge_tb");

end architecture;
