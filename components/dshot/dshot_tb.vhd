-- SPDX-License-Identifier: BSD-3-Clause
--
-- dshot with two speed controllers: each frame that they hear, throttles, commands and their number, replies with wrong
-- rates, wrong bits and silence, staleness, rounds, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity dshot_tb is
  generic (
    clock_hz      : positive := 12_000_000;
    kbaud         : positive := 600;
    bidirectional : natural  := 1;
    frame_hz      : positive := 4000;
    seed          : positive := 1
  );
end entity;

architecture test of dshot_tb is

  constant channels     : positive := 2;
  constant clock_period : time     := 1 sec / clock_hz;
  constant round        : positive := clock_hz / frame_hz;

  constant pulls        : std_logic_vector(0 to 1) := "LH";

  type counts_t is array (0 to channels - 1) of natural;
  type frames_t is array (0 to channels - 1) of std_ulogic_vector(15 downto 0);
  type periods_t is array (0 to channels - 1) of unsigned(11 downto 0);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal sent, failed   : std_ulogic;
  signal rounds, losses : natural := 0;
  signal line_in, line_out, line_drive : std_ulogic_vector(channels - 1 downto 0);

  signal wires      : std_logic_vector(channels - 1 downto 0);
  signal frames     : frames_t;
  signal counts     : counts_t;
  signal periods    : periods_t := (others => x"FFF");
  signal bit_length : positive := 1000;
  signal silent     : boolean := false;
  signal flipped    : boolean := false;

  -- Checksum and telemetry bit as the protocol has them.
  function frame_of (value : natural; telemetry : std_ulogic := '0') return std_ulogic_vector is
    constant twelve : std_ulogic_vector(11 downto 0) := std_ulogic_vector(to_unsigned(value, 11)) & telemetry;
    variable sum    : std_ulogic_vector(3 downto 0);
  begin
    sum := twelve(11 downto 8) xor twelve(7 downto 4) xor twelve(3 downto 0);
    if bidirectional = 1 then
      sum := not sum;
    end if;
    return twelve & sum;
  end function;

  -- The speed for a period, from its definition.
  function speed_of (period : unsigned(11 downto 0)) return natural is
    constant us : natural := to_integer(period(8 downto 0)) * 2 ** to_integer(period(11 downto 9));
  begin
    if period = x"FFF" then
      return 0;
    end if;
    return minimum(65535, 4_000_000 / us);
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.dshot
    generic map (
      clock_hz => clock_hz, channels => channels, kbaud => kbaud, bidirectional => bidirectional,
      frame_hz => frame_hz, failures_most => 3)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sent => sent, failed => failed,
      line_in => line_in, line_out => line_out, line_drive => line_drive);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  controllers : for number in 0 to channels - 1 generate
    wires(number)   <= line_out(number) when line_drive(number) = '1' else 'Z';
    wires(number)   <= pulls(bidirectional);
    line_in(number) <= to_x01(wires(number));

    esc : entity work.dshot_esc_model
      generic map (bit_time => 1 ms / kbaud, bidirectional => bidirectional)
      port map (
        wire => wires(number), period => periods(number), bit_length => bit_length, silent => silent,
        flipped => flipped, frame => frames(number), frames => counts(number));
  end generate;

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if sent = '1' then
        rounds <= rounds + 1;
      end if;
      if failed = '1' then
        losses <= losses + 1;
      end if;
    end if;
  end process;

  master : process is

    variable random : random_t;
    variable raw    : natural;
    variable before, wanted, lost : natural;

    procedure next_round (count : positive := 1) is
      constant target : natural := rounds + count;
    begin
      while rounds < target loop
        wait until rising_edge(clock);
      end loop;
    end procedure;

    procedure expect_frame (channel : natural; expected : std_ulogic_vector) is
    begin
      check_equal(frames(channel), expected, "the frame of channel " & integer'image(channel));
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 3, 127 * 256); -- no reply so far

    -- The safe value is sent without a word from the bus. Known frames: 0, and below 1046 and 2047.
    next_round;
    expect_frame(0, frame_of(0));
    expect_frame(1, frame_of(0));
    if bidirectional = 1 then
      check_equal(frames(0), x"000F", "0 of the reference");
    else
      check_equal(frames(0), x"0000", "0 of the reference");
    end if;
    bus_write(clock, m2s, s2m, 0, 1046 - 47);
    bus_write(clock, m2s, s2m, 4, 2047);
    bus_expect(clock, m2s, s2m, 0, 1046 - 47);
    next_round(2);
    if bidirectional = 1 then
      check_equal(frames(0), x"82C9", "1046 of the reference");
    else
      check_equal(frames(0), x"82C6", "1046 of the reference");
      check_equal(frames(1), x"FFEE", "2047 of the reference");
    end if;
    expect_frame(1, frame_of(2047));
    check_equal(counts(0), rounds, "a frame in each round");
    before := counts(1);
    wait_clocks(clock, 9 * round);
    check(abs (counts(1) - before - 9) <= 1, "frame_hz");

    -- Throttles at any time: each frame is a whole one, and none is a command.
    for number in 1 to 8 loop
      raw := random.integer_between(0, 2100);
      wait_clocks(clock, random.integer_between(0, round));
      bus_write(clock, m2s, s2m, 0, raw mod 2048);
      next_round(2);
      raw := raw mod 2048;
      if raw > 0 then
        raw := minimum(raw, 2000) + 47;
      end if;
      expect_frame(0, frame_of(raw));
    end loop;

    -- A command is sent ten times, and only while the throttle is 0.
    bus_write(clock, m2s, s2m, 0, 0);
    next_round(2);
    bus_write(clock, m2s, s2m, 1, 21);
    bus_expect(clock, m2s, s2m, 1, 21);
    before := counts(0);
    wanted := 0;
    for number in 1 to 12 loop
      wait until counts(0) = before + number;
      wait_clocks(clock, 1);
      wanted := wanted + boolean'pos(frames(0) = frame_of(21, '1'));
      check(frames(0) = frame_of(21, '1') or frames(0) = frame_of(0), "a command or nothing");
    end loop;
    check_equal(wanted, 10, "frames of a command");
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_write(clock, m2s, s2m, 1, 48);
    next_round(2);
    expect_frame(0, frame_of(0));
    bus_write(clock, m2s, s2m, 1, 12);
    next_round(2);
    expect_frame(0, frame_of(12, '1'));
    bus_write(clock, m2s, s2m, 0, 1);
    next_round(2);
    expect_frame(0, frame_of(48));
    bus_write(clock, m2s, s2m, 0, 0);
    next_round(2);
    expect_frame(0, frame_of(0));
    bus_expect(clock, m2s, s2m, 1, 0);

    if bidirectional = 1 then
      bus_expect(clock, m2s, s2m, 2, 0);
      bus_expect(clock, m2s, s2m, 3, x"00008000");
      check_equal(losses, 0, "every reply was right");
      for number in 1 to 10 loop
        for channel in 0 to channels - 1 loop
          periods(channel) <= unsigned(random.vector(12)) or x"001";
        end loop;
        if number = 1 then
          periods(0) <= x"264"; -- 200 us
        end if;
        bit_length <= random.integer_between(975, 1025);
        next_round(2);
        for channel in 0 to channels - 1 loop
          bus_expect(clock, m2s, s2m, 4 * channel + 2, speed_of(periods(channel)));
        end loop;
      end loop;
      check_equal(losses, 0, "replies at rates that are 2.5 % wrong");
      periods(0) <= x"264";
      next_round(2);
      bus_expect(clock, m2s, s2m, 2, 20_000);

      -- Wrong bits and silence are counted. The speed stays, and turns invalid.
      for kind in 0 to 2 loop
        periods(0) <= x"3FF" when kind = 2 else x"264";
        flipped    <= kind = 0;
        silent     <= kind = 1;
        if kind = 2 then
          periods(0) <= x"200"; -- a mantissa of 0 is no period
          periods(1) <= x"200";
        end if;
        next_round;
        next_round(2);
        wait_clocks(clock, 4);
        bus_expect(clock, m2s, s2m, 2, 20_000);
        next_round(2);
        wait_clocks(clock, 4);
        check(losses > 0, "failed");
        flipped <= false;
        silent  <= false;
        periods <= (others => x"264");
        next_round(2);
      end loop;
      silent <= true;
      next_round(1);
      lost := losses;
      next_round(1);
      check_equal(losses, lost + 2, "one of each channel in a round");
      for age in 3 to 5 loop -- two frames were lost; the third makes the speed invalid
        next_round(1);
        wait_clocks(clock, 4);
        bus_expect(clock, m2s, s2m, 2, 20_000);
        bus_expect(clock, m2s, s2m, 3, age * 256 + losses / 2);
      end loop;
      silent <= false;
      next_round(2);
      bus_expect(clock, m2s, s2m, 3,
                 std_ulogic_vector(to_unsigned(32768 + losses / 2, 32)));
    end if;

    bus_refuse(clock, m2s, s2m, '1', 2, "a write of a speed");
    bus_refuse(clock, m2s, s2m, '1', 7, "a write of a reply");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read behind the last channel");

    -- A reset between two rounds: 0 is sent again.
    bus_write(clock, m2s, s2m, 4, 500);
    next_round(2);
    expect_frame(1, frame_of(547));
    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    next_round(1);
    expect_frame(1, frame_of(0));
    bus_expect(clock, m2s, s2m, 4, 0);

    report_passed("dshot_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * round * 500, "dshot_tb");

end architecture;
