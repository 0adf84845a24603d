-- SPDX-License-Identifier: BSD-3-Clause
--
-- rc_receiver: whole frames of PPM and of S.Bus give their channels, broken ones nothing but a count; repeated values,
-- failsafe and silence end `valid`; a block of accesses sees one frame.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity rc_receiver_tb is
  generic (
    clock_hz : positive := 8_000_000;
    protocol : natural  := 1;
    channels : positive := 16;
    inverted : natural  := 1;
    lost_us  : natural  := 1500;
    seed     : positive := 1
  );
end entity;

architecture test of rc_receiver_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant timeout_ms   : positive := 60;
  constant bit_time     : time     := 10 us;
  constant oldest       : natural  := 2 ** 20 - 1;
  constant state_word   : natural  := channels;
  constant age_word     : natural  := channels + 1;
  constant rest_level   : std_ulogic := to_bit((protocol = 0) = (inverted = 1)); -- S.Bus rests low if it is inverted

  type values_t is array (0 to 15) of natural;
  type bytes_t is array (natural range <>) of std_ulogic_vector(7 downto 0);

  constant known : bytes_t(0 to 24) := (
    x"0F", x"AC", x"00", x"DF", x"C4", x"01", x"08", x"40", x"00", x"02", x"10", x"80", x"00", x"04", x"20", x"00",
    x"01", x"08", x"40", x"00", x"02", x"10", x"80", x"00", x"00");

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;
  signal line  : std_ulogic := rest_level;

  signal frame, failed     : std_ulogic;
  signal arrivals, losses  : natural := 0; -- events

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.rc_receiver
    generic map (
      clock_hz => clock_hz, protocol => protocol, channels => channels, inverted => inverted, timeout_ms => timeout_ms,
      lost_us => lost_us, filter_ns => 1000)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, frame => frame, failed => failed,
      line => line);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if frame = '1' then
        arrivals <= arrivals + 1;
      end if;
      if failed = '1' then
        losses <= losses + 1;
      end if;
    end if;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  master : process is

    variable random         : random_t;
    variable values         : values_t := (others => 0); -- that are expected, in 1/8 us
    variable frames, broken, repeats : natural := 0;
    variable is_valid       : boolean := false;

    procedure read (address : natural; value : out natural; keep : boolean := false) is
      variable got : bus_answer_t;
    begin
      bus_read(clock, m2s, s2m, address, got, keep => keep);
      check(not got.refused, "a read");
      value := to_integer(unsigned(got.word));
    end procedure;

    procedure expect_channel (number : natural; keep : boolean := false) is
      variable got : natural;
    begin
      read(number, got, keep);
      if not is_valid then
        check_equal(got, 8 * lost_us, "a channel that is not valid");
      elsif protocol = 1 then
        check_equal(got, values(number), "channel " & integer'image(number));
      else
        check(abs (got - values(number)) <= 2 + values(number) / 2000,
              "channel " & integer'image(number) & ": " & integer'image(got) & " is not "
              & integer'image(values(number)));
      end if;
    end procedure;

    -- All words.
    procedure expect (flags : natural; what : string) is
      variable got : natural;
    begin
      for number in 0 to channels - 1 loop
        expect_channel(number);
      end loop;
      read(state_word, got);
      check_equal(got, flags + boolean'pos(is_valid), what & ": the state");
      read(age_word, got);
      check((got = oldest) /= is_valid, what & ": the age");
      read(channels + 2, got);
      check_equal(got, frames, what & ": fresh frames");
      read(channels + 3, got);
      check_equal(got, broken, what & ": broken frames");
      read(channels + 4, got);
      check_equal(got, repeats, what & ": frames that repeat");
      check_equal(arrivals, frames, what & ": each fresh frame has its event");
    end procedure;

    procedure hold (level : std_ulogic; length : time) is
    begin
      line <= level;
      wait for length;
    end procedure;

    procedure rest (length : time) is
    begin
      hold(rest_level, length);
      wait until rising_edge(clock);
    end procedure;

    -- A character of S.Bus.
    procedure send (byte : std_ulogic_vector(7 downto 0); wrong_parity, no_stop : boolean := false) is
    begin
      hold(not rest_level, bit_time);
      for place in 0 to 7 loop
        hold(not (byte(place) xor rest_level), bit_time);
      end loop;
      hold(not ((xor byte) xor to_bit(wrong_parity) xor rest_level), bit_time);
      hold(rest_level xor to_bit(no_stop), bit_time);
      hold(rest_level, bit_time);
    end procedure;

    function bytes_of (words : values_t; flags : std_ulogic_vector(7 downto 0)) return bytes_t is
      variable bits  : std_ulogic_vector(175 downto 0);
      variable found : bytes_t(0 to 24) := (0 => x"0F", 23 => flags, others => x"00");
    begin
      for number in words'range loop
        bits(11 * number + 10 downto 11 * number) := std_ulogic_vector(to_unsigned(words(number), 11));
      end loop;
      for place in 0 to 21 loop
        found(1 + place) := bits(8 * place + 7 downto 8 * place);
      end loop;
      return found;
    end function;

    procedure send (bytes : bytes_t) is
    begin
      for place in bytes'range loop
        send(bytes(place));
      end loop;
    end procedure;

    -- An edge that counts, and the time until the next one, in us.
    procedure pulse (distance : positive) is
    begin
      hold(not rest_level, 300 us);
      hold(rest_level, (distance - 300) * 1 us);
    end procedure;

    -- A frame of any channels, and what comes behind it until it is taken.
    procedure send_frame (flags, last : std_ulogic_vector(7 downto 0) := x"00") is
      variable words : values_t;
      variable bytes : bytes_t(0 to 24);
      variable fresh : boolean;
    begin
      fresh := flags(3 downto 2) = "00";
      for number in words'range loop
        words(number) := random.integer_between(0, 2047);
        if protocol = 0 then
          words(number) := random.integer_between(720, 2280);
        end if;
      end loop;
      if protocol = 1 then
        bytes     := bytes_of(words, flags);
        bytes(24) := last;
        send(bytes);
        rest(20 * clock_period);
      else
        for number in 0 to channels - 1 loop
          pulse(words(number));
        end loop;
        pulse(2600);
        rest(200 us);
      end if;
      if fresh then
        frames   := frames + 1;
        is_valid := true;
        for number in words'range loop
          values(number) := 5 * words(number) + 7040;
          if protocol = 0 then
            values(number) := 8 * words(number);
          end if;
        end loop;
      end if;
      if flags(3) = '1' then
        is_valid := false;
      end if;
      if flags(2) = '1' then
        repeats := repeats + 1;
      end if;
    end procedure;

    variable first, second, before : natural;
    variable bytes : bytes_t(0 to 24);

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    expect(0, "after the reset");
    rest(4 ms);

    -- Whole frames.
    for round in 1 to 6 loop
      send_frame;
      read(age_word, first);
      check(first < 300, "the age of a fresh frame");
      rest(1 ms);
      read(age_word, second);
      check(abs (second - first - 1000) < 10, "the age grows");
      expect(0, "a whole frame");
      rest(2 ms);
    end loop;

    -- In a block all is of one frame.
    expect_channel(0, keep => true);
    is_valid := true;
    first    := values(channels - 1);
    before   := arrivals;
    send_frame;
    check_equal(arrivals, before, "no frame is taken within a block");
    second               := values(channels - 1);
    values(channels - 1) := first;
    expect_channel(channels - 1);
    wait_clocks(clock, 4);
    values(channels - 1) := second;
    expect(0, "behind the block");
    rest(3 ms);

    if protocol = 1 then
      -- The known frame.
      send(known);
      rest(1 ms);
      frames := frames + 1;
      values := (0 => 172 * 5 + 7040, 1 => 992 * 5 + 7040, 2 => 1811 * 5 + 7040, others => 1024 * 5 + 7040);
      expect(0, "the known frame");

      -- The ends of S.Bus 2, and the switches.
      for last in 0 to 3 loop
        send_frame(std_ulogic_vector(to_unsigned(last, 8)), std_ulogic_vector(to_unsigned(16 * last + 4, 8)));
        expect(8 * last, "an end of S.Bus 2");
        rest(1 ms);
      end loop;

      -- Broken frames.
      for kind in 0 to 6 loop
        bytes := known;
        for place in bytes'range loop
          if kind = 0 and place = 9 then
            send(bytes(place), wrong_parity => true);
          elsif kind = 1 and place = 13 then
            send(bytes(place), no_stop => true);
          elsif kind = 2 and place = 0 then
            send(x"0E");
          elsif kind = 3 and place = 24 then
            send(x"01");
          elsif kind = 4 and place = 24 then
            null; -- it is a byte too short
          elsif kind = 5 and place = 0 then
            send(bytes(place), wrong_parity => true);
          elsif kind = 6 and place = 24 then
            send(bytes(place), wrong_parity => true);
          else
            send(bytes(place));
          end if;
        end loop;
        rest(1 ms);
        broken := broken + 1;
        expect(24, "a broken frame of S.Bus, " & integer'image(kind));
      end loop;

      -- A pause in the frame breaks it, and the rest of it is no frame either.
      send(known(0 to 11));
      rest(700 us);
      send(known(12 to 24));
      rest(1 ms);
      broken := broken + 2;
      expect(24, "a pause");

      -- A frame does not begin in the midst of characters, though 0F is there.
      send(x"55");
      send(known);
      rest(1 ms);
      broken := broken + 1;
      expect(24, "a character before the frame");
      send_frame;
      send(x"0F");
      rest(1 ms);
      expect(0, "a character behind the frame is not looked at");

      -- What the receiver repeats is not taken, and does not make it young.
      read(age_word, first);
      send_frame(x"04");
      expect(2, "a frame that repeats");
      read(age_word, second);
      check(second > first + 2900, "the age goes on");
      rest(1 ms);
      send_frame(x"00");
      expect(0, "a fresh one again");
      rest(1 ms);

      -- Failsafe.
      before := losses;
      send_frame(x"0C");
      expect(6, "failsafe");
      check_equal(losses, before + 1, "it fails");
      rest(1 ms);
      send_frame(x"08");
      expect(4, "failsafe goes on");
      check_equal(losses, before + 1, "it fails once");
      rest(1 ms);
      send_frame(x"04");
      expect(2, "repeated values do not end a failsafe");
      rest(1 ms);
    else
      -- Broken frames.
      for kind in 0 to 4 loop
        for number in 0 to channels - 1 loop
          if number = 1 and kind = 0 then
            pulse(690);
          elsif number = 1 and kind = 1 then
            pulse(2310);
          elsif number = 1 and kind = 2 then
            hold(not rest_level, 300 us);
            hold(rest_level, 400 us);
            hold(not rest_level, 2 us); -- a spike that is longer than the filter
            hold(rest_level, 798 us);
          elsif number = 1 and kind = 3 then
            null; -- one channel too few
          else
            pulse(1500);
          end if;
        end loop;
        if kind = 4 then
          pulse(1500); -- one too many
        end if;
        pulse(2650);
        rest(200 us);
        broken := broken + 1;
        expect(0, "a broken frame of PPM, " & integer'image(kind));
      end loop;

      -- A spike that the filter takes out.
      values := (others => 8 * 1500);
      for number in 0 to channels - 1 loop
        hold(not rest_level, 300 us);
        hold(rest_level, 400 us);
        hold(not rest_level, 800 ns);
        hold(rest_level, 800 us - 800 ns);
      end loop;
      pulse(2650);
      rest(200 us);
      frames := frames + 1;
      expect(0, "spikes");
    end if;

    -- Silence.
    send_frame;
    before := losses;
    rest((timeout_ms - 1) * 1 ms);
    expect(0, "before the timeout");
    rest(1200 us);
    is_valid := false;
    expect(0, "behind the timeout");
    check_equal(losses, before + 1, "it fails");
    rest(5 ms);
    expect(0, "silence");
    check_equal(losses, before + 1, "it fails once");
    send_frame;
    expect(0, "the pilot is back");

    for address in 0 to channels + 4 loop
      bus_refuse(clock, m2s, s2m, '1', address, "a write");
    end loop;
    bus_refuse(clock, m2s, s2m, '0', channels + 5, "a read behind the last word");
    bus_refuse(clock, m2s, s2m, '0', 32, "a read of +32");

    reset <= '1';
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);
    for number in 0 to channels - 1 loop
      bus_expect(clock, m2s, s2m, number, 8 * lost_us);
    end loop;
    bus_expect(clock, m2s, s2m, state_word, 0);
    for address in channels + 2 to channels + 4 loop
      bus_expect(clock, m2s, s2m, address, 0);
    end loop;

    report_passed("rc_receiver_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 2 sec, "rc_receiver_tb");

end architecture;
