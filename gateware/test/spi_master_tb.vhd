-- SPDX-License-Identifier: BSD-3-Clause
--
-- spi_master with a device that answers as late as it may: bytes in both directions, frames, and the rate of the clock.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.sequencer_pkg.all;

entity spi_master_tb is
  generic (
    mode    : natural range 0 to 3 := 0;
    sclk_hz : positive := 2_000_000;
    seed    : positive := 1
  );
end entity;

architecture test of spi_master_tb is

  constant clock_hz     : positive := 20_000_000;
  constant clock_period : time := 50 ns;
  constant select_time  : time := 200 ns;
  constant at_rest      : std_ulogic := to_bit(mode >= 2);

  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal done    : boolean := false;
  signal request : bus_request_t := (go => '0', first => '0', last => '0', receive => '0', data => x"00");
  signal reply   : bus_reply_t;
  signal select_n, sclk, mosi : std_ulogic := '1';
  signal miso    : std_ulogic := '0';
  signal answer  : byte_t := x"00"; -- that the device gives to the next byte
  signal heard   : byte_t := x"00"; -- that it got
  signal bytes   : natural := 0;    -- of this frame

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.spi_master
    generic map (clock_hz => clock_hz, sclk_hz => sclk_hz, mode => mode, select_ns => 200)
    port map (
      clock => clock, reset => reset, request => request, reply => reply,
      select_n => select_n, sclk => sclk, mosi => mosi, miso => miso);

  watchdog(done, 20 ms, "spi_master_tb");

  device : process is
    variable shifted  : byte_t;
    variable bits     : natural := 0;
    variable rose     : time := -1 sec;
    variable selected : time := -1 sec;
    variable released : time := -1 sec;
    variable clocked  : time := -1 sec;
    variable leading  : boolean;
    variable delay    : time;
  begin
    delay := 1 sec / sclk_hz / 2 + 0.9 * clock_period; -- almost until the master takes it
    wait on select_n, sclk, answer;
    if now > 1 us then
      if answer'event and not select_n'event then -- the first bit of a byte shows before its first edge
        if mode mod 2 = 0 and bits mod 8 = 0 then
          miso <= answer(7);
        end if;
      elsif falling_edge(select_n) then
        check(now - released >= select_time, "the pause between frames");
        check_equal(sclk, at_rest, "sclk when a frame begins");
        selected := now;
        bits     := 0;
        if mode mod 2 = 0 then
          miso <= answer(7) after 20 ns;
        end if;
      elsif rising_edge(select_n) then
        check(now - clocked >= select_time, "the pause behind the last edge");
        check_equal(sclk, at_rest, "sclk when a frame ends");
        check(bits mod 8 = 0 and bits > 0, "whole bytes in a frame");
        released := now;
      elsif sclk'event then
        check_equal(select_n, '0', "select_n at an edge of sclk");
        check(now - selected >= select_time, "the pause before the first edge");
        check(now - clocked >= (1 sec / sclk_hz) / 2 - 1 ns, "half a period of sclk");
        clocked := now;
        leading := sclk /= at_rest;
        if leading = (mode mod 2 = 0) then
          shifted := shifted(6 downto 0) & mosi;
          bits    := bits + 1;
          heard   <= shifted;
          bytes   <= bits / 8;
        end if;
        if leading = (mode mod 2 = 1) then
          miso <= transport answer(7 - bits mod 8) after delay;
        end if;
        if leading then
          check(now - rose >= 1 sec / sclk_hz - 1 ns, "a period of sclk");
          rose := now;
        end if;
      end if;
    end if;
  end process;

  play : process is
    variable random : random_t;
    variable sent   : byte_t;
    variable length : positive;
  begin
    random.seed(seed);
    wait_clocks(clock, 4);
    reset <= '0';
    wait for 2 us;
    check_equal(select_n, '1', "select_n at rest");
    for frame in 1 to 30 loop
      length := random.integer_between(1, 4);
      for number in 1 to length loop
        sent   := random.vector(8);
        answer <= random.vector(8);
        wait_clocks(clock, random.integer_between(1, 3));
        request <= (
          go => '1', first => to_bit(number = 1), last => to_bit(number = length), receive => '0',
          data => sent);
        wait_clocks(clock, 1);
        request.go <= '0';
        wait until rising_edge(clock) and reply.done = '1' for 100 us;
        check_equal(reply.data, answer, "the reply");
        check_equal(reply.failed, '0', "failed");
        check_equal(heard, sent, "the byte");
        check_equal(bytes, number, "bytes of the frame");
        check_equal(select_n, to_bit(number = length), "select_n behind a byte");
      end loop;
    end loop;
    report_passed("spi_master_tb");
    done <= true;
    wait;
  end process;

end architecture;
