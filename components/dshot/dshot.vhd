-- SPDX-License-Identifier: BSD-3-Clause
--
-- Speed controllers of brushless motors (ESC) by DShot, and their speeds back (bidirectional DShot).
--
--   +4n      throttle of channel n: 0 stops, 1 to 2000 is the throttle in 1/2000, and more is 2000
--   +4n + 1  command, 6 bits: a write of 1 to 47 sends this command so many times as the protocol asks. It reads as
--            what is still to be sent, or 0
--   +4n + 2  speed in 1/4 electrical turns per second, 0 when it stands, at most 65535          (read only)
--   +4n + 3  reply: bits 7:0 replies that were missing or wrong, it wraps, bits 14:8 frames since the last good reply,
--            at most 127, bit 15 valid: that was less than failures_most                        (read only)
--
--   out  __/‾‾‾‾‾\__/‾‾\_____/‾‾‾‾‾\_    a bit of 1, of 0, of 1: high for 3/4 or 3/8 of a bit
--
-- A frame has 16 bits: 11 of the value, one that asks for telemetry, and 4 of a checksum. Each round sends a frame to
-- one channel after the other. A throttle n is the value 47 + n, so no throttle is a command. A command is sent
-- `command_frames` times with the telemetry bit, in place of the throttle 0. A throttle that is not 0 ends it.
--
-- bidirectional 1: out and the checksum are inverted, and the line is let go behind the frame. The ESC then answers
-- with 21 bits at 5/4 of the rate, from which the speed is computed. A reply that does not begin 10 to 50 us behind the
-- frame, or that has a wrong code or checksum, counts as missing. It changes no speed.
--
-- Events    sent: a round has ended. failed: a reply was missing or wrong.
-- Latency   2 clocks per access (register_slave). A frame takes the throttle of the moment when it begins.
-- Errors    err for addresses from 4 * channels on, and for a write of a speed or a reply.
-- Reset     Throttles and commands are 0, no reply is valid. Rounds begin at once.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity dshot is
  generic (
    clock_hz       : positive                     := 50_000_000;
    channels       : positive range 1 to 8        := 4;
    kbaud          : positive range 100 to 1200   := 300;
    bidirectional  : natural range 0 to 1         := 0;
    frame_hz       : positive range 100 to 40_000 := 1000;
    command_frames : positive range 1 to 15       := 10;
    failures_most  : positive range 1 to 127      := 10;
    data_width     : positive range 16 to 32      := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sent         : out std_ulogic;
    failed       : out std_ulogic;

    line_in      : in  std_ulogic_vector(channels - 1 downto 0); -- asynchronous; unused if not bidirectional
    line_out     : out std_ulogic_vector(channels - 1 downto 0);
    line_drive   : out std_ulogic_vector(channels - 1 downto 0)
  );
end entity;

