-- SPDX-License-Identifier: BSD-3-Clause
--
-- A thermometer DS18B20, or one that understands it, alone on a 1-wire line. It is read at a rate, and each reading is
-- checked before it counts.
--
--   reset     ‾\__488 us low__/‾‾‾\__presence__/‾‾‾‾‾      looked at 72 us behind the rise
--   write 0   ‾\__61 us low______/‾‾    write 1, read   ‾\_6 us_/‾‾‾‾‾‾‾‾    looked at 13 us behind the fall
--
--   +0  control: bit 0 enable, 1 after a reset
--   +1  state (sample_state): bits 7:0 failures, 11:8 failures in a row, 14:12 why the last try failed, 15 valid
--         1 no answer: no presence behind a reset        2 wrong check: the CRC of the nine bytes
--         3 not converted: the thermometer lost its power meanwhile, did not begin, or did not end within the period
--         4 shorted: the line does not rise
--   +2  temperature of the last sample in 1/16 degC, two's complement in 16 bits
--
-- A try     reset, CC 4E 69 69 and the resolution; reset, CC 44, wait; reset, CC BE, nine bytes.
-- 85 degC   is what a thermometer says that has restarted. The two bytes 69 tell: they are in memory that a restart
--           overwrites from its EEPROM. So a true 85 degC counts, and a false one never does.
-- Wait      parasite 0: it is asked until it is done, and must be busy at first. parasite 1: the line is driven high
--           for the time of the datasheet, so that it feeds the thermometer.
-- Block     A try that ends while cyc is high is taken behind it. So all words of a block are of one moment. The next
--           try begins with the first period behind that.
-- Events    sampled: there is a new value. failed: a try has failed.
-- Latency   2 clocks per access (register_slave). A try takes 14 ms and the conversion.
-- Errors    err for a write to +1 and +2, and for addresses from 3 on.
-- Reset     The line is free, all words are 0, but for enable, and the first try begins. Without enable there is none,
--           and the value is not valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity one_wire is
  generic (
    clock_hz      : positive                      := 50_000_000;
    period_ms     : positive range 100 to 60_000  := 1000;
    resolution    : positive range 9 to 12        := 12;         -- bits
    parasite      : natural range 0 to 1          := 0;          -- 1: fed by the line
    failures_most : positive range 1 to 15        := 3;
    data_width    : positive range 16 to 32       := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;

    line_in      : in  std_ulogic; -- asynchronous
    line_out     : out std_ulogic; -- 0, or 1 while the line feeds
    line_drive   : out std_ulogic
  );
end entity;

architecture rtl of one_wire is

  constant unit_us     : positive := 8;                                         -- of a reset, and of the period
  constant convert_ms  : positive := (750 + 2 ** (12 - resolution) - 1) / 2 ** (12 - resolution);
  constant period      : positive := period_ms * 1000 / unit_us;
  constant converted   : positive := (convert_ms + 10) * 1000 / unit_us;        -- with the frames before
  constant unused_bits : natural  := 12 - resolution;

  -- Places in a slot, in us, or in units for a reset.
  constant short_end   : positive := 6;
  constant sample_at   : positive := 13;
  constant long_end    : positive := 61;
  constant slot_end    : positive := 69;
  constant presence_at : positive := 70; -- which no other slot has
  constant reset_end   : positive := 121;

  subtype reason_t is std_ulogic_vector(2 downto 0);
  subtype value_t is std_ulogic_vector(15 downto 0);
  subtype byte_t is std_ulogic_vector(7 downto 0);
  subtype step_t is natural range 0 to 14;

  -- A try, step by step. Between two resets are bytes.
  constant starts          : step_t := 0;
  constant writes          : step_t := 2;  -- 4E: two marks and the resolution follow
  constant resolves        : step_t := 5;
  constant starts_again    : step_t := 6;
  constant converts        : step_t := 8;  -- 44
  constant waits           : step_t := 9;  -- until it is done
  constant starts_to_read  : step_t := 10;
  constant asks            : step_t := 12; -- BE
  constant reads           : step_t := 13; -- nine bytes
  constant rests           : step_t := 14; -- until the next period

  constant fine          : reason_t := "000";
  constant no_answer     : reason_t := "001";
  constant wrong_check   : reason_t := "010";
  constant not_converted : reason_t := "011";
  constant shorted       : reason_t := "100";

  constant mark : byte_t := x"69";

  -- The byte that a step sends.
  function sent_at (step : step_t) return byte_t is
  begin
    case step is
      when starts + 1 | starts_again + 1 | starts_to_read + 1 => return x"CC"; -- to whatever is there
      when writes                      => return x"4E";
      when writes + 1 | writes + 2     => return mark;
      when resolves                    => return '0' & std_ulogic_vector(to_unsigned(resolution - 9, 2)) & "11111";
      when converts                    => return x"44";
      when asks                        => return x"BE";
      when others                      => return x"FF"; -- a read
    end case;
  end function;

  signal read_words  : word_vector_t(0 to 2);
  signal write_words : word_vector_t(0 to 2);
  signal enable      : std_ulogic;

  signal tick           : std_ulogic;                                -- a us is over
  signal eighths        : unsigned(2 downto 0) := "000";
  signal eighth         : std_ulogic;                                -- a unit is over
  signal now            : unsigned(bits_for(period) - 1 downto 0) := to_unsigned(period - 1, bits_for(period));
  signal due            : std_ulogic;                                -- the period ends
  signal step           : step_t := rests;
  signal is_reset       : std_ulogic;
  signal timer          : unsigned(6 downto 0) := (others => '0');   -- in the slot
  signal turns          : std_ulogic;                                -- it goes on
  signal count          : unsigned(6 downto 0) := (others => '0');   -- bits of this step before this one
  signal sent           : std_ulogic;                                -- the bit of this slot
  signal raw            : std_ulogic;                                -- the line, synchronous
  signal got            : std_ulogic := '0';                         -- it was high at the sample
  signal low, feeds     : std_ulogic := '0';                         -- what drives the line
  signal was_busy       : std_ulogic := '0';                         -- it converts
  signal lost           : std_ulogic := '0';                         -- a mark is missing
  signal crc            : byte_t := (others => '0');
  signal shift          : value_t := (others => '0');
  signal ended, accept  : std_ulogic := '0';
  signal reason         : reason_t := fine;
  signal state          : std_ulogic_vector(15 downto 0);
  signal void           : std_ulogic;
  signal value          : value_t := (others => '0');

