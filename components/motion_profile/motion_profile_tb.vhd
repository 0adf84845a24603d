-- SPDX-License-Identifier: BSD-3-Clause
--
-- motion_profile, without smoothing and with the mean of 16 periods. In each period the speed, the acceleration and,
-- with smoothing, the jerk keep their limits, and no target is passed. Motions are long, short, back, changed on the
-- way, and over the wrap of the position. It starts where the feedback is, and tells once that it has arrived.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity motion_profile_tb is
end entity;

architecture test of motion_profile_tb is

  constant clock_period : time := 20 ns;
  constant period       : positive := 20; -- clocks of a loop

  signal clock    : std_ulogic := '0';
  signal reset    : std_ulogic := '1';
  signal done     : boolean_vector(0 to 1) := (others => false);
  signal all_done : boolean := false;

begin

  all_done <= done = (true, true);
  clock    <= not clock after clock_period / 2 when not all_done;
  reset    <= '0' after 8 * clock_period;

  cases : for number in 0 to 1 generate

    constant smooth_bits : natural := 4 * number;

    signal m2s          : wishbone_m2s_t := wishbone_m2s_idle;
    signal s2m          : wishbone_s2m_t;
    signal feedback     : wire_t := wire_of(to_signed(0, 32));
    signal position     : wire_t;
    signal velocity     : wire_t;
    signal acceleration : wire_t;
    signal arrived      : std_ulogic;
    signal arrivals     : natural := 0;
    signal goal         : integer := 0;
    signal is_free      : boolean := true;  -- the target was changed so that it may be passed, or it is at the feedback
    signal most         : natural := 0;     -- the highest speed, in 1/256 count a period
    signal ramp         : natural := 0;     -- the acceleration, in 1/2**24 count a period squared

  begin

    dut : entity work.motion_profile
      generic map (clock_hz => 50_000_000, loop_hz => 50_000_000 / period, smooth_bits => smooth_bits)
      port map (
        clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrived => arrived,
        feedback_wire => feedback, position_wire => position, velocity_wire => velocity,
        acceleration_wire => acceleration);

    monitor : entity work.wishbone_monitor
      port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

    count_arrivals : process (clock) is
    begin
      if rising_edge(clock) and arrived = '1' then
        arrivals <= arrivals + 1;
      end if;
    end process;

    -- The limits, at each change. All three change in one clock.
    watch : process (position, velocity, acceleration) is
      variable before, now, rate, rate_before : integer := 0;
      variable reach  : integer;
      variable change, change_before : integer := 0;
    begin
      now    := to_integer(value_of(position));
      rate   := to_integer(value_of(velocity));
      change := to_integer(value_of(acceleration));
      if not is_free then
        check(abs rate <= most, "the highest speed: " & to_string(rate));
        check(abs change <= ramp, "the acceleration: " & to_string(change));
        check(abs (rate - rate_before) <= ramp / 2 ** 16 + 1, "the velocity jumps");
        check(abs (now - before) <= most / 256 + 1, "the position jumps: " & to_string(now - before));
        reach := ramp / 2 ** smooth_bits + 1;
        check(smooth_bits = 0 or abs (change - change_before) <= 2 * reach, "the jerk: " &
              to_string(change - change_before));
        -- towards the goal, and never beyond
        check((goal - now) * (goal - before) >= 0, "it has passed the target");
      end if;
      before        := now;
      rate_before   := rate;
      change_before := change;
    end process;


    master : process is

      variable clocks, count : natural;

      procedure put (address : natural; value : integer) is
      begin
        bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
      end procedure;

      procedure see (address : natural; value : integer) is
      begin
        bus_expect(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
      end procedure;

      procedure limits (speed, rise : natural) is -- in 1/2**24 count
      begin
        put(3, speed);
        put(4, rise);
        most <= speed / 2 ** 16 + 1;
        ramp <= rise;
      end procedure;

      -- Goes there, and waits until it has arrived: once, and exactly there.
      procedure arrive (what : string) is
        constant first : natural := arrivals;
      begin
        clocks := 0;
        while arrivals = first loop
          wait_clocks(clock, 1);
          clocks := clocks + 1;
          check(clocks < 100_000, what & ": it does not arrive");
        end loop;
        check(to_integer(value_of(position)) = goal, what & ": it is at " &
              to_string(to_integer(value_of(position))) & ", not at " & to_string(goal));
        see(5, goal);
        see(6, 0);
        see(1, 3);
        wait_clocks(clock, 3 * period);
        check(arrivals = first + 1, what & ": it has arrived more than once");
      end procedure;

      procedure go (target : integer; what : string) is
      begin
        goal <= target;
        put(2, target);
        see(1, 1);
        arrive(what);
      end procedure;

    begin
      wait until reset = '0';
      wait_clocks(clock, 2 * period);
      see(0, 0);
      see(1, 0);

      -- It is where the feedback is, and stays there while that is not valid.
      feedback <= wire_of(to_signed(-700, 32));
      wait_clocks(clock, 2);
      check(value_of(position) = -700 and is_valid(position) = '1', "the feedback");
      see(5, -700);
      feedback <= no_wire;
      wait_clocks(clock, 2);
      wait_clocks(clock, 2 * period);
      check(value_of(position) = -700, "the last feedback");
      feedback <= wire_of(to_signed(50, 32));
      wait_clocks(clock, 3);

      -- Without limits nothing moves. Then a start is a motion, from the feedback on.
      put(2, 300);
      put(0, 1);
      feedback <= no_wire;
      wait_clocks(clock, 5 * period);
      check(value_of(position) = 50, "no limits yet");
      goal <= 300;
      limits(2 ** 26, 2 ** 20);
      is_free <= false;
      arrive("a start");

      -- A trapezoid: 64 periods up and down, and at 4 counts a period between them.
      go(1300, "a long way");
      count := clocks / period;
      check(abs (count - (250 + 64 + 2 ** smooth_bits)) < 8, "the time of a trapezoid: " & to_string(count));
      go(1290, "a short way, back");
      go(1291, "a count");
      go(1291, "no way");
      go(-900, "far back");
      limits(77_777_777, 9_999_999);
      go(5000, "fast");
      limits(12_345, 2 ** 24 - 1);
      go(5001, "slow, and an acceleration above the speed");
      limits(2 ** 25, 2 ** 17 + 13);
      go(5000 - 3333, "an odd acceleration");

      -- A new target on the way: further, nearer but still before the brakes, and behind.
      limits(2 ** 26, 2 ** 19);
      goal <= 3000;
      put(2, 3000);
      wait_clocks(clock, 200 * period);
      goal <= 4000;
      put(2, 4000);
      wait_clocks(clock, 200 * period);
      goal <= 3700;
      put(2, 3700);
      arrive("a target that changes");
      goal <= 5000;
      put(2, 5000);
      wait_clocks(clock, 200 * period);
      is_free <= true; -- it passes the target, and comes back
      goal <= 3800;
      put(2, 3800);
      arrive("a target that it has passed");
      is_free <= false;

      -- A speed of 0 brakes and rests.
      goal <= 5000;
      put(2, 5000);
      wait_clocks(clock, 200 * period);
      put(3, 0);
      is_free <= true;
      wait_clocks(clock, 200 * period);
      check(value_of(velocity) = 0 and value_of(position) > 3900 and value_of(position) < 4800, "it rests: " &
            to_string(to_integer(value_of(position))));
      see(1, 1);
      limits(2 ** 26, 2 ** 19);
      wait_clocks(clock, 2);
      is_free <= false;
      arrive("it goes on");

      -- Disabled on the way: at the feedback, in 2 clocks.
      put(2, 0);
      wait_clocks(clock, 100 * period);
      is_free <= true;
      feedback <= wire_of(to_signed(integer'high - 200, 32));
      put(0, 0);
      wait_clocks(clock, 1);
      check(value_of(position) = integer'high - 200 and value_of(velocity) = 0 and value_of(acceleration) = 0,
            "disabled");
      see(1, 0);
      -- The shorter way is over the wrap.
      put(2, integer'low + 100);
      goal <= integer'low + 100;
      put(0, 1);
      arrive("over the wrap");
      put(2, integer'high - 9);
      goal <= integer'high - 9;
      arrive("back over the wrap");

      bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
      bus_refuse(clock, m2s, s2m, '1', 5, "a write of the position");
      bus_refuse(clock, m2s, s2m, '1', 6, "a write of the velocity");
      bus_refuse(clock, m2s, s2m, '0', 7, "a read of +7");
      done(number) <= true;
      wait;
    end process;

  end generate;

  finish : process is
  begin
    wait until all_done;
    report_passed("motion_profile_tb");
    wait;
  end process;

  watchdog(all_done, clock_period * 1_000_000, "motion_profile_tb");

end architecture;
