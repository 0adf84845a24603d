-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of absolute_encoder with an AS5047P: 14 bits, half a period of 3 clocks, and pauses of 4. The
-- chip may answer anything, and a reading may be asked for and accepted at any clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.absolute_encoder_pkg.all;
  use work.bit_pkg.all;

entity absolute_encoder_spi_formal is
  port (
    clk    : in std_ulogic;
    again  : in std_ulogic; -- a reset later than at power-up
    ask    : in std_ulogic;
    accept : in std_ulogic;
    miso   : in std_ulogic;

    -- These show the registers of the design, and of the filter of its input.
    first    : in std_ulogic;
    middle   : in std_ulogic;
    level    : in std_ulogic;
    state    : in unsigned(2 downto 0);
    timer    : in unsigned(2 downto 0);
    left     : in unsigned(3 downto 0);
    done     : in std_ulogic;
    primed   : in std_ulogic;
    second   : in std_ulogic;
    renews   : in unsigned(1 downto 0);
    command  : in std_ulogic_vector(15 downto 0);
    parity   : in std_ulogic;
    is_error : in std_ulogic
  );
end entity;

architecture properties of absolute_encoder_spi_formal is

  constant bits  : positive := 14;
  constant half  : positive := 3;
  constant pause : positive := 4;
  -- A reading is two frames, each with a pause before it, 16 periods of sclk, and a pause at both sides of its end.
  constant frame_clocks : positive := 3 * pause + 32 * half;
  constant angle : std_ulogic_vector(15 downto 0) := x"FFFF";
  constant field : std_ulogic_vector(15 downto 0) := x"7FFD";
  constant clear : std_ulogic_vector(15 downto 0) := x"4001"; -- reads the error, which clears it

  -- The states of the design.
  constant resting    : natural := 0;
  constant selecting  : natural := 1;
  constant clocking   : natural := 2;
  constant ending     : natural := 3;
  constant deselected : natural := 4;
  constant judging    : natural := 5;

  subtype word_t is std_ulogic_vector(15 downto 0);

  signal rests, ready, begins, ended : std_ulogic;
  signal sclk, select_n, mosi, warns : std_ulogic;
  signal reason : reason_t;
  signal value  : unsigned(bits - 1 downto 0);
  signal began  : unsigned(31 downto 0);

  signal begun    : std_ulogic := '0';
  signal reset    : std_ulogic;
  signal reset_1  : std_ulogic := '1';
  signal miso_1, miso_2, miso_3 : std_ulogic := '0';
  signal sclk_1   : std_ulogic := '0';
  signal select_1 : std_ulogic := '1';
  signal lasted   : natural range 0 to pause := 0;                      -- clocks since sclk or select_n changed
  signal spent    : natural range 0 to 2 * frame_clocks + 2 := 0;       -- clocks of this reading
  signal too_long : std_ulogic;
  signal count, count_now   : natural range 0 to 17 := 0;               -- bits of this frame
  signal got, got_now       : word_t := (others => '0');                -- what the pin was at the falls of sclk
  signal got_1, got_1_now   : word_t := (others => '0');                -- the same, of the frame before
  signal sent, sent_now     : word_t := (others => '0');                -- what mosi was then
  signal sent_1, sent_1_now : word_t := (others => '0');
  signal sent_2, sent_2_now : word_t := (others => '0');                -- and of the frame before that
  signal cleared, cleared_now : std_ulogic := '0';                      -- the error was read since the last failure
  signal in_place : std_ulogic;

  -- Whether the low bits of a frame are all ones, as with a pin that nobody drives.
  function is_idle (word : word_t) return std_ulogic is
  begin
    return and word(14 downto 0);
  end function;

  -- Why the reply of a frame does not count. A field may not be 0.
  function reason_of (word : word_t; is_field : std_ulogic) return reason_t is
  begin
    if (xor word) = '1' then
      return wrong_check;
    elsif is_idle(word) = '1' or (is_field = '1' and word(13 downto 0) = "00000000000000") then
      return no_answer;
    elsif word(14) = '1' then
      return device_error;
    end if;
    return fine;
  end function;

