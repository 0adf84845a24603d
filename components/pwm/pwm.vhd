-- SPDX-License-Identifier: BSD-3-Clause
--
-- Pulse-width modulation on the Wishbone bus: several channels with one frequency, or RC servos.
--
--   +0      control: bit 0 enable, which begins a period
--   +2 + n  channel n: its share of the period in 1/4096; 0 is never high, 4096 and more is always high;
--           for servos the pulse width in µs, limited to servo_minimum_us .. servo_maximum_us; 0 is no pulse
--
--   pin    __/‾‾‾‾‾‾‾‾\____________/‾‾‾‾‾‾‾‾\____
--            |-width--|            |
--            |-------period--------|
--
-- At the start of a period the channels take their words in turn, each in 15 clocks. One multiplier makes a number of
-- clocks from the word, a bit at a time. A counter for each channel then makes the pulse. So a pulse is a whole old one
-- or a whole new one, at 0 % and at 100 % the pin has no edge, and channel n is 15 * n clocks behind channel 0. The
-- words are in block RAM. A word has 13 bits; more bits are not stored and read as zero.
--
-- Generics  servo 0: a period is clock_hz / frequency_hz clocks, rounded. A pulse is a whole number of clocks, rounded
--           up. servo 1: a period is 20 ms, and the time is counted in µs of a phase accumulator: any clock from 1 MHz
--           on. A pulse is then at most one clock off.
-- Latency   2 clocks per access. From the write of enable to the first pin 18 clocks; all pins are low 2 clocks after
--           its end. For servos a pulse begins with a µs.
-- Errors    err for +1, for addresses from 2 + channels on, and for writes that do not select all bytes.
-- Reset     Disabled, all pins low. Then all words become zero, one in a clock, and accesses wait for that.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity pwm is
  generic (
    clock_hz         : positive                 := 50_000_000;
    channels         : positive range 1 to 64   := 4;
    frequency_hz     : positive                 := 20_000;
    servo            : natural range 0 to 1     := 0;
    servo_minimum_us : positive range 1 to 8191 := 500;
    servo_maximum_us : positive range 1 to 8191 := 2500;
    data_width       : positive range 16 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    pins         : out std_ulogic_vector(channels - 1 downto 0)
  );
end entity;

architecture rtl of pwm is

  constant share_bits      : positive := 12;             -- of the fraction
  constant word_bits       : positive := share_bits + 1;
  constant whole           : positive := 2 ** share_bits;
  constant microsecond_hz  : positive := 1_000_000;
  constant servo_period_us : positive := 20_000;
  constant index_bits      : positive := bits_for(2 + channels);

  constant all_bytes : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  -- A period, in clocks or µs, and what a word is multiplied with to give 4096 of them.
  function period_units return positive is
  begin
    if servo = 1 then
      return servo_period_us;
    end if;
    return (clock_hz + frequency_hz / 2) / frequency_hz;
  end function;

  function factor_units return positive is
  begin
    if servo = 1 then
      return whole;
    end if;
    return period_units;
  end function;

  constant period   : positive := period_units;
  constant factor   : positive := factor_units;
  constant bits     : positive := phase_bits(clock_hz, microsecond_hz);

  subtype word_t is unsigned(word_bits - 1 downto 0);
  subtype index_t is unsigned(index_bits - 1 downto 0);
  subtype left_t is unsigned(bits_for(period) - 1 downto 0);
  subtype product_t is signed(maximum(bits_for(period), bits_for(factor)) + 2 downto 0); -- below 4 * factor
  subtype count_t is signed(bits_for(period) downto 0);
  type memory_t is array (0 to 2 ** index_bits - 1) of word_t;
  type counts_t is array (0 to channels - 1) of count_t;

  constant none : count_t := (others => '1');

  -- Both hold the same. A memory is never read and written at once: what such a read gives depends on the chip.
  signal memory, bus_memory : memory_t := (others => (others => '0'));

  -- The bus.
  signal asked, known, is_control, writes  : std_ulogic;
  signal late                              : std_ulogic := '0'; -- the word is written in the clock of its ack
  signal ack, err, enable, shows_control   : std_ulogic := '0';
  signal clearing                          : std_ulogic := '1';
  signal place                             : index_t;           -- that is written
  signal data, found                       : word_t;

  -- The turns.
  signal phase    : unsigned(bits downto 0) := (others => '0');
  signal tick     : std_ulogic;                       -- the unit of time: a clock, or a µs
  signal left     : left_t := (others => '0');        -- units until the next period begins
  signal turning  : std_ulogic := '0';
  signal channel  : index_t := (others => '0');       -- whose turn it is
  signal step     : unsigned(3 downto 0) := (others => '0');
  signal reads    : std_ulogic;                       -- the first step of a turn
  signal loads    : std_ulogic;                       -- the last one
  signal word     : word_t;
  signal chosen   : std_ulogic;                       -- the bit of this step
  signal product  : product_t;
  signal counts   : counts_t;                         -- units for which a pin is still high, less 1

  -- For servos, a width within the limits.
  function limited (word : word_t) return word_t is
  begin
    if servo = 0 or word = 0 then
      return word;
    elsif word < servo_minimum_us then
      return to_unsigned(servo_minimum_us, word_bits);
    elsif word > servo_maximum_us then
      return to_unsigned(servo_maximum_us, word_bits);
    end if;
    return word;
  end function;