begin

  assert period_ms >= convert_ms + 20
    report "one_wire: period_ms must be " & integer'image(convert_ms + 20) & " or more for this resolution"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "100", data_width => data_width, initial => (x"00000001", x"00000000", x"00000000"))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  read_words <= (
    0 => extended(write_words(0)(0 downto 0)),
    1 => extended(state),
    2 => extended(value));

  enable     <= write_words(0)(0);
  void       <= not enable;
  line_out   <= feeds;
  line_drive <= low or feeds;

  microseconds : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => 1_000_000)
    port map (clock => clock, reset => reset, tick => tick);

  pin : entity work.input_filter
    port map (clock => clock, reset => reset, pins(0) => line_in, levels(0) => raw);

  tries : entity work.sample_state
    generic map (failures_most => failures_most)
    port map (
      clock => clock, reset => reset, ended => ended, reason => reason, hold => wishbone_m2s.cyc, void => void,
      accept => accept, sampled => sampled, failed => failed, valid => open, word => state);

  eighth   <= tick and and eighths;
  due      <= eighth and to_bit(now = period - 1);
  is_reset <= to_bit(step = starts or step = starts_again or step = starts_to_read);
  turns    <= eighth when is_reset = '1' else tick and to_bit(step /= rests);
  sent     <= sent_at(step)(to_integer(count(2 downto 0))) and not is_reset;

  run : process (clock) is

    procedure fail (why : reason_t) is
    begin
      ended  <= '1';
      reason <= why;
      step   <= rests;
    end procedure;

    procedure go_on is
    begin
      step  <= step + 1;
      count <= (others => '0');
    end procedure;

  begin
    if rising_edge(clock) then
      if accept = '1' then
        ended <= '0';
        if reason = fine then
          value <= shift(15 downto unused_bits) & (unused_bits - 1 downto 0 => '0');
        end if;
      end if;

      if tick = '1' then
        eighths <= eighths + 1;
      end if;
      if eighth = '1' then
        now <= now + 1;
        if due = '1' then
          now <= (others => '0');
        end if;
      end if;

      if turns = '1' then
        timer <= timer + 1;

        if timer = 0 and feeds = '0' then
          low <= '1';
        end if;
        if (timer = short_end and sent = '1') or timer = long_end then
          low <= '0';
        end if;
        if timer = long_end and step = converts and count = 7 and parasite = 1 then
          feeds <= '1';
        end if;

        if timer = presence_at or (timer = sample_at and is_reset = '0') then
          got <= raw;
        end if;
        if timer = sample_at and step = reads then
          crc <= '0' & crc(7 downto 1);
          if (crc(0) xor raw) = '1' then
            crc <= ('0' & crc(7 downto 1)) xor x"8C";
          end if;
          if count(6 downto 4) = 0 then
            shift <= raw & shift(15 downto 1);
          end if;
          if count(6 downto 4) = 1 and raw /= mark(to_integer(count(2 downto 0))) then
            lost <= '1';
          end if;
        end if;

        if timer = slot_end and is_reset = '0' then
          timer <= (others => '0');
          count <= count + 1;
          if step = waits then
            count <= (others => '0');
            if parasite = 1 then
              if now >= converted then
                feeds <= '0';
                go_on;
              end if;
            elsif got = '0' then
              was_busy <= '1';
            elsif was_busy = '1' then
              go_on;
            else
              fail(not_converted);
            end if;
          elsif step = reads then
            if count = 71 then
              fail(fine); -- or worse
              if unsigned(crc) /= 0 then
                reason <= wrong_check;
              elsif lost = '1' then
                reason <= not_converted;
              end if;
            end if;
          elsif count = 7 then
            go_on;
          end if;
        end if;

        if timer = reset_end and is_reset = '1' then
          timer <= (others => '0');
          if raw = '0' then
            fail(shorted);
          elsif got = '1' then
            fail(no_answer);
          else
            go_on;
          end if;
        end if;
      end if;

      if due = '1' then
        timer    <= (others => '0');
        low      <= '0';
        feeds    <= '0';
        was_busy <= '0';
        lost     <= '0';
        crc      <= (others => '0');
        count    <= (others => '0');
        if step /= rests then
          fail(not_converted);
        elsif enable = '1' and (ended = '0' or accept = '1') then
          step <= starts; -- unless a block still holds the last try back
        end if;
      end if;
      if enable = '0' then
        low   <= '0';
        feeds <= '0';
        ended <= '0';
        step  <= rests;
      end if;
      if reset = '1' then
        eighths <= (others => '0');
        now     <= to_unsigned(period - 1, now'length);
        timer   <= (others => '0');
        low     <= '0';
        feeds   <= '0';
        ended   <= '0';
        value   <= (others => '0');
        step    <= rests;
      end if;
    end if;
  end process;

end architecture;
