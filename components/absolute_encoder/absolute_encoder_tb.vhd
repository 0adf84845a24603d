-- SPDX-License-Identifier: BSD-3-Clause
--
-- absolute_encoder with a model of each kind: readings behind a line with any delay, turns, the preset, each fault and
-- its reason, staleness, blocks, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity absolute_encoder_tb is
  generic (
    clock_hz  : positive := 50_000_000;
    kind      : natural  := 0;
    bits      : positive := 13;
    lead_bits : natural  := 0;
    tail_bits : natural  := 0;
    gray      : natural  := 1;
    sclk_hz   : positive := 1_000_000;
    sample_hz : positive := 20_000;
    zero      : integer  := 0
  );
end entity;

architecture test of absolute_encoder_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant turn         : unsigned(32 downto 0) := shift_left(to_unsigned(1, 33), bits);
  constant period       : positive := clock_hz / sample_hz;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sampled, failed         : std_ulogic;
  signal readings, losses        : natural := 0;
  signal position_wire           : wire_t;
  signal sclk, select_n, mosi, miso : std_ulogic;
  signal delay                   : time := 0 ns;
  signal position, shown         : unsigned(bits - 1 downto 0) := to_unsigned(1234 mod 2 ** minimum(bits, 20), bits);
  signal fault                   : natural := 0;
  signal frames                  : natural;
  signal clocks                  : natural := 0; -- since the reset

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.absolute_encoder
    generic map (
      clock_hz => clock_hz, kind => kind, bits => bits, lead_bits => lead_bits, tail_bits => tail_bits, gray => gray,
      zero => zero, sclk_hz => sclk_hz, sample_hz => sample_hz)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      position_wire => position_wire, sclk => sclk, select_n => select_n, mosi => mosi, miso => miso);

  device : entity work.absolute_encoder_model
    generic map (
      kind => kind, bits => bits, lead_bits => lead_bits, tail_bits => tail_bits, gray => gray,
      half_least => 0.5 sec / sclk_hz)
    port map (
      sclk => sclk, select_n => select_n, mosi => mosi, miso => miso, delay => delay, position => position,
      fault => fault, shown => shown, frames => frames);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if reset = '1' then
        clocks <= 0;
      end if;
      if sampled = '1' then
        readings <= readings + 1;
      end if;
      if failed = '1' then
        losses <= losses + 1;
      end if;
    end if;
  end process;

  master : process is

    variable answer   : bus_answer_t;
    variable expected : signed(31 downto 0);
    variable before, lost : natural;

    -- Waits for a reading that began after now. A loose line needs some.
    procedure next_reading is
      variable first : natural := readings;
    begin
      for count in 1 to 3 * period + 400 loop
        exit when readings >= first + 2;
        wait_clocks(clock, 1);
      end loop;
      check(readings >= first + 2, "no reading comes");
    end procedure;

    procedure move (by : integer) is
    begin
      position <= position + unsigned(to_signed(by, 33)(bits - 1 downto 0));
      expected := expected + by;
      next_reading;
      bus_expect(clock, m2s, s2m, 6, std_ulogic_vector(expected));
      bus_expect(clock, m2s, s2m, 5, std_ulogic_vector(resize(position, 32)));
      check(is_valid(position_wire) = '1' and value_of(position_wire) = expected, "the wire has the position");
      check(shown = position, "the device was asked");
    end procedure;

    -- A fault makes failures with this reason, and then the position not valid. It stays, and comes back.
    procedure break (number, reason : natural) is
    begin
      fault  <= number;
      lost   := losses;
      before := readings;
      wait_clocks(clock, 14 * period);
      check(losses >= lost + 3, "it fails: " & to_string(losses - lost));
      check(readings <= before + 1, "no reading counts");
      bus_expect(clock, m2s, s2m, 1, std_ulogic_vector(to_unsigned(16 * reason, 32)));
      bus_read(clock, m2s, s2m, 2, answer);
      check(unsigned(answer.word) = losses, "failures are counted");
      bus_expect(clock, m2s, s2m, 6, std_ulogic_vector(expected));
      check(is_valid(position_wire) = '0', "the wire is stale");
      bus_read(clock, m2s, s2m, 3, answer);
      check(unsigned(answer.word) > 12 * 1_000_000 / sample_hz, "the age grows");
      fault <= 0;
      wait_clocks(clock, 6 * period);
      bus_expect(clock, m2s, s2m, 1, x"00000001");
      move(3);
    end procedure;

  begin
    wait_clocks(clock, 8);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 0, 1);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 3, x"000FFFFF");
    wait_clocks(clock, 4 * period);
    next_reading;
    expected := resize(signed(position - unsigned(to_signed(zero, 33)(bits - 1 downto 0))), 32);
    bus_expect(clock, m2s, s2m, 6, std_ulogic_vector(expected));
    bus_expect(clock, m2s, s2m, 1, 1);

    -- Any position, forward and back, and over the end of a turn.
    for count in 1 to 12 loop
      if kind = 1 then -- its line may be longer than a bit
        delay <= (count mod 6) * 190 ns;
      elsif kind = 0 then
        delay <= (count mod 3) * 60 ns;
      end if;
      move(to_integer(signed(turn)) / 16 * 7 - count);
    end loop;
    for count in 1 to 6 loop
      move(-to_integer(signed(turn)) / 5 + count);
    end loop;

    -- The preset, which is the base of all further ones.
    expected := x"FFFF0001";
    bus_write(clock, m2s, s2m, 6, std_ulogic_vector(expected));
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 6, std_ulogic_vector(expected));
    move(5);

    -- The stamp is from the time of the reading, and the age is short.
    bus_read(clock, m2s, s2m, 4, answer);
    check(clocks - to_integer(unsigned(answer.word)) < 3 * period, "the stamp");
    bus_read(clock, m2s, s2m, 3, answer);
    check(unsigned(answer.word) < 3_000_000 / sample_hz, "the age");

    -- In a block no word changes, and no reading is lost.
    before := readings;
    bus_read(clock, m2s, s2m, 5, answer, keep => true);
    position <= position + 9;
    expected := expected + 9;
    for count in 1 to 60 loop
      bus_expect(clock, m2s, s2m, 5, answer.word, keep => true);
      wait_clocks(clock, period / 20);
    end loop;
    check(readings <= before + 1, "a reading waits for the end of the block");
    bus_expect(clock, m2s, s2m, 5, answer.word);
    move(0);

    if kind = 1 then
      fault <= 5;
      next_reading;
      next_reading;
      bus_expect(clock, m2s, s2m, 1, 3);
      fault <= 0;
      next_reading;
      next_reading;
      break(1, 1);
      break(2, 1);
      break(3, 2);
      break(4, 3);
    elsif kind = 0 then
      break(1, 1);
      break(2, 1);
    else
      break(1, 1);
      break(2, 1);
      break(3, 2);
      fault <= 4; -- one error: the flag is read, which clears it
      wait_clocks(clock, 3 * period);
      fault <= 0;
      wait_clocks(clock, 8 * period);
      move(1);
      -- 0 is an angle, too.
      move(to_integer(-signed(position)));
      check(position = 0, "the angle 0");
      move(-1);
    end if;

    -- Without enable it stops, and nothing is valid.
    bus_write(clock, m2s, s2m, 0, 0);
    wait_clocks(clock, 2 * period);
    before := frames;
    wait_clocks(clock, 4 * period);
    check(frames = before, "no frame without enable");
    bus_read(clock, m2s, s2m, 1, answer);
    check(answer.word(0) = '0' and is_valid(position_wire) = '0', "not valid without enable");
    bus_write(clock, m2s, s2m, 0, 1);
    move(2);

    for address in 1 to 5 loop
      bus_refuse(clock, m2s, s2m, '1', address, "a write of +" & to_string(address));
    end loop;
    bus_refuse(clock, m2s, s2m, '0', 7, "a read of +7");

    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    bus_expect(clock, m2s, s2m, 6, 0);
    bus_expect(clock, m2s, s2m, 1, 0);
    report_passed("absolute_encoder_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, period * clock_period * 600, "absolute_encoder_tb");

end architecture;
