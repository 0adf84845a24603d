-- SPDX-License-Identifier: BSD-3-Clause
--
-- i2c_device with an MPU-6050: set-up and samples, a device that stretches the clock, is absent, hangs the bus or holds
-- scl for too long. `program` is that of devices/mpu6050.ul, with a short start.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity i2c_device_tb is
  generic (
    program  : string   := "";
    clock_hz : positive := 8_000_000;
    seed     : positive := 1
  );
end entity;

architecture test of i2c_device_tb is

  constant clock_period : time := 1 sec / clock_hz;
  constant period       : time := 1 ms;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sampled, failed      : std_ulogic := '0';
  signal scl, sda             : std_logic;
  signal scl_drive, sda_drive : std_ulogic := '0';
  signal scl_out, sda_out     : std_ulogic;
  signal scl_in, sda_in       : std_ulogic;
  signal holds                : std_ulogic := '0'; -- somebody holds scl low
  signal plugged              : std_ulogic := '1';
  signal hung                 : std_ulogic := '0';
  signal stretch              : time := 0 ns;
  signal truth                : std_ulogic_vector(111 downto 0) := (others => '0');
  signal starts, stops        : natural;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.i2c_device
    generic map (clock_hz => clock_hz, scl_hz => 400_000, stretch_us => 50, program => program, values => 7)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      scl_in => scl_in, scl_out => scl_out, scl_drive => scl_drive,
      sda_in => sda_in, sda_out => sda_out, sda_drive => sda_drive);

  scl    <= 'H';
  sda    <= 'H';
  scl    <= scl_out when scl_drive = '1' else 'Z';
  sda    <= sda_out when sda_drive = '1' else 'Z';
  scl    <= '0' when holds = '1' else 'Z';
  scl_in <= to_x01(scl);
  sda_in <= to_x01(sda);

  sensor : entity work.i2c_device_mpu6050_model
    port map (
      plugged => plugged, hung => hung, stretch => stretch, truth => truth, scl => scl, sda => sda, starts => starts,
      stops => stops);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  watchdog(done, 80 ms, "i2c_device_tb");

  master : process is

    variable random : random_t;
    variable before : natural;

    procedure expect (address : natural; value : std_ulogic_vector) is
    begin
      bus_expect(clock, m2s, s2m, address, std_ulogic_vector(resize(unsigned(value), 32)));
    end procedure;

    procedure expect_values is
    begin
      for number in 0 to 6 loop
        expect(5 + number, truth(111 - 16 * number downto 96 - 16 * number));
      end loop;
    end procedure;

    procedure wait_for (signal event : in std_ulogic; limit : time; what : string) is
    begin
      wait until event = '1' for limit;
      check(event = '1', what);
      wait_clocks(clock, 2);
    end procedure;

  begin
    random.seed(seed);
    truth <= random.vector(112);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    expect(0, "1");
    expect(1, "0");
    bus_refuse(clock, m2s, s2m, '0', 12, "a word behind the values");
    bus_refuse(clock, m2s, s2m, '1', 3, "a write of the age");

    wait_for(sampled, 5 ms, "the first sample");
    expect(1, "11");
    expect(2, "0");
    expect_values;
    for count in 1 to 3 loop
      truth   <= random.vector(112);
      stretch <= count * 10 us; -- within what the master waits for
      wait_for(sampled, 2 * period, "a sample");
      expect_values;
    end loop;
    stretch <= 0 ns;
    expect(2, "0");
    check(starts > 8 and stops > 4, "starts and stops");

    -- Nobody acknowledges.
    plugged <= '0';
    for try in 1 to 3 loop
      wait_for(failed, 2 * period, "a failure");
      expect(2, std_ulogic_vector(to_unsigned(try, 8)));
    end loop;
    expect(1, "010000");
    expect_values;
    check_equal(scl, 'H', "scl behind a failure");
    check_equal(sda, 'H', "sda behind a failure");
    plugged <= '1';
    truth   <= random.vector(112);
    wait_for(sampled, 8 ms, "a sample after it came back");
    expect(1, "010011");
    expect_values;

    -- A device hangs and holds sda. Pulses of scl free it, and the next sample is good.
    before := starts;
    hung   <= '1', '0' after 3 * period;
    wait_for(failed, 2 * period, "a failure while sda is held");
    check_equal(sda, 'H', "sda behind the recovery");
    truth <= random.vector(112);
    wait until hung = '0';
    wait_for(sampled, 8 ms, "a sample behind the recovery");
    wait_for(sampled, 8 ms, "a sample behind the recovery");
    expect_values;

    -- Somebody holds scl for longer than the master waits.
    wait until falling_edge(scl);
    holds <= '1', '0' after period;
    wait_for(failed, 2 * period, "a failure while scl is held");
    expect(1, "010011");
    wait until holds = '0';
    truth <= random.vector(112);
    wait_for(sampled, 8 ms, "a sample after scl was held");
    wait_for(sampled, 8 ms, "a sample after scl was held");
    expect_values;

    -- A reset lets go of the lines, wherever it comes. The device may be inside a byte: pulses free it.
    for count in 1 to 2 loop
      wait until falling_edge(scl);
      wait_clocks(clock, random.integer_between(1, 400));
      hung  <= '1', '0' after 1.9 ms; -- it no longer knows that it is selected
      reset <= '1';
      wait_clocks(clock, 2);
      check_equal(scl_drive, '0', "scl in a reset");
      check_equal(sda_drive, '0', "sda in a reset");
      reset <= '0';
      wait_for(sampled, 12 ms, "a sample after a reset");
      expect_values;
    end loop;

    report_passed("i2c_device_tb");
    done <= true;
    wait;
  end process;

end architecture;
