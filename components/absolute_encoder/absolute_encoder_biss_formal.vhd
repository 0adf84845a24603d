-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of absolute_encoder with BiSS-C: 2 bits, half a period of 3 clocks, a pause of 10, and a
-- start bit within 40 clocks. The device may answer anything, and a reading may be asked for and accepted at any clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.absolute_encoder_pkg.all;
  use work.bit_pkg.all;

entity absolute_encoder_biss_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    ask    : in std_ulogic;
    accept : in std_ulogic;
    miso   : in std_ulogic;
    level  : in std_ulogic; -- shows miso behind the filter

    -- These show the registers of the design.
    state    : in unsigned(2 downto 0);
    stage    : in unsigned(1 downto 0);
    timer    : in unsigned(3 downto 0);
    sampler  : in unsigned(3 downto 0);
    patience : in unsigned(5 downto 0);
    left     : in unsigned(3 downto 0);
    done     : in std_ulogic;
    crc      : in std_ulogic_vector(5 downto 0);
    is_error : in std_ulogic;
    command  : in std_ulogic_vector(15 downto 0)
  );
end entity;

architecture properties of absolute_encoder_biss_formal is

  constant bits       : positive := 2;
  constant half       : positive := 3;
  constant pause      : positive := 10;
  constant answer     : positive := 40;
  constant frame_bits : positive := bits + 9;              -- a 0, position, nE, nW, and the CRC
  constant first      : positive := 3 * half - 1;          -- from the start bit to the middle of the next one
  constant last       : positive := first + 2 * half * (frame_bits - 1);
  constant frame_most : positive := answer + last + half + 2;

  -- The states and stages of the design.
  constant resting     : natural := 0;
  constant clocking    : natural := 2;
  constant ending      : natural := 3;
  constant judging     : natural := 5;
  constant acknowledge : natural := 0;
  constant start       : natural := 1;
  constant data        : natural := 2;

  subtype frame_t is std_ulogic_vector(frame_bits - 1 downto 0);
  subtype crc_t is std_ulogic_vector(5 downto 0);

  signal rests, ready, begins, ended : std_ulogic;
  signal sclk, select_n, mosi, warns : std_ulogic;
  signal reason : reason_t;
  signal value  : unsigned(bits - 1 downto 0);
  signal began  : unsigned(31 downto 0);

  signal begun   : std_ulogic := '0';
  signal reset_1 : std_ulogic := '1';
  signal sclk_1  : std_ulogic := '1';
  signal lasted  : natural range 0 to pause := 0;             -- clocks since sclk changed
  signal opened  : std_ulogic := '0';                         -- sclk has fallen in this frame
  signal spent   : natural range 0 to frame_most + 1 := 0;    -- clocks of this frame
  signal was_low : std_ulogic := '0';                         -- the device has acknowledged
  signal started : std_ulogic := '0';                         -- the start bit has come
  signal late    : std_ulogic := '0';                         -- it has not come in time
  signal since   : natural range 0 to last + 1 := 0;          -- clocks since the start bit
  signal count   : natural range 0 to frame_bits := 0;        -- bits that have come since
  signal got     : frame_t := (others => '0');                -- these, from the highest one on
  signal right_crc, too_long : std_ulogic;
  signal in_place : std_ulogic;

  -- What a register with the polynomial 43 has after the first bits of a frame, the last six of them inverted.
  function crc_after (frame : frame_t; count : natural) return crc_t is
    variable found : crc_t := (others => '0');
    variable bit_in : std_ulogic;
  begin
    for place in frame_bits - 2 downto 0 loop
      if place >= frame_bits - count then
        bit_in := frame(place) xor to_bit(place < 6);
        found  := (found(4 downto 0) & bit_in) xor ("0000" & found(5) & found(5));
      end if;
    end loop;
    return found;
  end function;

  -- The CRC of a position, nE and nW: the remainder of their polynomial times x**6.
  function crc_of (word : std_ulogic_vector(bits + 1 downto 0)) return crc_t is
    variable rest : std_ulogic_vector(bits + 7 downto 0) := (others => '0');
  begin
    rest(bits + 7 downto 6) := word;
    for place in bits + 7 downto 6 loop
      rest(place - 5) := rest(place - 5) xor rest(place); -- 43 is x**6 + x + 1
      rest(place - 6) := rest(place - 6) xor rest(place);
    end loop;
    return rest(5 downto 0);
  end function;