architecture rtl of dshot is

  constant bit_hz        : positive := 1000 * kbaud;
  constant bit_clocks    : positive := (clock_hz + bit_hz / 2) / bit_hz;
  constant one_clocks    : positive := (6 * bit_clocks + 4) / 8;
  constant zero_clocks   : positive := (3 * bit_clocks + 4) / 8;
  constant reply_clocks  : positive := (4 * clock_hz / 5 + bit_hz / 2) / bit_hz; -- a bit of the reply
  constant half_clocks   : positive := (reply_clocks + 1) / 2;
  constant pause_clocks  : positive := 4 * bit_clocks;
  constant clock_mhz     : positive := (clock_hz + 999_999) / 1_000_000;
  constant listen_clocks : positive := 50 * clock_mhz;
  constant heard_clocks  : positive := 40 * clock_mhz; -- the last ones: before, the line settles
  constant timer_most    : positive := maximum(pause_clocks, listen_clocks);
  constant rate_bits     : positive := phase_bits(clock_hz, frame_hz);

  constant idle_levels   : std_ulogic_vector(0 to 1) := "01";
  constant idle_level    : std_ulogic := idle_levels(bidirectional);
  constant throttle_most : positive   := 2000;
  constant first_value   : positive   := 47;        -- of DShot, plus a throttle
  constant quarter_turns : positive   := 4_000_000; -- per second, for a period of 1 us
  constant divide_bits   : positive   := 22;        -- of that
  constant reply_bits    : positive   := 21;        -- with the start bit

  subtype throttle_t is unsigned(10 downto 0);
  subtype command_t is unsigned(5 downto 0);
  subtype nibble_t is std_ulogic_vector(3 downto 0);
  subtype channel_t is natural range 0 to channels - 1;
  subtype timer_t is unsigned(bits_for(timer_most) - 1 downto 0);
  type commands_t is array (channel_t) of command_t;
  type repeats_t is array (channel_t) of unsigned(3 downto 0);
  type speeds_t is array (channel_t) of unsigned(15 downto 0);
  type ages_t is array (channel_t) of unsigned(6 downto 0);
  type failures_t is array (channel_t) of unsigned(7 downto 0);
  type state_t is (idle, loading, coding, pulse, rest, listen, receive, divide, scale, pause);

  constant valid_before : unsigned(6 downto 0) := to_unsigned(failures_most, 7);

  function writable return std_ulogic_vector is
    variable found : std_ulogic_vector(0 to 4 * channels - 1) := (others => '0');
  begin
    for channel in channel_t loop
      found(4 * channel)     := '1';
      found(4 * channel + 1) := '1';
    end loop;
    return found;
  end function;

  -- What the ESC sends for a nibble, and back. A code that does not exist is wrong.
  procedure decode (code : std_ulogic_vector(4 downto 0); nibble : out nibble_t; right : out std_ulogic) is
  begin
    right  := '1';
    case code is
      when "11001" => nibble := x"0";
      when "11011" => nibble := x"1";
      when "10010" => nibble := x"2";
      when "10011" => nibble := x"3";
      when "11101" => nibble := x"4";
      when "10101" => nibble := x"5";
      when "10110" => nibble := x"6";
      when "10111" => nibble := x"7";
      when "11010" => nibble := x"8";
      when "01001" => nibble := x"9";
      when "01010" => nibble := x"A";
      when "01011" => nibble := x"B";
      when "11110" => nibble := x"C";
      when "01101" => nibble := x"D";
      when "01110" => nibble := x"E";
      when "01111" => nibble := x"F";
      when others  => nibble := x"0"; right := '0';
    end case;
  end procedure;

  signal read_words  : word_vector_t(0 to 4 * channels - 1);
  signal write_words : word_vector_t(0 to 4 * channels - 1);
  signal written     : std_ulogic_vector(0 to 4 * channels - 1);

  signal commands : commands_t := (others => (others => '0')); -- 0: none
  signal repeats  : repeats_t  := (others => (others => '0')); -- frames of the command, less 1
  signal speeds   : speeds_t   := (others => (others => '0'));
  signal ages     : ages_t     := (others => (others => '1'));
  signal failures : failures_t := (others => (others => '0'));

  signal phase    : unsigned(rate_bits downto 0) := (others => '0'); -- its highest bit begins a round
  signal state    : state_t := idle;
  signal channel  : channel_t := 0;
  signal timer    : timer_t := (others => '0');
  signal asked    : unsigned(11 downto 0) := (others => '0'); -- a throttle, or a command with its telemetry bit
  signal is_throttle : std_ulogic := '0';
  signal frame    : std_ulogic_vector(15 downto 0); -- what is still to be sent, or the reply
  signal bits     : unsigned(4 downto 0) := (others => '0'); -- that are still to come, or steps
  signal level    : std_ulogic;                     -- of the line of this channel
  signal before   : std_ulogic := '1';              -- level, a clock ago
  signal sampled  : std_ulogic := '1';              -- level of the last bit
  signal code     : std_ulogic_vector(3 downto 0) := (others => '0'); -- the last bits of the code
  signal place    : unsigned(2 downto 0) := (others => '0');          -- in a code of five bits
  signal wrong    : std_ulogic := '0';
  signal quotient : unsigned(divide_bits - 1 downto 0) := (others => '0');
  signal rest_of  : unsigned(8 downto 0) := (others => '0');

