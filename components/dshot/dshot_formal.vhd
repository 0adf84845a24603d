-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of dshot: two channels, bits of 16 clocks, a command is sent twice. A round may begin at any
-- clock, and so may the bus write.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity dshot_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    words   : in std_ulogic_vector(255 downto 0); -- shows the registers, as all of these show signals
    written : in std_ulogic_vector(7 downto 0);
    state   : in unsigned(3 downto 0);
    channel : in std_ulogic;
    waiting : in unsigned(11 downto 0);           -- the commands of both channels
    repeats : in unsigned(7 downto 0);            -- how often each is sent, less 1
    asked   : in unsigned(11 downto 0);           -- a throttle, or a command with its telemetry bit
    is_throttle : in std_ulogic;
    timer   : in unsigned(6 downto 0);
    bits    : in unsigned(4 downto 0);            -- that are still to come
    frame   : in std_ulogic_vector(15 downto 0)   -- what is still to be sent
  );
end entity;

architecture properties of dshot_formal is

  constant bit_clocks   : positive := 16;
  constant one_clocks   : positive := 12; -- high, 3/4 of a bit
  constant zero_clocks  : positive := 6;
  constant pause_clocks : positive := 4 * bit_clocks;
  constant frame_bits   : positive := 16;
  constant sent_most    : positive := 2;        -- frames of a command

  -- Places of `state` in its type.
  constant loading : natural := 1;
  constant coding  : natural := 2;
  constant pulsing : natural := 3;
  constant resting : natural := 4;
  constant pausing : natural := 9;

  subtype word_t is unsigned(10 downto 0);
  subtype frame_t is std_ulogic_vector(frame_bits - 1 downto 0);
  subtype command_t is unsigned(5 downto 0);
  type commands_t is array (0 to 1) of command_t;
  type lefts_t is array (0 to 1) of unsigned(3 downto 0);

  signal s2m                    : wishbone_s2m_t;
  signal sent, failed           : std_ulogic;
  signal line_out, line_drive   : std_ulogic_vector(1 downto 0);
  signal begun                  : std_ulogic := '0';
  signal reset_1                : std_ulogic := '1';
  signal high, high_1           : std_ulogic := '0';                   -- a line
  signal rises, falls           : std_ulogic;
  signal commands               : commands_t := (others => (others => '0')); -- that are still to be sent, or 0
  signal lefts                  : lefts_t := (others => (others => '0'));    -- how often, less 1
  signal throttle               : word_t := (others => '0');           -- when the frame began
  signal command                : command_t := (others => '0');
  signal own                    : std_ulogic := '0';                   -- the channel whose turn it is
  signal wanted                 : frame_t := (others => '0');          -- what is still to be sent
  signal count                  : natural range 0 to frame_bits := frame_bits; -- bits of the frame that have ended
  signal pulse                  : natural range 0 to one_clocks + 1 := 0; -- clocks of a high line
  signal is_one                 : std_ulogic;                          -- the pulse is a bit of 1
  signal fits                   : std_ulogic;                          -- the design is where the reference is
  signal since                  : natural range 0 to pause_clocks + bit_clocks := 0; -- clocks since it rose

  function frame_of (value : unsigned(11 downto 0)) return frame_t is
  begin
    return std_ulogic_vector(value) &
           std_ulogic_vector(value(11 downto 8) xor value(7 downto 4) xor value(3 downto 0));
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.dshot
    generic map (
      clock_hz => 1_600_000, channels => 2, kbaud => 100, frame_hz => 1000, command_frames => sent_most,
      data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sent => sent, failed => failed,
      line_in => "11", line_out => line_out, line_drive => line_drive);

  high  <= or line_out;
  rises <= high and not high_1;
  falls <= high_1 and not high;

  is_one <= '1' when pulse > zero_clocks else '0';

  watch : process (clk) is
    variable value  : unsigned(11 downto 0);
    variable number : natural range 0 to 1;
    variable now    : word_t;
    variable fresh  : command_t;
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      high_1  <= high;
      since   <= minimum(since + 1, pause_clocks + bit_clocks);
      if rises = '1' then
        since <= 1;
        pulse <= 1;
        if count = frame_bits then
          count <= 0;
        end if;
      elsif high = '1' then
        pulse <= minimum(pulse + 1, one_clocks + 1);
      end if;
      if falls = '1' then
        wanted <= wanted(frame_bits - 2 downto 0) & '0';
        count  <= minimum(count + 1, frame_bits);
      end if;

      -- A frame begins.
      number := 1 when channel = '1' else 0;
      if state = loading then
        own <= channel;
        now := unsigned(words(234 downto 224));
        if channel = '1' then
          now := unsigned(words(106 downto 96));
        end if;
        throttle <= now;
        command  <= (others => '0');
        if now = 0 then
          command <= commands(number);
        end if;
        for each in 0 to 1 loop
          if each = number and now /= 0 then
            commands(each) <= (others => '0');
          elsif each = number and commands(each) /= 0 then
            lefts(each) <= lefts(each) - 1;
            if lefts(each) = 0 then
              commands(each) <= (others => '0');
            end if;
          end if;
        end loop;
      end if;
      if state = coding then
        value := "00000" & command & '1';
        if throttle > 2000 then
          value := to_unsigned(2047, 11) & '0';
        elsif throttle /= 0 then
          value := (throttle + 47) & '0';
        elsif command = 0 then
          value := (others => '0');
        end if;
        wanted <= frame_of(value);
      end if;

      -- What the bus writes.
      for each in 0 to 1 loop
        if written(6 - 4 * each) = '1' then
          fresh          := unsigned(words(197 - 128 * each downto 192 - 128 * each));
          commands(each) <= (others => '0');
          lefts(each)    <= to_unsigned(sent_most - 1, 4);
          if fresh <= 47 then
            commands(each) <= fresh;
          end if;
        end if;
      end loop;

      if reset = '1' then
        high_1 <= '0';
        commands <= (others => (others => '0'));
        count  <= frame_bits;
        since  <= pause_clocks + bit_clocks;
      end if;
    end if;
  end process;

  -- Where the design is, and what the reference must then have.
  relate : process (all) is
    variable width : natural range 0 to one_clocks;
    variable good  : boolean;
  begin
    width := one_clocks when frame(frame_bits - 1) = '1' else zero_clocks;
    good  := waiting = commands(0) & commands(1) and repeats = lefts(0) & lefts(1);
    case to_integer(state) is
      when 0 | loading | coding =>
        good := good and count = frame_bits and since = pause_clocks + bit_clocks and line_out = "00" and high_1 = '0';
        if state = coding then
          good := good and own = channel;
        end if;
        if state = coding and is_throttle = '1' then
          good := good and throttle /= 0 and asked = throttle;
        elsif state = coding then
          good := good and throttle = 0 and asked(0) = (or command) and asked(6 downto 1) = command and
                  asked(11 downto 7) = 0;
        end if;
      when pulsing =>
        good := good and wanted = frame and bits < frame_bits and own = channel and timer < width and high = '1';
        if high_1 = '0' then
          good := good and timer = width - 1 and
                  ((bits = 15 and count = frame_bits and since = pause_clocks + bit_clocks) or
                   (bits < 15 and count = 15 - bits and since = bit_clocks));
        else
          good := good and pulse + timer = width - 1 and since = pulse and count = 15 - bits and pulse >= 1;
        end if;
      when resting =>
        good := good and bits < frame_bits and own = channel and since + timer = bit_clocks - 1 and since >= width and
                timer < bit_clocks and high = '0';
        if high_1 = '1' then
          good := good and wanted = frame and count = 15 - bits and pulse = width and since = width;
        else
          good := good and wanted = frame(frame_bits - 2 downto 0) & '0' and count = 16 - bits and since > width;
        end if;
      when pausing =>
        good := good and count = frame_bits and since + timer = pause_clocks + bit_clocks - 1 and
                since >= bit_clocks and timer < pause_clocks and high = '0' and high_1 = '0';
      when others =>
        good := false;
    end case;
    fits <= '1' when good else '0';
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A line is high only in the turn of its channel, so never both at once.
  one_line : assert always begun = '1' and high = '1' -> line_out(0) = not own and line_out(1) = own;

  -- A bit is high for 3/4 of its time, or for 3/8.
  right_width : assert always begun = '1' and reset_1 = '0' and falls = '1' ->
                         pulse = one_clocks or pulse = zero_clocks;

  -- The bits of a frame come at an even rate.
  right_rate : assert always begun = '1' and rises = '1' and count /= frame_bits -> since = bit_clocks;

  -- A frame begins at the earliest a pause of four bits behind the one before.
  pauses : assert always begun = '1' and rises = '1' and count = frame_bits -> since >= pause_clocks + bit_clocks;

  -- Each bit is that of the throttle that the register had when the frame began, at most 2000, behind the 47 commands,
  -- or of a command that was written, and has not been sent twice. All have the right checksum. So 0 stops, and no
  -- throttle is ever taken for a command.
  right_bits : assert always begun = '1' and reset_1 = '0' and falls = '1' -> wanted(frame_bits - 1) = is_one;

  -- A frame that has begun has all of its bits, but for a reset.
  whole_frame : assert always begun = '1' and state = loading -> count = frame_bits;

  -- A reset ends the pulse in the next clock.
  reset_stops : assert always begun = '1' and reset_1 = '1' -> line_out = "00";

  -- The lines are always driven.
  driven : assert always begun = '1' -> line_drive = "11" and failed = '0';

  -- The reference is where the design is. The other properties need this.
  in_place : assert always begun = '1' -> fits = '1';

  -- A command goes out.
  command_seen : cover {begun = '1' and falls = '1' and count = 0 and command = 5};

end architecture;
