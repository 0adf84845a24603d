-- SPDX-License-Identifier: BSD-3-Clause
--
-- pid between an encoder and an H-bridge: each gain alone, gains that are taken at once, limits, the integral that does
-- not wind up, trips, the safe value, and the clocks from the encoder's pin to the duty. tests/gateware/test_clock_true
-- compares the sums, at any inputs.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity pid_tb is
end entity;

architecture test of pid_tb is

  constant clock_period : time := 20 ns;
  constant period       : positive := 140; -- clocks of a loop
  constant one          : positive := 65_536; -- a kp of 1

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal a, b                 : std_ulogic := '0';
  signal position, velocity   : wire_t;
  signal feedback             : wire_t;
  signal target               : wire_t := no_wire;
  signal output               : wire_t;
  signal cut                  : std_ulogic := '0'; -- the feedback is not valid
  signal tripped              : std_ulogic;
  signal trips                : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  feedback <= no_wire when cut = '1' else position;

  encoder : entity work.quadrature_encoder
    generic map (filter_ns => 20)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s_idle, wishbone_s2m => open, indexed => open,
      failed => open, stopped => open, position_wire => position, velocity_wire => velocity, a => a, b => b);

  dut : entity work.pid
    generic map (loop_hz => 50_000_000 / period, safe => 3, output_wire_bits => 13, filter_bits => 0)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped,
      feedback_wire => feedback, target_wire => target, output_wire => output);

  bridge : entity work.h_bridge
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s_idle, wishbone_s2m => open, tripped => open,
      duty_wire => output, fault => '0', pins => open);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if tripped = '1' then
        trips <= trips + 1;
      end if;
      check(reset = '1' or is_valid(output) = '1', "the output is always valid");
    end if;
  end process;

  master : process is

    variable quarter : natural range 0 to 3 := 0;
    variable place   : integer := 0; -- of the encoder
    variable clocks, longest, shortest : natural := 0;
    variable first   : integer;

    procedure put (address : natural; value : integer) is
    begin
      bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    procedure turn (by : integer) is
    begin
      for count in 1 to abs by loop
        quarter := (quarter + by / abs by) mod 4;
        a <= '1' when quarter = 1 or quarter = 2 else '0';
        b <= '1' when quarter >= 2 else '0';
        wait_clocks(clock, 4);
      end loop;
      place := place + by;
    end procedure;

    -- The output after some whole periods.
    procedure expect (value : integer; what : string) is
    begin
      wait_clocks(clock, 3 * period);
      check(value_of(output) = value, what & ": " & to_string(to_integer(value_of(output))) & ", not " &
            to_string(value));
      bus_expect(clock, m2s, s2m, 13, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    -- All gains, taken together.
    procedure gains (kp, ki, kd, kv, ka : natural) is
    begin
      put(5, kp);
      put(6, ki);
      put(7, kd);
      put(8, kv);
      put(9, ka);
      put(12, 1);
    end procedure;

  begin
    wait_clocks(clock, 8);
    reset <= '0';
    expect(3, "it is safe before a start");
    bus_expect(clock, m2s, s2m, 10, std_ulogic_vector(to_unsigned(4095, 32)));

    -- Only what was applied counts, and the sign is that of the error.
    put(2, 100);
    put(0, 1);
    expect(0, "no gain");
    put(5, 2 * one);
    expect(0, "no gain was applied");
    put(12, 1);
    expect(200, "kp");
    put(5, 5 * one);
    expect(200, "a gain that was not applied");
    put(0, 0);
    put(0, 1);
    expect(500, "a start takes the gains");
    put(5, 2 * one);
    put(12, 1);
    expect(200, "kp again");
    turn(130);
    expect(-60, "kp, back");
    bus_expect(clock, m2s, s2m, 14, std_ulogic_vector(to_signed(-30, 32)));
    gains(0, 0, 0, 512, 0);
    put(3, 77);
    expect(77 * 2 / 256 * 1 + 0, "kv");
    put(3, 256 * 50);
    expect(100, "kv");
    gains(0, 0, 0, 0, 3 * one);
    put(4, -4);
    expect(-12, "ka");
    put(3, 0);
    put(4, 0);

    -- kd: one count in each of some periods, against the motion.
    gains(0, 0, 256 * 20, 0, 0);
    wait_clocks(clock, 4 * period);
    first := 0;
    for count in 1 to 30 loop
      turn(1);
      wait_clocks(clock, period - 4);
      if value_of(output) = -20 then
        first := first + 1;
      end if;
    end loop;
    check(first > 25, "kd brakes: " & to_string(first));
    expect(0, "it rests");

    -- The output keeps the limit, and the status says so. The limit cannot be larger than what the output holds.
    put(2, place + 1000);
    gains(256 * one - 1, 0, 0, 0, 0);
    expect(4095, "the most");
    bus_expect(clock, m2s, s2m, 1, x"00000003");
    put(10, 70);
    expect(70, "the limit");
    put(2, place - 1000);
    expect(-70, "the limit, back");
    put(10, 1_000_000);
    bus_expect(clock, m2s, s2m, 10, std_ulogic_vector(to_unsigned(4095, 32)));
    put(10, 500);

    -- The integral is limited, too, and leaves its limit at once.
    put(2, place + 10);
    gains(0, 2 ** 23, 0, 0, 0);
    wait_clocks(clock, 120 * period);
    expect(500, "the integral at its limit");
    put(2, place - 10);
    wait_clocks(clock, 100 * period);
    check(abs (value_of(output) - 0) < 15, "it has left the limit at once: " &
          to_string(to_integer(value_of(output))));

    -- Disabled it is safe within 2 clocks. The integral begins anew.
    put(0, 0);
    wait_clocks(clock, 1);
    check(value_of(output) = 3, "safe when it is disabled");
    put(2, place);
    put(0, 1);
    expect(0, "the integral was cleared");
    put(0, 0);

    -- Too large an error trips, and only a new start ends it. The event comes once.
    put(11, 40);
    gains(one, 0, 0, 0, 0);
    put(2, place + 40);
    put(0, 1);
    expect(40, "the largest error");
    put(2, place - 41);
    expect(3, "an error that is too large");
    check(trips = 1, "it trips once");
    bus_expect(clock, m2s, s2m, 1, x"00000004");
    put(2, place);
    expect(3, "it stays");
    put(0, 0);
    put(0, 1);
    expect(0, "a new start");
    bus_expect(clock, m2s, s2m, 1, x"00000001");
    cut <= '1';
    expect(3, "no feedback");
    bus_expect(clock, m2s, s2m, 1, x"0000000C");
    check(trips = 2, "it trips again");
    -- Without feedback no start gives anything else, in whatever clock of a period it is.
    put(11, 0);
    for phase in 0 to period - 1 loop
      put(0, 0);
      cut <= '0';
      put(0, 1); -- which ends the trip
      put(0, 0);
      cut <= '1';
      wait_clocks(clock, phase);
      put(0, 1);
      while tripped = '0' loop
        wait_clocks(clock, 1);
        check(value_of(output) = 3, "an output without feedback");
      end loop;
    end loop;
    cut <= '0';
    put(0, 0);
    put(0, 1);

    -- A wire is the target.
    target <= wire_of(to_signed(place + 25, 32));
    expect(25, "the target of the wire");
    target <= no_wire;
    expect(0, "the target of the register");

    -- The clocks from the encoder's pin to the output, at each phase of the loop.
    shortest := 10_000;
    for phase in 0 to period / 3 loop
      wait_clocks(clock, period * 2 + 3 * phase);
      first  := to_integer(value_of(output));
      clocks := 0;
      quarter := (quarter + 1) mod 4;
      a <= '1' when quarter = 1 or quarter = 2 else '0';
      b <= '1' when quarter >= 2 else '0';
      while value_of(output) = first loop
        wait_clocks(clock, 1);
        clocks := clocks + 1;
      end loop;
      longest  := maximum(longest, clocks);
      shortest := minimum(shortest, clocks);
    end loop;
    report "pid_tb: " & to_string(shortest) & " to " & to_string(longest) & " clocks from the pin to the output, " &
           to_string(period) & " of them are a period";
    check(shortest >= 127 and longest <= 36 + period + 127, "from the pin to the output");

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '1', 13, "a write of the output");
    bus_refuse(clock, m2s, s2m, '0', 15, "a read of +15");
    bus_refuse(clock, m2s, s2m, '0', 16, "a read of +16");

    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    expect(3, "a reset");
    report_passed("pid_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 200_000, "pid_tb");

end architecture;