begin

  default clock is rising_edge(clk);

  begins <= ask and ready;

  dut : entity work.absolute_encoder_line
    generic map (clock_hz => 1_000_000, kind => 1, bits => bits, gray => 0, sclk_hz => 1_000_000, pause_us => pause)
    port map (
      clock => clk, reset => reset, rests => rests, ready => ready, begins => begins, now => x"00000000",
      ended => ended, accept => accept, reason => reason, value => value, warns => warns, began => began,
      sclk => sclk, select_n => select_n, mosi => mosi, miso => miso);

  too_long  <= to_bit(spent > frame_most);
  right_crc <= to_bit(got(5 downto 0) = not crc_of(got(bits + 7 downto 6)));

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      sclk_1  <= sclk;
      lasted  <= minimum(lasted + 1, pause);
      if sclk /= sclk_1 then
        lasted <= 1;
      end if;
      opened <= (opened or not sclk) and not rests;

      if rests = '1' then
        spent   <= 0;
        was_low <= '0';
        started <= '0';
        late    <= '0';
        since   <= 0;
        count   <= 0;
      elsif ended = '0' then
        spent <= minimum(spent + 1, frame_most + 1);
        if started = '0' then
          was_low <= was_low or not level;
          started <= was_low and level;
          late    <= late or to_bit(spent >= answer - 1);
        elsif late = '0' and count < frame_bits then
          since <= since + 1;
          if since = first + 2 * half * count then
            for place in got'range loop
              if place + count = frame_bits - 1 then
                got(place) <= level;
              end if;
            end loop;
            count <= count + 1;
          end if;
        end if;
      end if;

      if reset = '1' then
        sclk_1 <= '1';
        lasted <= 0;
        opened <= '0';
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits        : boolean;
    variable wait_clocks : natural range 0 to 15; -- of the timer
    variable to_middle   : natural range 0 to 15; -- of the sampler
    variable patient     : natural range 0 to 63;
  begin
    wait_clocks := to_integer(timer);
    to_middle   := to_integer(sampler);
    patient     := to_integer(patience);
    fits        := stage <= data and select_n = '1' and mosi = '0' and command = x"0000";

    case to_integer(state) is
      when resting =>
        fits := fits and sclk = '1' and sclk_1 = '1' and wait_clocks < pause and lasted + wait_clocks >= pause - 1;

      when clocking =>
        fits := fits and wait_clocks < half and
                (opened = '1' or (wait_clocks = half - 1 and spent = 0 and sclk = '0')) and
                (spent /= 0 or (opened = '0' and lasted = pause));
        if wait_clocks = half - 1 then
          fits := fits and sclk /= sclk_1 and lasted >= half;
        else
          fits := fits and sclk = sclk_1 and lasted + wait_clocks = half - 1;
        end if;
        if done = '0' then
          fits := fits and reason = fine and late = '0' and count < frame_bits and left = frame_bits - 1 - count;
          if started = '1' then
            fits := fits and stage = data and to_middle + since = first + 2 * half * count and
                    (since <= first or count >= 1) and spent <= answer + since;
          else
            fits := fits and count = 0 and since = 0 and spent + patient = answer - 1 and
                    ((was_low = '0' and stage = acknowledge) or (was_low = '1' and stage = start));
          end if;
        elsif count = frame_bits then
          fits := fits and reason = fine and late = '0' and started = '1' and stage = data and
                  spent + wait_clocks <= answer + last + half;
        else
          fits := fits and reason = no_answer and late = '1' and count = 0 and patient = 0 and
                  spent + wait_clocks <= answer + half and (started = '1') = (stage = data) and
                  (was_low = '1' or stage = acknowledge) and (was_low = '0' or stage /= acknowledge);
        end if;

      when ending =>
        fits := fits and sclk = '1' and wait_clocks = 0 and (sclk_1 = '1' or lasted >= half) and
                spent < frame_most and
                ((count = frame_bits and late = '0' and reason = fine) or
                 (count = 0 and late = '1' and reason = no_answer));

      when judging =>
        fits := fits and sclk = '1' and sclk_1 = '1' and spent <= frame_most and (spent = 0) = (opened = '0');
        if count = frame_bits then
          fits := fits and late = '0' and ((right_crc = '0' and reason = wrong_check) or
                  (right_crc = '1' and got(7) = '0' and reason = device_error) or
                  (right_crc = '1' and got(7) = '1' and reason = fine));
        else
          fits := fits and reason = no_answer and count = 0;
        end if;

      when others => fits := false;
    end case;

    if state = clocking or state = ending or (state = judging and spent /= 0) then
      fits := fits and crc = crc_after(got, count) and
              (count /= 2 or value(0) = got(9)) and
              (count < 3 or value = unsigned(got(9 downto 8))) and
              (count > 2 or value(1) = '0') and (count > 1 or value(0) = '0') and
              (count < 4 or is_error = not got(7)) and (count > 3 or is_error = '0') and
              (count < 5 or warns = not got(6));
    end if;
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- At every clock, the design is where the reference is.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- sclk is high at rest.
  high_at_rest : assert always begun = '1' and rests = '1' -> sclk = '1';
  -- sclk is high for the whole pause before a frame.
  pause_is_kept : assert always begun = '1' and reset_1 = '0' and sclk = '0' and opened = '0' -> lasted = pause;
  -- Neither half of a period is shorter than its rate.
  never_faster : assert always begun = '1' and reset_1 = '0' and sclk /= sclk_1 -> lasted >= half;
  -- The lines of SPI are at rest.
  no_spi : assert always begun = '1' -> select_n = '1' and mosi = '0';

  -- A reading that is good has all of its bits, each from its middle, and their CRC is right.
  right_check : assert always begun = '1' and ended = '1' and reason = fine -> count = frame_bits and right_crc = '1';
  -- It is the bits that came: the position, the highest one first, without the error of the device, and its warning.
  right_value : assert always begun = '1' and ended = '1' and reason = fine ->
                         value = unsigned(got(9 downto 8)) and got(7) = '1' and warns = not got(6);
  -- Whole readings that are not good say why: the CRC goes first, then the error of the device.
  right_reason : assert always begun = '1' and ended = '1' and count = frame_bits and reason /= fine ->
                          (right_crc = '0' and reason = wrong_check) or
                          (right_crc = '1' and got(7) = '0' and reason = device_error);
  -- A device that does not answer in time is told.
  late_is_told : assert always begun = '1' and ended = '1' and count < frame_bits -> reason = no_answer;
  -- A frame always ends, whatever the device does.
  always_ends : assert always begun = '1' -> too_long = '0';

  -- A reading is good, and its device warns.
  good_seen : cover {begun = '1' and ended = '1' and reason = fine and value = 2 and warns = '1'};
  -- A check fails.
  wrong_seen : cover {begun = '1' and ended = '1' and reason = wrong_check};
  -- No start bit comes.
  late_seen : cover {begun = '1' and ended = '1' and late = '1'};

end architecture;
