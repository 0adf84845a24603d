-- SPDX-License-Identifier: BSD-3-Clause
--
-- Pulse-width modulation on the Wishbone bus: several channels with one period, or RC servos.
--
--   +0      control: bit 0 enable, bit 1 servo mode        (a write begins a new period)
--   +1      period in clocks; 0 is off                     (not used in servo mode: 20 ms)
--   +2 + n  channel n: pulse width in clocks; 0 is never high, the period or more is always high;
--           in servo mode in µs, limited to servo_minimum_us .. servo_maximum_us; 0 is no pulse (the servo goes limp)
--
--   pin    __/‾‾‾‾‾‾‾‾\____________/‾‾‾‾‾‾‾‾\____
--            |-width--|            |
--            |-------period--------|
--
-- A new period or width takes effect with the next period, so a write never cuts a pulse short or doubles it. Widths
-- and periods that counter_bits cannot hold become the longest possible. A read gives the value in use.
--
-- Latency   2 clocks per access (register_slave). In servo mode a phase accumulator makes the µs from clock_hz: any
--           clock from 1 MHz on, and each pulse is at most one clock off.
-- Errors    err for addresses from 2 + channels on.
-- Reset     Disabled, all pins low, all registers zero.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity pwm is
  generic (
    clock_hz         : positive                := 50_000_000;
    channels         : positive range 1 to 64  := 4;
    counter_bits     : positive range 15 to 31 := 24;
    data_width       : positive range 16 to 32 := 32;
    servo_minimum_us : positive                := 500;
    servo_maximum_us : positive                := 2500
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

  constant words           : positive := 2 + channels;
  constant servo_period_us : positive := 20_000;
  constant microsecond_hz  : positive := 1_000_000;
  constant bits            : positive := phase_bits(clock_hz, microsecond_hz);

  constant all_writable : std_ulogic_vector(0 to words - 1) := (others => '1');

  subtype count_t is unsigned(counter_bits - 1 downto 0);
  type counts_t is array (0 to channels - 1) of count_t;

  constant longest : count_t := (others => '1');

  signal read_words  : word_vector_t(0 to words - 1);
  signal write_words : word_vector_t(0 to words - 1);
  signal written     : std_ulogic_vector(0 to words - 1);

  signal enable, servo : std_ulogic;
  signal phase         : unsigned(bits downto 0);
  signal tick          : std_ulogic; -- the unit of time: a clock, or a µs
  signal running       : std_ulogic;
  signal count         : count_t;    -- units since the period began
  signal last          : count_t;    -- the value of `count` in the last unit of this period
  signal widths        : counts_t;   -- of this period

  -- The word, limited to what the counter can hold.
  function limited (word : word_t) return count_t is
  begin
    if unsigned(word) > longest then
      return longest;
    end if;
    return unsigned(word(count_t'range));
  end function;

  function servo_limited (width : count_t) return count_t is
  begin
    if width = 0 then
      return width;
    elsif width < servo_minimum_us then
      return to_unsigned(servo_minimum_us, counter_bits);
    elsif width > servo_maximum_us then
      return to_unsigned(servo_maximum_us, counter_bits);
    end if;
    return width;
  end function;

  function read_back (word : word_t) return word_t is
  begin
    return std_ulogic_vector(resize(limited(word), word_t'length));
  end function;

begin

  assert servo_minimum_us <= servo_maximum_us and servo_maximum_us < servo_period_us
    report "pwm: servo_minimum_us must not exceed servo_maximum_us, nor that the period of 20000 us"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => all_writable, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  enable <= write_words(0)(0);
  servo  <= write_words(0)(1);
  tick   <= phase(bits) or not servo;

  read_words(0) <= (0 => enable, 1 => servo, others => '0');

  back : for word in 1 to words - 1 generate
    read_words(word) <= read_back(write_words(word));
  end generate;

  process (clock) is
    variable width : count_t;
  begin
    if rising_edge(clock) then
      phase <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, microsecond_hz);

      if written(0) = '1' or enable = '0' then
        running <= '0';
      elsif running = '0' or (tick = '1' and count = last) then
        count   <= (others => '0');
        running <= '1';
        if servo = '1' then
          last <= to_unsigned(servo_period_us - 1, counter_bits);
        else
          last <= limited(write_words(1)) - 1;
          if limited(write_words(1)) = 0 then
            running <= '0';
          end if;
        end if;
        for channel in 0 to channels - 1 loop
          width := limited(write_words(2 + channel));
          if servo = '1' then
            width := servo_limited(width);
          end if;
          widths(channel) <= width;
        end loop;
      elsif tick = '1' then
        count <= count + 1;
      end if;

      for channel in 0 to channels - 1 loop
        pins(channel) <= '0';
        if running = '1' and enable = '1' and count < widths(channel) then
          pins(channel) <= '1';
        end if;
      end loop;

      if reset = '1' then
        phase   <= (others => '0');
        running <= '0';
        pins    <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
