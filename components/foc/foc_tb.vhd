-- SPDX-License-Identifier: BSD-3-Clause
--
-- foc against the same sums in real numbers: known vectors, currents, angles and targets at random, the integral and
-- its limit, trips, the clocks of a period, and a motor whose current it controls while it turns.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity foc_tb is
  generic (
    pole_pairs : positive := 7;
    period     : positive := 500; -- clocks of a loop
    seed       : positive := 1
  );
end entity;

architecture test of foc_tb is

  constant clock_period : time     := 20 ns;
  constant full         : real     := 65_536.0; -- voltage counts of half of the bus
  constant duty_most    : real     := 4095.0;

  type three_t is array (0 to 2) of real;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal tripped         : std_ulogic;
  signal trips           : natural := 0;
  signal current_a, current_b, position, target_wire : wire_t := no_wire;
  signal duty_0, duty_1, duty_2 : wire_t;
  signal changes         : natural := 0; -- of the duties
  signal clocks          : natural := 0; -- since the reset
  signal changed_at      : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.foc
    generic map (clock_hz => 50_000_000, loop_hz => 50_000_000 / period, pole_pairs => pole_pairs, current_shift => 0)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped,
      current_a_wire => current_a, current_b_wire => current_b, position_wire => position,
      target_q_wire => target_wire,
      duty_0_wire => duty_0, duty_1_wire => duty_1, duty_2_wire => duty_2);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  listen : process (clock) is
    variable last : std_ulogic_vector(98 downto 0) := (others => '0');
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if reset = '1' then
        clocks <= 0;
      end if;
      if tripped = '1' then
        trips <= trips + 1;
      end if;
      if (duty_0 & duty_1 & duty_2) /= last then
        changes    <= changes + 1;
        changed_at <= clocks;
      end if;
      last := duty_0 & duty_1 & duty_2;
      check(is_valid(duty_0) = is_valid(duty_1) and is_valid(duty_1) = is_valid(duty_2), "all are valid together");
    end if;
  end process;

  master : process is

    variable random : random_t;
    variable answer : bus_answer_t;
    variable worst_current, worst_duty : real := 0.0;
    variable a, b, kp, angle, target_d, target_q, id, iq, speed, v_d, v_q : real := 0.0;
    variable before : natural;

    procedure put (address : natural; value : integer) is
    begin
      bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    impure function duty (number : natural) return real is
    begin
      case number is
        when 0 => return real(to_integer(value_of(duty_0)));
        when 1 => return real(to_integer(value_of(duty_1)));
        when others => return real(to_integer(value_of(duty_2)));
      end case;
    end function;

    -- The three phases for a voltage, as a share of half of the bus.
    function phases_of (vd, vq, angle : real) return three_t is
      constant alpha : real := vd * cos(angle) - vq * sin(angle);
      constant beta  : real := vd * sin(angle) + vq * cos(angle);
      variable found : three_t;
      variable middle : real;
    begin
      found  := (alpha, -alpha / 2.0 + beta * sqrt(3.0) / 2.0, -alpha / 2.0 - beta * sqrt(3.0) / 2.0);
      middle := (realmax(found(0), realmax(found(1), found(2))) + realmin(found(0), realmin(found(1), found(2)))) / 2.0;
      return (found(0) - middle, found(1) - middle, found(2) - middle);
    end function;

    -- The duties for this voltage.
    procedure expect_duties (vd, vq, angle, within : real; what : string) is
      constant wanted : three_t := phases_of(vd, vq, angle);
      variable off    : real;
    begin
      for number in wanted'range loop
        off := abs (duty(number) - realmin(duty_most, realmax(-duty_most, wanted(number) * 4096.0)));
        worst_duty := realmax(worst_duty, off);
        check(off <= within, what & ": duty " & to_string(number) & " is " & to_string(duty(number), 0) & ", not " &
              to_string(wanted(number) * 4096.0, 1));
      end loop;
    end procedure;

    procedure expect_current (address : natural; value, within : real; what : string) is
      variable off : real;
    begin
      bus_read(clock, m2s, s2m, address, answer);
      off           := abs (real(to_integer(signed(answer.word))) - value);
      worst_current := realmax(worst_current, off);
      check(off <= within, what & " is " & to_string(to_integer(signed(answer.word))) & ", not " & to_string(value, 1));
    end procedure;

    procedure give (a, b, position_counts : integer) is
    begin
      current_a <= wire_of(to_signed(a, 32));
      current_b <= wire_of(to_signed(b, 32));
      position  <= wire_of(to_signed(position_counts, 32));
    end procedure;

    procedure start is
    begin
      put(0, 0);
      put(0, 1);
    end procedure;

    function electrical (counts : integer) return real is
    begin
      return real(counts) * real(pole_pairs) / 16_384.0 * math_2_pi;
    end function;

    -- The counts that are nearest to an electrical angle.
    function counts_at (angle : real) return integer is
    begin
      return integer(round(angle / math_2_pi / real(pole_pairs) * 16_384.0));
    end function;

  begin
    random.seed(seed);
    wait_clocks(clock, 8);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 6, 75_674);
    check(is_valid(duty_0) = '0', "no duty after a reset");

    -- Known vectors: currents.
    give(5000, 5000, counts_at(math_pi / 3.0));
    start;
    wait_clocks(clock, 3 * period);
    bus_expect(clock, m2s, s2m, 1, 1);
    expect_current(9, 10_000.0, 40.0, "id of 500, 500, -1000 at 60 degrees");
    expect_current(10, 0.0, 40.0, "iq of 500, 500, -1000 at 60 degrees");
    give(5000, 5000, 0);
    wait_clocks(clock, 2 * period);
    expect_current(9, 5000.0, 31.0, "alpha of 500, 500, -1000");
    expect_current(10, 8660.0, 20.0, "beta of 500, 500, -1000");

    -- Known vectors: voltages. kp is 4, and the limit is far.
    give(0, 0, 0);
    put(4, 4 * 4096);
    put(6, 131_071);
    put(8, 1);
    put(2, 16_384);
    start; -- no speed
    wait_clocks(clock, 3 * period);
    expect_duties(1.0, 0.0, 0.0, 30.0, "half of the bus at 0");
    check(abs (duty(0) / 8192.0 + 0.5 - 0.875) < 0.004 and abs (duty(1) / 8192.0 + 0.5 - 0.125) < 0.004,
          "0.875, 0.125");
    put(2, 13_107);
    give(0, 0, counts_at(math_pi / 6.0));
    start;
    wait_clocks(clock, 3 * period);
    expect_duties(0.8, 0.0, math_pi / 6.0, 30.0, "0.4 of the bus at 30 degrees");
    check(abs (duty(0) / 8192.0 + 0.5 - 0.846) < 0.004 and abs (duty(1) / 8192.0 + 0.5 - 0.5) < 0.004 and
          abs (duty(2) / 8192.0 + 0.5 - 0.154) < 0.004, "0.846, 0.5, 0.154");
    put(2, 0);
    put(3, 18_919);
    give(0, 0, 0);
    start;
    wait_clocks(clock, 3 * period);
    expect_duties(0.0, 1.1547, 0.0, 30.0, "the bus over root 3 at 90 degrees");
    check(abs (duty(0) / 8192.0) < 0.004 and abs (duty(1) / 8192.0 - 0.5) < 0.004, "0.5, 1, 0");

    -- Anything, and the limits.
    for count in 1 to 30 loop
      a        := real(random.integer_between(-12_000, 12_000));
      b        := real(random.integer_between(-12_000, 12_000));
      kp       := real(random.integer_between(0, 12_000));
      target_d := real(random.integer_between(-20_000, 20_000));
      target_q := real(random.integer_between(-20_000, 20_000));
      before   := random.integer_between(0, 16_383);
      angle    := electrical(before);
      put(2, integer(target_d));
      put(3, integer(target_q));
      put(4, integer(kp));
      put(6, 75_674);
      put(8, 1);
      give(integer(a), integer(b), before);
      start;
      wait_clocks(clock, 3 * period);
      id := a * cos(angle) + (a + 2.0 * b) / sqrt(3.0) * sin(angle);
      iq := (a + 2.0 * b) / sqrt(3.0) * cos(angle) - a * sin(angle);
      expect_current(9, id, 0.0035 * (abs a + 2.0 * abs b) + 4.0, "id");
      expect_current(10, iq, 0.0035 * (abs a + 2.0 * abs b) + 4.0, "iq");
      v_d := kp / 4096.0 * (target_d - id);
      v_d := realmax(-56_756.0, realmin(56_756.0, v_d));
      v_q := kp / 4096.0 * (target_q - iq);
      v_q := realmax(-75_674.0 + abs v_d / 2.0, realmin(75_674.0 - abs v_d / 2.0, v_q));
      expect_duties(v_d / full, v_q / full, angle,
        4096.0 / full * (kp / 4096.0 * 0.0035 * (abs a + 2.0 * abs b) * 2.5 + 0.0035 * 75_674.0) + 8.0, "at random");
    end loop;

    -- Alignment has the angle 0, whatever the encoder says.
    put(2, 4000);
    put(3, 0);
    put(4, 4096);
    put(8, 1);
    give(0, 0, 1234);
    put(0, 0);
    put(0, 3);
    wait_clocks(clock, 3 * period);
    expect_duties(4000.0 / full, 0.0, 0.0, 4.0, "alignment");
    bus_expect(clock, m2s, s2m, 11, 0);

    -- The target of a wire is that of the register no more, and limited to 16 bits.
    target_wire <= wire_of(to_signed(-4000, 32));
    put(2, 0);
    put(3, 1234);
    wait_clocks(clock, 3 * period);
    expect_duties(0.0, -4000.0 / full, 0.0, 4.0, "the target of a wire");
    bus_expect(clock, m2s, s2m, 3, std_ulogic_vector(to_signed(-4000, 32)));
    target_wire <= wire_of(to_signed(100_000, 32));
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 3, 32_767);
    target_wire <= no_wire;
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 3, 1234);
    put(2, 4000);
    put(3, 0);

    -- The offset is added to the angle.
    put(7, 16_384);
    put(0, 0);
    give(0, 0, 0);
    put(0, 1);
    wait_clocks(clock, 3 * period);
    bus_expect(clock, m2s, s2m, 11, 16_384);
    expect_duties(4000.0 / full, 0.0, math_pi / 2.0, 4.0, "an offset of a quarter");
    put(7, 0);

    -- The integral grows by ki and the error, stops at the limit, and leaves it at once.
    put(2, 0);
    put(3, 1000);
    put(4, 0);
    put(5, 65_536);
    put(8, 1);
    start;
    wait until is_valid(duty_0) = '1';
    wait_clocks(clock, 9 * period + period / 2);
    expect_duties(0.0, 10_000.0 / full, 0.0, 4.0 + 64.0, "the integral");
    wait_clocks(clock, 150 * period);
    expect_duties(0.0, 75_674.0 / full, 0.0, 30.0, "the integral at its limit");
    bus_expect(clock, m2s, s2m, 1, 3);
    put(3, -1000);
    wait_clocks(clock, 11 * period);
    check(abs duty(1) < 4096.0 * 1.05 * (75_674.0 - 8_000.0) / full, "it has left its limit: " & to_string(duty(1), 0));

    -- An input that ends trips at once, and only a start ends that.
    before := trips;
    current_b <= no_wire;
    wait_clocks(clock, 2);
    check(is_valid(duty_0) = '0', "no duty without a current");
    wait_clocks(clock, 1);
    check(trips = before + 1, "it trips once");
    bus_expect(clock, m2s, s2m, 1, 4);
    current_b <= wire_of(to_signed(0, 32));
    wait_clocks(clock, 3 * period);
    check(is_valid(duty_0) = '0', "it stays");
    start;
    wait_clocks(clock, 3 * period);
    check(is_valid(duty_0) = '1', "a new start");
    put(0, 0);
    check(is_valid(duty_0) = '0', "no duty without enable");

    -- A motor: 0.2 ohm, 100 uH, 24 V, a full scale of 32 A. kp = L * 1 kHz, ki = 4 * R * 1 kHz. It turns at
    -- 300 Hz electrical.
    put(2, 0);
    put(3, 8192); -- 8 A
    put(4, integer(0.628 * 65_536.0 / 12.0 / 1024.0 * 4096.0));
    put(5, integer(5027.0 / 100_000.0 * 65_536.0 / 12.0 / 1024.0 * 65_536.0));
    put(8, 1);
    id    := 0.0;
    iq    := 0.0;
    angle := 0.0;
    speed := math_2_pi * 300.0;
    give(0, 0, 0);
    start;
    for count in 1 to 200 loop
      before := changes;
      wait_clocks(clock, period);
      -- The voltage of the duties acts for this period.
      v_d := 12.0 / 4096.0 * (duty(0) * 2.0 - duty(1) - duty(2)) / 3.0;
      v_q := 12.0 / 4096.0 * (duty(1) - duty(2)) / sqrt(3.0);
      a   := v_d * cos(angle + speed * 5.0e-6) + v_q * sin(angle + speed * 5.0e-6);
      b   := v_q * cos(angle + speed * 5.0e-6) - v_d * sin(angle + speed * 5.0e-6);
      id  := id + 10.0e-6 * ((a - 0.2 * id) / 100.0e-6 + speed * iq);
      iq  := iq + 10.0e-6 * ((b - 0.2 * iq - speed * 0.002) / 100.0e-6 - speed * id);
      angle := angle + speed * 10.0e-6;
      give(integer(1024.0 * (id * cos(angle) - iq * sin(angle))),
           integer(1024.0 * (id * cos(angle - math_2_pi / 3.0) - iq * sin(angle - math_2_pi / 3.0))), counts_at(angle));
      if count > 150 then
        check(abs (iq - 8.0) < 0.2 and abs id < 0.2, "the motor has its current: " & to_string(id, 3) & ", " &
              to_string(iq, 3));
      end if;
    end loop;
    report "foc_tb: id " & to_string(id, 3) & " A, iq " & to_string(iq, 3) & " A; worst errors " &
           to_string(worst_current, 1) & " counts of a current, " & to_string(worst_duty, 1) & " of a duty";

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '1', 9, "a write of id");
    bus_refuse(clock, m2s, s2m, '1', 11, "a write of the angle");
    bus_refuse(clock, m2s, s2m, '0', 12, "a read of +12");

    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 3, 0);
    report_passed("foc_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * period * 2000, "foc_tb");

end architecture;