begin

  assert clock_hz / bit_hz >= 16
    report "dshot: clock_hz must be at least 16 times the bit rate, " & integer'image(16 * bit_hz) & ", got " &
           integer'image(clock_hz)
    severity failure;
  assert channels * frame_hz * (20 + bidirectional * (18 + kbaud / 20)) <= bit_hz
    report "dshot: so many channels cannot have " & integer'image(frame_hz) & " frames a second at " &
           integer'image(kbaud) & " kbit/s"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => writable, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  words : for number in channel_t generate
    read_words(4 * number)     <= extended(write_words(4 * number)(throttle_t'range));
    read_words(4 * number + 1) <= extended(std_ulogic_vector(commands(number)));
    read_words(4 * number + 2) <= extended(std_ulogic_vector(speeds(number)));
    read_words(4 * number + 3) <= extended(
      (ages(number) ?< valid_before) & std_ulogic_vector(ages(number)) & std_ulogic_vector(failures(number)));
  end generate;

  hears : if bidirectional = 1 generate
    signal levels : std_ulogic_vector(channels - 1 downto 0);
  begin
    filter : entity work.input_filter
      generic map (width => channels)
      port map (clock => clock, reset => reset, pins => line_in, levels => levels);
    level <= levels(channel);
  end generate;

  deaf : if bidirectional = 0 generate
    level <= '1';
  end generate;

  process (clock) is
    variable throttle  : throttle_t;
    variable value     : unsigned(11 downto 0); -- with the telemetry bit
    variable bit_now   : std_ulogic;
    variable nibble    : nibble_t;
    variable is_code   : std_ulogic;
    variable remainder : unsigned(9 downto 0);
    variable speed     : unsigned(15 downto 0);
    variable good, bad : boolean; -- a reply ends
    variable forgets   : boolean; -- the command, after this frame
    variable repeating : boolean; -- a frame of the command is sent

    procedure go (to_state : state_t; clocks : positive) is
    begin
      state <= to_state;
      timer <= to_unsigned(clocks - 1, timer'length);
    end procedure;

    procedure begin_bit (data : std_ulogic) is
    begin
      line_out(channel) <= not idle_level;
      if data = '1' then
        go(pulse, one_clocks);
      else
        go(pulse, zero_clocks);
      end if;
    end procedure;

  begin
    if rising_edge(clock) then
      sent   <= '0';
      failed <= '0';
      phase  <= ('0' & phase(rate_bits - 1 downto 0)) + phase_increment(clock_hz, frame_hz);
      before <= level;
      timer  <= timer - 1;
      good      := false;
      bad       := false;
      forgets   := false;
      repeating := false;

      case state is
        when idle =>
          if phase(rate_bits) = '1' then
            channel <= 0;
            state   <= loading;
          end if;

        when loading =>
          throttle    := unsigned(write_words(4 * channel)(throttle_t'range));
          asked       <= '0' & throttle;
          is_throttle <= '0';
          state       <= coding;
          if throttle /= 0 then
            is_throttle <= '1';
            forgets     := true;
          elsif commands(channel) /= 0 then
            asked     <= "00000" & commands(channel) & '1';
            repeating := true;
            forgets   := repeats(channel) = 0;
          end if;

        when coding =>
          value := asked;
          if is_throttle = '1' then
            value := (minimum(asked(throttle_t'range), to_unsigned(throttle_most, 11)) + first_value) & '0';
          end if;
          frame <= std_ulogic_vector(value) &
                   std_ulogic_vector(value(11 downto 8) xor value(7 downto 4) xor value(3 downto 0));
          if bidirectional = 1 then
            frame(3 downto 0) <=
              not std_ulogic_vector(value(11 downto 8) xor value(7 downto 4) xor value(3 downto 0));
          end if;
          bits                <= to_unsigned(15, bits'length);
          line_drive(channel) <= '1';
          begin_bit(value(11));

        when pulse =>
          if timer = 0 then
            line_out(channel) <= idle_level;
            if frame(15) = '1' then
              go(rest, bit_clocks - one_clocks);
            else
              go(rest, bit_clocks - zero_clocks);
            end if;
          end if;

        when rest =>
          if timer = 0 then
            frame <= frame(14 downto 0) & '0';
            bits  <= bits - 1;
            if bits /= 0 then
              begin_bit(frame(14));
            elsif bidirectional = 1 then
              line_drive(channel) <= '0';
              go(listen, listen_clocks);
            else
              go(pause, pause_clocks);
            end if;
          end if;

        when listen =>
          bits    <= to_unsigned(reply_bits - 1, bits'length);
          place   <= to_unsigned(4, place'length);
          sampled <= '0'; -- so the start bit is no bit of a code
          wrong   <= '0';
          if level = '0' and timer < heard_clocks then
            go(receive, half_clocks);
          elsif timer = 0 then
            bad := true;
          end if;

        when receive =>
          if level /= before then
            go(receive, half_clocks);
          elsif timer = 0 then
            go(receive, reply_clocks);
            bit_now := level xor sampled;
            sampled <= level;
            bits    <= bits - 1;
            if bits /= reply_bits - 1 then
              code  <= code(2 downto 0) & bit_now;
              place <= place - 1;
              if place = 0 then
                place <= to_unsigned(4, place'length);
                decode(code & bit_now, nibble, is_code);
                frame <= frame(11 downto 0) & nibble;
                wrong <= wrong or not is_code;
              end if;
              if bits = 0 then
                bits     <= to_unsigned(divide_bits - 1, bits'length);
                quotient <= to_unsigned(quarter_turns, quotient'length);
                rest_of  <= (others => '0');
                state    <= divide;
              end if;
            end if;
          end if;

        -- The reply is in `frame`: 3 bits of an exponent, 9 of a mantissa, and the checksum.
        when divide =>
          remainder := rest_of & quotient(quotient'high);
          quotient  <= quotient(quotient'high - 1 downto 0) & '0';
          rest_of   <= remainder(8 downto 0);
          if remainder >= unsigned(frame(12 downto 4)) then
            quotient(0) <= '1';
            rest_of     <= resize(remainder - unsigned(frame(12 downto 4)), rest_of'length);
          end if;
          bits <= bits - 1;
          if bits = 0 then
            bits  <= resize(unsigned(frame(15 downto 13)), bits'length);
            state <= scale;
            if wrong = '1' or unsigned(frame(12 downto 4)) = 0 or
               (frame(15 downto 12) xor frame(11 downto 8) xor frame(7 downto 4) xor frame(3 downto 0)) /= x"F" then
              bad := true;
            end if;
          end if;

        when scale =>
          quotient <= '0' & quotient(quotient'high downto 1);
          bits     <= bits - 1;
          if bits = 0 then
            good := true;
          end if;

        when pause =>
          if timer = 0 then
            line_drive(channel) <= '1';
            state               <= loading;
            if channel = channels - 1 then
              state <= idle;
              sent  <= '1';
            else
              channel <= channel + 1;
            end if;
          end if;
      end case;

      if good or bad then
        go(pause, pause_clocks);
        failed <= '1' when bad else '0';
      end if;

      speed := quotient(15 downto 0);
      if (or quotient(quotient'high downto 16)) = '1' then
        speed := (others => '1');
      end if;
      if (and frame(15 downto 4)) = '1' then
        speed := (others => '0'); -- the longest period means that it stands
      end if;

      -- Each number is compared, because GHDL 2.0 takes an array with an index for a memory, and cannot make it.
      for number in channel_t loop
        if number = channel then
          if forgets then
            commands(number) <= (others => '0');
          end if;
          if repeating then
            repeats(number) <= repeats(number) - 1;
          end if;
          if bidirectional = 1 and good then
            ages(number)   <= (others => '0');
            speeds(number) <= speed;
          elsif bidirectional = 1 and bad then
            failures(number) <= failures(number) + 1;
            if (nand ages(number)) = '1' then
              ages(number) <= ages(number) + 1;
            end if;
          end if;
        end if;
        if written(4 * number + 1) = '1' then
          commands(number) <= (others => '0');
          repeats(number)  <= to_unsigned(command_frames - 1, repeats(number)'length);
          if unsigned(write_words(4 * number + 1)(command_t'range)) <= first_value then
            commands(number) <= unsigned(write_words(4 * number + 1)(command_t'range));
          end if;
        end if;
      end loop;

      if reset = '1' then
        phase      <= (others => '0');
        state      <= idle;
        commands   <= (others => (others => '0'));
        speeds     <= (others => (others => '0'));
        ages       <= (others => (others => '1'));
        failures   <= (others => (others => '0'));
        sent       <= '0';
        failed     <= '0';
        line_out   <= (others => idle_level);
        line_drive <= (others => '1');
      end if;
    end if;
  end process;

end architecture;