begin

  default clock is rising_edge(clk);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset  <= again or not begun;
  begins <= ask and ready;

  dut : entity work.absolute_encoder_line
    generic map (clock_hz => 1_000_000, kind => 2, bits => bits, gray => 0, sclk_hz => 1_000_000)
    port map (
      clock => clk, reset => reset, rests => rests, ready => ready, begins => begins, now => x"00000000",
      ended => ended, accept => accept, reason => reason, value => value, warns => warns, began => began,
      sclk => sclk, select_n => select_n, mosi => mosi, miso => miso);

  too_long <= to_bit(spent > 2 * frame_clocks + 1);

  -- A frame begins with the fall of select_n, and ends with its rise.
  edge : process (all) is
  begin
    count_now   <= count;
    got_now     <= got;
    got_1_now   <= got_1;
    sent_now    <= sent;
    sent_1_now  <= sent_1;
    sent_2_now  <= sent_2;
    cleared_now <= cleared;
    if select_n = '0' and select_1 = '1' then
      count_now  <= 0;
      got_now    <= (others => '0');
      got_1_now  <= got;
      sent_now   <= (others => '0');
      sent_1_now <= sent;
      sent_2_now <= sent_1;
    end if;
    if sclk = '0' and sclk_1 = '1' then
      count_now <= minimum(count + 1, 17);
      for place in word_t'range loop
        if place + count = 15 then
          got_now(place)  <= miso_1;
          sent_now(place) <= mosi;
        end if;
      end loop;
    end if;
    if select_n = '1' and select_1 = '0' and sent = clear then
      cleared_now <= '1';
    end if;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun    <= '1';
      reset_1  <= reset;
      miso_1   <= miso;
      miso_2   <= miso_1;
      miso_3   <= miso_2;
      sclk_1   <= sclk;
      select_1 <= select_n;
      lasted   <= minimum(lasted + 1, pause);
      if sclk /= sclk_1 or select_n /= select_1 then
        lasted <= 1;
      end if;
      count    <= count_now;
      got      <= got_now;
      got_1    <= got_1_now;
      sent     <= sent_now;
      sent_1   <= sent_1_now;
      sent_2   <= sent_2_now;
      cleared  <= cleared_now and not (ended and to_bit(reason /= fine));

      if rests = '1' then
        spent <= 0;
      elsif ended = '0' then
        spent <= minimum(spent + 1, 2 * frame_clocks + 2);
      end if;

      if reset = '1' then
        sclk_1   <= '0';
        select_1 <= '1';
        lasted   <= 0;
        sent     <= (others => '0');
        cleared  <= '0';
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits        : boolean;
    variable wait_clocks : natural range 0 to 7;            -- of the timer
    variable passed      : natural range 0 to frame_clocks; -- clocks of this frame
    variable taken       : natural range 0 to 16;           -- bits that the design has taken
    variable asked       : word_t;                          -- the command of this frame
    variable before      : word_t;                          -- that of the frame before this reading
    variable why         : reason_t;                        -- of the frames that have ended
    variable odd         : std_ulogic;                      -- the parity of the bits that were taken
  begin
    wait_clocks := to_integer(timer);
    taken       := 0;
    passed      := 0;
    fits        := first = miso_1 and middle = miso_2 and level = miso_3 and renews <= 2;

    asked := angle;
    if second = '1' and renews = 2 then
      asked := clear;
    elsif second = '1' then
      asked := field;
    end if;

    before := sent_1_now;
    if second = '1' then
      before := sent_2_now;
    end if;
    if state = resting then
      before := sent_now;
    end if;

    -- What is known of the frames before this reading.
    if renews /= 2 then
      fits := fits and (before = clear or renews = 0) and (before = field or renews = 1) and
              (cleared_now = '1' or (state = judging and reason /= fine));
    end if;
    if second = '1' and state /= resting then
      fits := fits and sent_1_now = angle;
    end if;

    case to_integer(state) is
      when resting =>
        fits := fits and select_n = '1' and select_1 = '1' and sclk = '0' and sclk_1 = '0' and mosi = '0' and
                wait_clocks < pause and lasted + wait_clocks >= pause - 1 and spent <= 2 * frame_clocks + 1;

      when selecting =>
        passed := pause - 1 - wait_clocks;
        fits   := fits and select_n = '0' and sclk = '0' and sclk_1 = '0' and mosi = '0' and primed = '0' and
                  wait_clocks < pause and count_now = 0 and command = asked;
        if wait_clocks = pause - 1 then
          fits := fits and select_1 = '1' and lasted = pause;
        else
          fits := fits and select_1 = '0' and lasted + wait_clocks = pause - 1;
        end if;

      when clocking =>
        fits := fits and select_n = '0' and select_1 = '0' and primed = '1' and wait_clocks < half;
        if wait_clocks = half - 1 then
          fits := fits and sclk /= sclk_1 and lasted >= half and (count_now /= 0 or lasted = pause);
        else
          fits := fits and sclk = sclk_1 and lasted + wait_clocks = half - 1;
        end if;
        if sclk = '1' then
          fits   := fits and count_now <= 15;
          taken  := minimum(count_now, 15);
          passed := pause + 2 * half * taken + half - 1 - wait_clocks;
        else
          fits   := fits and count_now >= 1 and count_now <= 16;
          taken  := maximum(minimum(count_now, 16), 1) - 1;
          passed := pause + 2 * half * taken + 2 * half - 1 - wait_clocks;
          for place in word_t'range loop
            if place + taken = 15 then
              fits := fits and (wait_clocks /= 1 or got_now(place) = miso_2) and
                      (wait_clocks /= 0 or got_now(place) = miso_3);
            end if;
          end loop;
        end if;
        for place in word_t'range loop
          fits := fits and (place + count_now <= 15 or sent_now(place) = asked(place));
          if place + taken = 15 then
            fits := fits and mosi = asked(place);
          end if;
          for shifted in word_t'range loop
            if place - shifted = taken then
              fits := fits and command(place) = asked(shifted);
            end if;
          end loop;
        end loop;

      when ending =>
        passed := pause + 32 * half + pause - 1 - wait_clocks;
        fits   := fits and select_n = '0' and select_1 = '0' and sclk = '0' and sclk_1 = '0' and mosi = '0' and
                  wait_clocks < pause and (lasted = pause or (wait_clocks = pause - 1 and lasted = half));

      when deselected =>
        passed := pause + 32 * half + 2 * pause - 1 - wait_clocks;
        fits   := fits and select_n = '1' and sclk = '0' and sclk_1 = '0' and mosi = '0' and wait_clocks < pause;
        if wait_clocks = pause - 1 then
          fits := fits and select_1 = '0' and lasted = pause;
        else
          fits := fits and select_1 = '1' and lasted + wait_clocks = pause - 1;
        end if;

      when judging =>
        passed := frame_clocks;
        fits   := fits and second = '1' and select_n = '1' and select_1 = '1' and sclk = '0' and sclk_1 = '0' and
                  mosi = '0';

      when others => fits := false;
    end case;

    if state = ending or state = deselected or state = judging then
      taken := 16;
      fits  := fits and count_now = 16 and sent_now = asked;
    elsif state /= resting then
      fits  := fits and done = '0' and left = 15 - taken;
    end if;

    -- The reasons of the frames that have ended.
    why := fine;
    if renews = 0 and second = '1' then
      why := reason_of(got_1_now, '1');
    end if;
    if state = deselected or state = judging then
      if why = fine and second = '1' then
        why := reason_of(got_now, '0');
      elsif second = '0' and renews = 0 then
        why := reason_of(got_now, '1');
      end if;
      fits := fits and (second = '0' or renews /= 2 or cleared_now = '1' or (state = judging and reason /= fine));
    end if;

    if state /= resting then
      fits := fits and reason = why and
              ((second = '0' and spent = passed) or (second = '1' and spent = frame_clocks + passed));
      odd := '0';
      for place in word_t'range loop
        odd := odd xor (got_now(place) and to_bit(place + taken > 15));
      end loop;
      fits := fits and parity = odd and is_error = (got_now(14) and to_bit(taken >= 2));
      for count in 0 to 16 loop
        for place in 0 to bits - 1 loop
          if taken = count and count >= place + 3 then
            fits := fits and value(place) = got_now(16 - count + place);
          elsif taken = count then
            fits := fits and value(place) = '0';
          end if;
        end loop;
      end loop;
    end if;
    in_place <= to_bit(fits);
  end process;

  -- At every clock, the design is where the reference is.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- At rest the chip is not selected. sclk is low then.
  quiet_at_rest : assert always begun = '1' and rests = '1' -> select_n = '1' and sclk = '0' and mosi = '0';
  -- Without a selection sclk is low.
  quiet_unselected : assert always begun = '1' and select_n = '1' -> sclk = '0';
  -- Neither half of a period is shorter than its rate.
  never_faster : assert always begun = '1' and reset_1 = '0' and sclk /= sclk_1 -> lasted >= half;
  -- A pause is between two frames, before the first rise of sclk, and behind the last bit.
  pause_is_kept : assert always begun = '1' and reset_1 = '0' and
                           (select_n /= select_1 or (sclk /= sclk_1 and count_now = 0)) -> lasted = pause;

  -- A frame that no reset breaks off has 16 bits, and its command is one of these, with the parity of each.
  whole_frame : assert always begun = '1' and reset_1 = '0' and select_n = '1' and select_1 = '0' ->
                         count = 16 and (sent = angle or sent = field or sent = clear);

  -- A good reading is two frames: the first reply is that to the command for the field, the second one to that for the
  -- angle. Both have an even parity and no error, and the field is not 0.
  right_check : assert always begun = '1' and ended = '1' and reason = fine ->
                         sent_2 = field and sent_1 = angle and reason_of(got_1, '1') = fine and
                         reason_of(got, '0') = fine;
  -- It gives the angle, as the pin was at the falls of sclk.
  right_value : assert always begun = '1' and ended = '1' and reason = fine -> value = unsigned(got(13 downto 0));
  -- The error has been read since the last failure, which clears it.
  error_is_read : assert always begun = '1' and ended = '1' and reason = fine -> cleared = '1';
  -- A reading that fails says why: of the field, if it was asked for, or else of the angle.
  right_reason : assert always begun = '1' and ended = '1' and reason /= fine ->
                          (sent_2 = field and reason = reason_of(got_1, '1')) or reason = reason_of(got, '0');

  -- A reading always ends.
  always_ends : assert always begun = '1' -> too_long = '0';

  -- A reading fails.
  bad_seen : cover {begun = '1' and ended = '1' and reason = device_error};

end architecture;
