-- SPDX-License-Identifier: BSD-3-Clause
--
-- ws2812: frames and their times, what is asked for meanwhile, dark, the memory while a frame is sent, errors, reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity ws2812_tb is
  generic (
    clock_hz : positive := 50_000_000;
    leds     : positive := 5;
    channels : positive := 3;
    reset_us : positive := 280;
    seed     : positive := 1
  );
end entity;

architecture test of ws2812_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant colour_bits  : positive := 8 * channels;
  constant bits         : positive := leds * colour_bits;
  constant frame_time   : time     := bits * 1350 ns + reset_us * 1 us + 60 us;

  subtype colour_t is std_ulogic_vector(colour_bits - 1 downto 0);
  type colours_t is array (0 to leds - 1) of colour_t;

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '1';
  signal m2s    : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m    : wishbone_s2m_t;
  signal done   : boolean := false;
  signal sent   : std_ulogic;
  signal ends   : natural := 0; -- events
  signal data   : std_ulogic;
  signal shown  : std_ulogic_vector(bits - 1 downto 0);
  signal frames : natural;
  signal cut    : boolean := false; -- a reset cuts a frame

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.ws2812
    generic map (clock_hz => clock_hz, leds => leds, channels => channels, reset_us => reset_us)
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sent => sent, data => data);

  strip : entity work.ws2812_strip_model
    generic map (bits => bits, pause_time => reset_us * 1 us)
    port map (data => data, done => done, cut => cut, shown => shown, frames => frames);

  listen : process (clock) is
  begin
    if rising_edge(clock) and sent = '1' then
      ends <= ends + 1;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random  : random_t;
    variable colours : colours_t := (others => (others => '0'));
    variable before  : natural;
    variable number  : natural;

    procedure write_colour (index : natural) is
    begin
      colours(index) := random.vector(colour_bits);
      bus_write(clock, m2s, s2m, 2 + index, std_ulogic_vector(resize(unsigned(colours(index)), 32)));
    end procedure;

    procedure expect_colour (index : natural) is
    begin
      bus_expect(clock, m2s, s2m, 2 + index, std_ulogic_vector(resize(unsigned(colours(index)), 32)));
    end procedure;

    procedure expect_busy (busy : natural) is
    begin
      bus_expect(clock, m2s, s2m, 1, busy);
    end procedure;

    impure function all_colours return std_ulogic_vector is
      variable found : std_ulogic_vector(bits - 1 downto 0);
    begin
      for index in 0 to leds - 1 loop
        found(bits - 1 - index * colour_bits downto bits - (index + 1) * colour_bits) := colours(index);
      end loop;
      return found;
    end function;

    -- Waits until nothing is sent. So many frames have come.
    procedure settle (count : positive) is
      constant first : natural := frames;
      constant told  : natural := ends;
    begin
      expect_busy(1);
      wait until ends > told for (count + 1) * frame_time;
      check_equal(ends, told + 1, "the end is told once");
      wait until rising_edge(clock);
      expect_busy(0);
      check_equal(frames, first + count, "so many frames");
    end procedure;

  begin
    random.seed(seed);
    check_equal(data, '0', "the line is low from power-up on");
    wait for 5 * clock_period;
    wait until rising_edge(clock);
    reset <= '0';

    -- The first frame is dark.
    settle(1);
    check_equal(shown, (shown'range => '0'), "a strip is dark behind a reset");
    bus_expect(clock, m2s, s2m, 0, 0);
    for index in 0 to leds - 1 loop
      expect_colour(index);
      write_colour(index);
    end loop;
    wait for frame_time;
    expect_busy(0);
    check_equal(frames, 1, "a colour alone sends nothing");

    -- Without `on` it stays dark, and with it all colours are shown.
    bus_write(clock, m2s, s2m, 1, 0);
    settle(1);
    check_equal(shown, (shown'range => '0'), "a strip that is not on is dark");
    bus_write(clock, m2s, s2m, 0, std_ulogic_vector'(x"FFFFFFFF"));
    settle(1);
    check_equal(shown, all_colours, "the colours");
    bus_expect(clock, m2s, s2m, 0, 1);

    -- Accesses all the time, at each distance from a bit, change no frame.
    for frame in 1 to 4 loop
      for index in 0 to leds - 1 loop
        write_colour(index);
      end loop;
      bus_write(clock, m2s, s2m, 1, frame);
      before := ends;
      while ends = before loop
        number := random.integer_between(0, leds - 1);
        expect_colour(number);
        if random.chance(30) then
          wait_clocks(clock, random.integer_between(0, 5));
        end if;
      end loop;
      check_equal(shown, all_colours, "the colours while the bus reads");
      expect_busy(0);
    end loop;

    -- What is asked for meanwhile comes in another frame, and more than one request in one.
    bus_write(clock, m2s, s2m, 1, 1);
    wait for bits * 600 ns;
    for index in 0 to leds - 1 loop
      write_colour(index);
    end loop;
    bus_write(clock, m2s, s2m, 1, 1);
    wait for 10 us;
    bus_write(clock, m2s, s2m, 1, 1);
    settle(2);
    check_equal(shown, all_colours, "the colours that were written last");

    -- Dark, and back.
    bus_write(clock, m2s, s2m, 0, 0);
    settle(1);
    check_equal(shown, (shown'range => '0'), "dark");
    for index in 0 to leds - 1 loop
      expect_colour(index);
    end loop;
    bus_write(clock, m2s, s2m, 0, 1);
    wait for bits * 600 ns;
    bus_write(clock, m2s, s2m, 0, 0);
    settle(2);
    check_equal(shown, (shown'range => '0'), "dark in the middle of a frame");

    bus_refuse(clock, m2s, s2m, '1', 2 + leds, "a write behind the last LED");
    bus_refuse(clock, m2s, s2m, '0', 2 + leds, "a read behind the last LED");
    bus_refuse(clock, m2s, s2m, '1', 2, "a write of some bytes", sel => "0111");
    bus_refuse(clock, m2s, s2m, '0', 2 ** 20, "a read far behind");
    expect_busy(0);

    -- A reset between two frames keeps the colours, and sends a dark one.
    bus_write(clock, m2s, s2m, 0, 1);
    settle(1);
    check_equal(shown, all_colours, "the colours");
    reset <= '1';
    wait_clocks(clock, 3);
    reset <= '0';
    settle(1);
    check_equal(shown, (shown'range => '0'), "dark behind a reset");
    for index in 0 to leds - 1 loop
      expect_colour(index);
    end loop;

    -- A reset in a frame: the strip takes what it has, and is then dark.
    for turn in 1 to 5 loop
      bus_write(clock, m2s, s2m, 0, 1);
      wait for bits * 1250 ns * turn / 6;
      wait_clocks(clock, random.integer_between(0, 62));
      cut   <= true;
      reset <= '1';
      wait_clocks(clock, random.integer_between(1, 5));
      reset <= '0';
      settle(2);
      cut <= false;
      check_equal(shown, (shown'range => '0'), "dark behind a reset in a frame");
    end loop;

    report_passed("ws2812_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, frame_time * 60, "ws2812_tb");

end architecture;
