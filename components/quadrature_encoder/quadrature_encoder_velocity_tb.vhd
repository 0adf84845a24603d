-- SPDX-License-Identifier: BSD-3-Clause
--
-- quadrature_encoder_velocity: the exact speed at any distance of the edges, both ways; no speed on a swinging edge; a
-- speed that falls to 0 in steps that the last edge bounds; the end of a window in the clock of an edge.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity quadrature_encoder_velocity_tb is
end entity;

architecture test of quadrature_encoder_velocity_tb is

  constant clock_hz : positive := 1_000_000;
  constant window   : positive := 100; -- clocks, and µs
  constant stall    : positive := 400;
  constant factor   : positive := clock_hz * 256;

  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal done    : boolean := false;
  signal a, b    : std_ulogic := '0';
  signal hold    : std_ulogic := '0';
  signal speed   : unsigned(30 downto 0);
  signal back    : std_ulogic;
  signal stopped : std_ulogic;
  signal stalls  : natural := 0;

begin

  clock <= not clock after 500 ns when not done;
  hold  <= not hold after 3 us when not done;

  dut : entity work.quadrature_encoder_velocity
    generic map (clock_hz => clock_hz, window_us => window, stall_us => stall)
    port map (
      clock => clock, reset => reset, a => a, b => b, hold => hold, speed => speed, back => back, stopped => stopped);

  process (clock) is
  begin
    if rising_edge(clock) and stopped = '1' then
      stalls <= stalls + 1;
    end if;
  end process;

  master : process is

    variable quarter : natural range 0 to 3 := 0;
    variable before  : natural;
    variable down    : std_ulogic;

    procedure step (by : integer; apart : positive) is
    begin
      quarter := (quarter + by) mod 4;
      a <= '1' when quarter = 1 or quarter = 2 else '0';
      b <= '1' when quarter >= 2 else '0';
      wait_clocks(clock, apart);
    end procedure;

    procedure expect (size : natural; down : std_ulogic; what : string) is
    begin
      check(speed = size and back = down,
            what & ": " & to_string(to_integer(speed)) & " back " & to_string(back) & ", not " & to_string(size));
    end procedure;

  begin
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 3 * window);
    expect(0, '0', "nothing has moved");
    check(stalls = 0, "what never moved does not stop");

    -- Edges at any distance. After three windows the speed is exact, at every phase of edge and window.
    for turn in 0 to 1 loop
      down := '1' when turn = 1 else '0';
      for apart in 1 to 5 loop
        for count in 1 to 3 * window / apart loop
          step(1 - 2 * turn, apart);
        end loop;
        for count in 1 to 2 * window / apart loop
          step(1 - 2 * turn, apart);
          expect(factor / apart, down, "edges " & to_string(apart) & " clocks apart");
        end loop;
      end loop;
      for apart in window - 1 to window + 1 loop
        for count in 1 to 5 loop
          step(1 - 2 * turn, apart);
        end loop;
        for count in 1 to window + 2 loop
          step(1 - 2 * turn, apart);
          -- An edge in each window, or none: then the speed is what it was.
          expect(factor / apart, down, "edges " & to_string(apart) & " clocks apart");
        end loop;
      end loop;
    end loop;

    -- Two edges and a long pause, at each phase: the way of the second one begins at the first, or both are one way.
    for count in 1 to window + 4 loop
      before := 0;
      step(1, 50);
      step(1, 1);
      for clocks in 1 to 2 * window loop
        before := maximum(before, to_integer(speed));
        wait_clocks(clock, 1);
      end loop;
      check(count < 4 or before = factor / 50 or before = 2 * factor / 251, "two edges gave " & to_string(before));
    end loop;

    -- A shaft that swings on one edge has no speed, however fast it does.
    for count in 1 to 3 * window loop
      step(1, 1);
      step(-1, 2);
    end loop;
    for count in 1 to window loop
      step(1, 1);
      step(-1, 2);
      check(speed = 0, "it swings on an edge: " & to_string(to_integer(speed)));
    end loop;

    -- After the last edge it is bounded by that edge, and then 0.
    for count in 1 to 3 * window loop
      step(1, 2);
    end loop;
    before := to_integer(speed);
    for clocks in 1 to stall + 20 loop
      wait_clocks(clock, 1);
      check(to_integer(speed) <= before, "it only falls");
      check(clocks < 2 * window or speed <= factor / (clocks - window - 60), "the last edge bounds it");
      before := to_integer(speed);
    end loop;
    expect(0, '0', "it has stopped");
    check(stalls = 1, "it has stopped once");

    -- The first edge afterwards begins a way, the second one ends it.
    step(-1, 2 * window);
    expect(0, '0', "one edge is no way");
    step(-1, 2 * window);
    expect(factor / (2 * window), '1', "two edges are");

    -- A reset ends it.
    reset <= '1';
    wait_clocks(clock, 2);
    expect(0, '0', "a reset");
    report_passed("quadrature_encoder_velocity_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "quadrature_encoder_velocity_tb");

end architecture;
