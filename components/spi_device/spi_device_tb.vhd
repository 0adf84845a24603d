-- SPDX-License-Identifier: BSD-3-Clause
--
-- spi_device with an ICM-42688-P: set-up, samples of one moment, failures, recovery, bus errors. `program` and `values`
-- are those of devices/icm42688.ul, with a short start.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity spi_device_tb is
  generic (
    program    : string   := "";
    clock_hz   : positive := 50_000_000;
    sclk_hz    : positive := 10_000_000;
    mode       : natural  := 3;
    data_width : positive := 32;
    period_us  : positive := 300
  );
end entity;

architecture test of spi_device_tb is

  constant clock_period : time := 1 sec / clock_hz;
  constant period       : time := period_us * 1 us;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sampled, failed                 : std_ulogic := '0';
  signal select_n, sclk, mosi, miso      : std_ulogic := '1';
  signal plugged : std_ulogic := '1';
  signal truth   : std_ulogic_vector(111 downto 0) := (others => '0');
  signal frames  : natural;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.spi_device
    generic map (
      clock_hz => clock_hz, sclk_hz => sclk_hz, mode => mode, select_ns => 100, failures_most => 3,
      program => program, values => 7, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      select_n => select_n, sclk => sclk, mosi => mosi, miso => miso);

  sensor : entity work.spi_device_icm42688_model
    port map (
      plugged => plugged, truth => truth, select_n => select_n, sclk => sclk, mosi => mosi, miso => miso,
      frames => frames);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  watchdog(done, 60 ms, "spi_device_tb");

  master : process is

    variable random  : random_t;
    variable answer  : bus_answer_t;
    variable began, latest : time;
    variable stamp   : unsigned(31 downto 0);
    variable before  : natural;

    procedure read (address : natural) is
    begin
      bus_read(clock, m2s, s2m, address, answer);
    end procedure;

    procedure expect (address : natural; value : std_ulogic_vector) is
    begin
      bus_expect(clock, m2s, s2m, address, std_ulogic_vector(resize(unsigned(value), 32)));
    end procedure;

    procedure expect_values (truth : std_ulogic_vector(111 downto 0)) is
    begin
      for number in 0 to 6 loop
        expect(5 + number, truth(111 - 16 * number downto 96 - 16 * number));
      end loop;
    end procedure;

    procedure wait_for (signal event : in std_ulogic; limit : time; what : string) is
    begin
      wait until event = '1' for limit;
      check(event = '1', what);
      wait until rising_edge(clock);
    end procedure;

  begin
    random.seed(1);
    truth <= random.vector(112);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    -- The words before the first sample.
    expect(0, "1");
    expect(1, "0");
    expect(2, "0");
    bus_refuse(clock, m2s, s2m, '0', 12, "a word behind the values");
    bus_refuse(clock, m2s, s2m, '0', 32, "a word that would wrap");
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '1', 5, "a write of a value");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "0001");

    -- The set-up, then a sample each period.
    wait_for(sampled, 4 ms, "the first sample");
    began := now;
    expect(1, "11");
    expect(2, "0");
    expect_values(truth);
    read(4);
    stamp := unsigned(answer.word);
    for count in 1 to 5 loop
      truth <= random.vector(112);
      wait_for(sampled, period * 2, "a sample");
      latest := now;
      expect_values(truth);
      read(4);
      if data_width = 32 then
        check(abs(to_integer(unsigned(answer.word) - stamp) * clock_period - period) < 1.1 us, "a stamp");
        stamp := unsigned(answer.word);
      end if;
    end loop;
    check(abs(latest - began - 5 * period) < 1.1 us, "five periods");

    -- The age counts from the end of a sample.
    wait for 100 us - (now - latest);
    read(3);
    check(abs(to_integer(unsigned(answer.word)) - 100) <= 3, "the age");

    -- A block is of one sample, however long it takes. The next sample waits for its end.
    truth <= random.vector(112);
    wait_for(sampled, period * 2, "a sample");
    m2s.cyc <= '1';
    wait until rising_edge(clock);
    for number in 0 to 6 loop
      bus_read(clock, m2s, s2m, 5 + number, answer, keep => true);
      check_equal(answer.word(15 downto 0), truth(111 - 16 * number downto 96 - 16 * number), "a word of a block");
      if number = 3 then
        before := frames;
        wait for 2 * period;
        check_equal(frames, before + 3, "frames while a block is open");
      end if;
    end loop;
    m2s.cyc <= '0';
    truth <= random.vector(112);
    wait_for(sampled, 1 us, "a sample that has waited");
    wait_for(sampled, period * 2, "a sample");
    wait_for(sampled, period * 2, "a sample");
    expect_values(truth);

    -- Without the device three tries fail, then the values are no longer valid. The old ones stay.
    plugged <= '0';
    for try in 1 to 3 loop
      wait_for(failed, period * 2, "a failure");
      wait_clocks(clock, 2);
      if try < 3 then
        expect(1, "100011");
      end if;
      expect(2, std_ulogic_vector(to_unsigned(try, 8)));
      expect_values(truth);
    end loop;
    expect(1, "100000");
    wait_for(failed, 4 ms, "a failure in the set-up");
    wait_clocks(clock, 2);
    expect(2, x"04");
    expect(1, "100000");

    -- It comes back, and is set up again.
    plugged <= '1';
    truth   <= random.vector(112);
    wait_for(sampled, 6 ms, "a sample after it came back");
    expect(1, "100011");
    expect_values(truth);

    -- One failure alone changes no value: it is unplugged between the check before the values and that behind them.
    wait until falling_edge(select_n);
    wait until falling_edge(select_n);
    for bits in 1 to 60 loop
      wait until rising_edge(sclk);
    end loop;
    plugged <= '0';
    wait_for(failed, period * 2, "a failure");
    wait_clocks(clock, 2);
    expect(1, "100011");
    expect_values(truth);

    -- Stopped and started.
    bus_write(clock, m2s, s2m, 0, x"00000000");
    plugged <= '1';
    wait for 4 * period;
    expect(0, "0");
    expect(1, "100000");
    before := frames;
    wait for 2 * period;
    check_equal(frames, before, "frames while it is stopped");
    bus_write(clock, m2s, s2m, 0, x"00000001");
    wait_for(sampled, 4 ms, "a sample after the start");
    expect_values(truth);

    -- A reset at any moment ends a frame, and all begins anew.
    for count in 1 to 2 loop
      wait until falling_edge(select_n);
      wait_clocks(clock, random.integer_between(1, 3 * clock_hz / sclk_hz));
      plugged <= '0', '1' after 5 us; -- so that its frame may end anywhere
      wait_clocks(clock, 1);
      reset <= '1';
      wait_clocks(clock, 2);
      check_equal(select_n, '1', "select_n in a reset");
      reset <= '0';
      wait_for(sampled, 4 ms, "a sample after a reset");
      expect(1, "100011");
      expect_values(truth);
    end loop;

    report_passed("spi_device_tb");
    done <= true;
    wait;
  end process;

end architecture;
