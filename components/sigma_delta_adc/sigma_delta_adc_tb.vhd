-- SPDX-License-Identifier: BSD-3-Clause
--
-- sigma_delta_adc with two modulators: each value against the weighted sum of the bits, known inputs, offsets, the time
-- of a trip, lost lines, the safe state, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity sigma_delta_adc_tb is
  generic (
    clock_hz     : positive := 50_000_000;
    modulator_hz : positive := 10_000_000;
    osr          : positive := 64
  );
end entity;

architecture test of sigma_delta_adc_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant half         : integer  := osr ** 3 / 2;
  constant bit_clocks   : positive := (clock_hz - 1) / modulator_hz + 1;
  constant value_clocks : positive := osr * bit_clocks;
  constant taps         : positive := 3 * osr - 2;
  -- Bits that a value has not seen: the sums follow each other by two, one comes until the event, and one is on the
  -- line.
  constant behind       : positive := 4;

  type weights_t is array (0 to taps - 1) of natural;
  type reals_t is array (0 to 1) of real;
  type faults_t is array (0 to 1) of natural;

  -- Three boxes of osr, one into the other.
  function weights return weights_t is
    variable found : weights_t := (others => 0);
  begin
    for a in 0 to osr - 1 loop
      for b in 0 to osr - 1 loop
        for c in 0 to osr - 1 loop
          found(a + b + c) := found(a + b + c) + 1;
        end loop;
      end loop;
    end loop;
    return found;
  end function;

  constant weight : weights_t := weights;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sampled, tripped, mclk, trip : std_ulogic;
  signal data        : std_ulogic_vector(1 downto 0);
  signal wire_0, wire_1, wire_2 : wire_t;
  signal level       : reals_t := (0.0, 0.0);
  signal fault       : faults_t := (0, 0);
  signal trips       : natural := 0;
  signal samples     : natural := 0;
  signal offset      : integer := 0; -- of channel 0
  signal compares    : boolean := false;
  signal compared    : natural := 0;
  signal trip_before : std_ulogic := '1';

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.sigma_delta_adc
    generic map (clock_hz => clock_hz, channels => 2, modulator_hz => modulator_hz, osr => osr)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, tripped => tripped,
      value_0_wire => wire_0, value_1_wire => wire_1, value_2_wire => wire_2, mclk => mclk, trip => trip, data => data);

  modulators : for number in 0 to 1 generate
    modulator : entity work.sigma_delta_adc_model
      port map (mclk => mclk, level => level(number), fault => fault(number), data => data(number));
  end generate;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  -- The bits as the device gave them, and what they weigh. A value comes a few clocks behind its last bit.
  listen : process (clock) is
    variable bits  : std_ulogic_vector(0 to behind + taps - 1) := (others => '0'); -- the newest first
    variable mclk_before : std_ulogic := '0';
    variable sum   : integer;
  begin
    if rising_edge(clock) then
      trip_before <= trip;
      if mclk = '1' and mclk_before = '0' then
        bits := data(0) & bits(0 to bits'high - 1);
      end if;
      mclk_before := mclk;
      if tripped = '1' then
        trips <= trips + 1;
        check(trip = '1' and is_valid(wire_0) = '0', "a trip cuts at once");
      end if;
      check(is_valid(wire_0) = not trip and is_valid(wire_1) = not trip and is_valid(wire_2) = '0',
            "the wires are valid without a trip");
      if sampled = '1' then
        samples <= samples + 1;
        if compares then
          sum := 0;
          for place in weight'range loop
            if bits(behind + place) = '1' then
              sum := sum + weight(place);
            end if;
          end loop;
          check(to_integer(value_of(wire_0)) = sum - half - offset, "a value is the weighted sum of its bits: " &
                to_string(to_integer(value_of(wire_0))) & ", not " & to_string(sum - half - offset));
          compared <= compared + 1;
        end if;
      end if;
    end if;
  end process;

  master : process is

    variable answer : bus_answer_t;
    variable began  : time;
    variable before : natural;

    procedure put (address : natural; value : integer) is
    begin
      bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_signed(value, 32)));
    end procedure;

    procedure settle (values : natural := 5) is
    begin
      wait_clocks(clock, values * value_clocks);
    end procedure;

    -- A channel has about this value.
    procedure expect (channel : natural; value : integer; within : natural) is
    begin
      bus_read(clock, m2s, s2m, 6 + channel, answer);
      check(abs (to_integer(signed(answer.word)) - value) <= within, "channel " & to_string(channel) & " has " &
            to_string(to_integer(signed(answer.word))) & ", not " & to_string(value));
    end procedure;

    procedure start is
    begin
      put(0, 0);
      check(trip = '1', "trip without enable");
      put(0, 1);
      wait_clocks(clock, 1);
      bus_expect(clock, m2s, s2m, 1, 1);
      check(trip = '0', "it runs");
    end procedure;

  begin
    wait_clocks(clock, 8);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 1, 4);
    check(trip = '1', "trip after a reset");
    settle(8);
    bus_expect(clock, m2s, s2m, 1, 0);

    -- Known inputs: an AMC1306 gives 89.06 % ones at 250 of 320 mV.
    compares <= true;
    start;
    settle;
    expect(0, 0, half / 200);
    level <= (250.0 / 320.0, -250.0 / 320.0);
    settle;
    expect(0, half * 250 / 320, half / 200);
    expect(1, -half * 250 / 320, half / 200);
    if osr = 64 then
      expect(0, 102_400, 512);
    end if;
    bus_read(clock, m2s, s2m, 3, answer);
    level <= (-0.3, 0.1);
    settle;
    expect(0, -half * 3 / 10, half / 200);
    expect(1, half / 10, half / 200);

    -- The offset is taken away, and nothing else.
    compares <= false;
    put(4, 1000);
    offset <= 1000;
    settle(2);
    compares <= true;
    settle;
    expect(0, -half * 3 / 10 - 1000, half / 200);
    bus_expect(clock, m2s, s2m, 4, 1000);
    compares <= false;
    check(compared > 10, "values were compared");

    -- The fast filter trips: a limit of half of the full scale.
    put(2, 128);
    bus_expect(clock, m2s, s2m, 2, 128);
    level <= (0.4, -0.4);
    settle;
    bus_expect(clock, m2s, s2m, 1, 1);
    wait until rising_edge(clock);
    for channel in 0 to 1 loop
      began  := now;
      before := trips;
      level(channel) <= 0.9 when channel = 0 else -0.9;
      wait until trip = '1' for 10 us;
      report "sigma_delta_adc_tb: " & to_string(now - began) & " to the trip";
      check(trip = '1' and now - began < 30 * bit_clocks * clock_period, "the time to a trip");
      level(channel) <= 0.0;
      settle;
      check(trips = before + 1 and trip = '1', "it stays");
      bus_expect(clock, m2s, s2m, 1, 2 + 16 * 2 ** channel);
      start;
    end loop;

    -- A line that is broken trips, too, and cannot be started.
    for kind in 1 to 2 loop
      for channel in 0 to 1 loop
        put(2, 0);
        before := trips;
        fault(channel) <= kind;
        wait_clocks(clock, 140 * bit_clocks + 10);
        check(trips = before + 1 and trip = '1', "a lost channel trips");
        bus_expect(clock, m2s, s2m, 1, 6 + 16 * 2 ** channel);
        put(0, 0);
        put(0, 1);
        settle;
        check(trip = '1', "a lost channel does not start");
        bus_expect(clock, m2s, s2m, 1, 6 + 16 * 2 ** channel);
        fault(channel) <= 0;
        settle(7);
        check(trip = '1', "it waits for a start");
        start;
        settle(2);
        check(trip = '0', "it runs again");
      end loop;
    end loop;

    bus_refuse(clock, m2s, s2m, '1', 1, "a write of the status");
    bus_refuse(clock, m2s, s2m, '1', 3, "a write of the stamp");
    bus_refuse(clock, m2s, s2m, '1', 6, "a write of a value");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read of +8");

    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 1);
    check(trip = '1', "a reset");
    bus_expect(clock, m2s, s2m, 2, 0);
    report_passed("sigma_delta_adc_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 300 * value_clocks * clock_period, "sigma_delta_adc_tb");

end architecture;