begin

  assert servo = 0 or servo_minimum_us <= servo_maximum_us
    report "pwm: servo_minimum_us must not exceed servo_maximum_us"
    severity failure;
  assert servo = 1 or period > (word_bits + 2) * channels
    report "pwm: " & integer'image(channels) & " channels need a period of more than " &
           integer'image((word_bits + 2) * channels) & " clocks, and frequency_hz gives " & integer'image(period)
    severity failure;

  -- The bus.
  asked      <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not clearing;
  is_control <= '1' when unsigned(wishbone_m2s.adr(index_t'range)) = 0 else '0';
  known      <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto index_bits)) = 0 and
                         unsigned('0' & wishbone_m2s.adr(index_t'range)) < 2 + channels and
                         unsigned(wishbone_m2s.adr(index_t'range)) /= 1 and
                         (wishbone_m2s.we = '0' or wishbone_m2s.sel(all_bytes'range) = all_bytes) else '0';
  writes     <= clearing or (asked and known and wishbone_m2s.we and not is_control);
  place      <= channel when clearing = '1' else unsigned(wishbone_m2s.adr(index_t'range));
  data       <= (others => '0') when clearing = '1' else unsigned(wishbone_m2s.dat(word_t'range));

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack           <= asked and known;
      err           <= asked and not known;
      shows_control <= is_control;
      late          <= writes and reads;
      if (asked and known and wishbone_m2s.we and is_control) = '1' then
        enable <= wishbone_m2s.dat(0);
      end if;
      if writes = '1' then
        bus_memory(to_integer(place)) <= data;
      end if;
      -- Not an `else` of the line above: GHDL 2.0 synthesises its condition without the `not`.
      if writes = '0' then
        found <= bus_memory(to_integer(unsigned(wishbone_m2s.adr(index_t'range))));
      end if;
      if (writes or late) = '1' and reads = '0' then
        memory(to_integer(place)) <= data;
      end if;
      if reads = '1' then
        word <= memory(to_integer(channel + 2));
      end if;

      if reset = '1' then
        ack    <= '0';
        err    <= '0';
        enable <= '0';
      end if;
    end if;
  end process;

  -- The control word is not in the memory, so its other bits are zero there.
  reply : process (all) is
  begin
    wishbone_s2m                   <= wishbone_s2m_idle;
    wishbone_s2m.ack               <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err               <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat(word_t'range) <= std_ulogic_vector(found);
    if shows_control = '1' then
      wishbone_s2m.dat(0) <= enable;
    end if;
  end process;

  -- A turn: the first step reads the word. Each further one adds twice the factor to the product, if the bit of the
  -- word is set, and halves it. It begins at -1, so the product is rounded up and less 1.
  reads <= turning and nor step;
  loads <= '1' when step = word_bits + 1 else '0';
  tick  <= phase(bits) when servo = 1 else '1';

  choose : process (all) is
    variable bit_number : natural range 0 to 15;
  begin
    bit_number := to_integer(step - 1);
    chosen     <= '0';
    if bit_number < word_bits then
      chosen <= limited(word)(bit_number);
      if servo = 0 and word(word'high) = '1' and bit_number /= word'high then
        chosen <= '0';
      end if;
    end if;
  end process;

  run : process (clock) is
    variable twice    : product_t; -- the factor, or 0
    variable counting : std_ulogic;
    variable next_one : count_t;
  begin
    if rising_edge(clock) then
      phase <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, microsecond_hz);

      if turning = '1' then
        step    <= step + 1;
        twice   := to_signed(2 * factor, product_t'length) and (product_t'range => chosen);
        product <= shift_right(product + twice, 1);
        if reads = '1' then
          product <= (others => '1');
        end if;
        if loads = '1' then
          step    <= (others => '0');
          channel <= channel + 1;
          if channel = channels - 1 then
            turning <= '0';
          end if;
        end if;
      end if;

      if tick = '1' then
        left <= left - 1;
        if left = 0 then
          left    <= to_unsigned(period - 1, left'length);
          turning <= '1';
          channel <= (others => '0');
        end if;
      end if;

      for number in counts'range loop
        counting := '1';
        if loads = '1' and channel = number then
          counting := '0';
        end if;
        next_one := counts(number) + (count_t'range => counting); -- less 1
        if counting = '0' then
          next_one := product(count_t'range);
        end if;
        if counting = '0' or (tick = '1' and counts(number)(count_t'high) = '0') then
          counts(number) <= next_one;
        end if;
        if tick = '1' then
          pins(number) <= not counts(number)(count_t'high);
        end if;
      end loop;

      if enable = '0' then
        step    <= (others => '0');
        turning <= '0';
        left    <= (others => '0');
        counts  <= (others => none);
        pins    <= (others => '0');
      end if;
      if clearing = '1' then
        channel  <= channel + 1;
        clearing <= nand channel;
      end if;
      if reset = '1' then
        phase    <= (others => '0');
        channel  <= (others => '0');
        clearing <= '1';
        pins     <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
