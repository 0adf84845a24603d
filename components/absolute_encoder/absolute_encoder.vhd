-- SPDX-License-Identifier: BSD-3-Clause
--
-- An absolute encoder on a serial line: it is read at a rate, and each reading is checked before it counts.
--
--   kind 0, SSI      sclk ‾\_/‾\_/‾\_/‾...‾\_/‾‾‾     the first fall latches; a bit comes at a rise, is read at a fall
--                    miso ‾‾‾‾X b X b X...X b \___/‾  high at rest, and low in the pause behind the last bit
--   kind 1, BiSS-C   sclk ‾\_/‾\_/‾\_/‾\_/‾...        runs until the last bit has come
--                    miso ‾‾‾\___/‾\_X b X b X...     acknowledge, start bit, a 0, position, nE, nW, CRC
--   kind 2, AS5047P  two frames of 16 bits on SPI, mode 1: the first asks for the angle, the second one fetches it
--   and AS5048A      and asks for the field of the magnet, which the next first one fetches
--
--   +0  control: bit 0 enable, 1 after a reset; 0 stops after the frame
--   +1  status (read): bit 0 valid, bit 1 the device warns, bits 5..4 why the last try failed: 1 no answer, 2 wrong
--       check, 3 the device reports an error
--   +2  failures, 16 bits, it wraps (read)         +3  age in us since the last good reading, at most 1,048,575 (read)
--   +4  stamp: the clock at which the last good reading was latched (read)
--   +5  raw: what the device gave last (read)
--   +6  position, two's complement, counted on over whole turns of the device; a write presets it
--
-- Position  The first reading gives (raw - zero) as a number of `bits` bits with a sign. After that the position takes
--           the shorter way to each new reading. So it is right while less than half a turn passes between two of them.
-- Checks    SSI: the line is high at rest and low in the pause, so a loose line is no answer. BiSS-C: the CRC-6 of
--           polynomial 43, sent inverted, and nE. AS5047P: both parities, both error flags, and a field that is not
--           0: an absent chip gives FFFF or 0000, and 0 is an angle, too. After an error its flag is read, which
--           clears it.
-- BiSS-C    The clocks from the start bit on are those of the line. So its delay does not matter, and is found anew in
--           each frame. The start bit must come within 40 us.
-- Stale     After failures_most failures in a row `valid` is 0, and the wire is not valid. The position stays.
-- Words     All words of a block are of one reading: it waits while cyc is high.
-- Wire      position_wire has the position, and is valid with it.
-- Events    sampled: a new reading shows. failed: a try has failed.
-- Latency   2 clocks per access. A reading shows one frame after its stamp.
-- Errors    err for a write of +1 to +5 and for addresses from 7 on.
-- Reset     The line is at rest, the position is 0 and not valid, and the first reading begins a pause later.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.absolute_encoder_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity absolute_encoder is
  generic (
    clock_hz      : positive                  := 50_000_000;
    kind          : natural range 0 to 2      := 0;
    bits          : positive range 2 to 32    := 13;
    lead_bits     : natural range 0 to 15     := 0;         -- before the position, SSI
    tail_bits     : natural range 0 to 15     := 0;         -- behind it, SSI
    gray          : natural range 0 to 1      := 1;
    zero          : integer                   := 0;
    sclk_hz       : positive                  := 1_000_000; -- at most a sixth of clock_hz is made
    sample_hz     : positive                  := 10_000;
    pause_us      : positive range 1 to 100   := 25;        -- between two frames of SSI or BiSS-C
    failures_most : positive range 1 to 15    := 3;
    data_width    : positive range 32 to 32   := 32
  );
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic; -- synchronous
    wishbone_m2s  : in  wishbone_m2s_t;
    wishbone_s2m  : out wishbone_s2m_t;
    sampled       : out std_ulogic;
    failed        : out std_ulogic;
    position_wire : out wire_t;

    sclk          : out std_ulogic;
    select_n      : out std_ulogic;
    mosi          : out std_ulogic;
    miso          : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of absolute_encoder is

  constant rate_bits : positive := phase_bits(clock_hz, sample_hz);
  constant us_bits   : positive := phase_bits(clock_hz, 1_000_000);
  constant age_most  : unsigned(19 downto 0) := (others => '1');

  subtype raw_t is unsigned(bits - 1 downto 0);

  constant first : raw_t := resize(unsigned(to_signed(zero, 32)), bits);

  signal read_words  : word_vector_t(0 to 6);
  signal write_words : word_vector_t(0 to 6);
  signal written     : std_ulogic_vector(0 to 6);
  signal enable      : std_ulogic;

  signal rests, ready, begins    : std_ulogic;
  signal ended, accept, is_good  : std_ulogic;
  signal reason                  : reason_t;
  signal value                   : raw_t;
  signal warns                   : std_ulogic;
  signal began                   : unsigned(31 downto 0);

  signal rate_phase   : unsigned(rate_bits downto 0) := (others => '0');
  signal us_phase     : unsigned(us_bits downto 0) := (others => '0');
  signal now          : unsigned(31 downto 0) := (others => '0');
  signal due          : std_ulogic := '0'; -- a reading shall begin
  signal is_valid_now : std_ulogic := '0';
  signal begun        : std_ulogic := '0'; -- there was a reading
  signal warning      : std_ulogic := '0';
  signal failure      : reason_t := fine;
  signal in_a_row     : natural range 0 to failures_most - 1 := 0;
  signal failures     : unsigned(15 downto 0) := (others => '0');
  signal age          : unsigned(19 downto 0) := age_most;
  signal stamp        : unsigned(31 downto 0) := (others => '0');
  signal raw          : raw_t := (others => '0');
  signal position     : signed(31 downto 0) := (others => '0');

begin

  registers : entity work.register_slave
    generic map (
      writable   => "1000001",
      data_width => data_width,
      initial    => (0 => (0 => '1', others => '0'), 1 to 6 => (others => '0')))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  read_words <= (
    0 => (0 => enable, others => '0'),
    1 => (0 => is_valid_now, 1 => warning, 4 => failure(0), 5 => failure(1), others => '0'),
    2 => extended(std_ulogic_vector(failures)),
    3 => extended(std_ulogic_vector(age)),
    4 => std_ulogic_vector(stamp),
    5 => std_ulogic_vector(resize(raw, 32)),
    6 => std_ulogic_vector(position));

  enable <= write_words(0)(0);

  position_wire <= is_valid_now & std_ulogic_vector(position);

  lines : entity work.absolute_encoder_line
    generic map (
      clock_hz => clock_hz, kind => kind, bits => bits, lead_bits => lead_bits, tail_bits => tail_bits, gray => gray,
      sclk_hz => sclk_hz, pause_us => pause_us)
    port map (
      clock => clock, reset => reset, rests => rests, ready => ready, begins => begins, now => now, ended => ended,
      accept => accept, reason => reason, value => value, warns => warns, began => began,
      sclk => sclk, select_n => select_n, mosi => mosi, miso => miso);

  begins  <= ready and enable and due;
  is_good <= '1' when reason = fine else '0';
  accept  <= ended and (not is_good or not wishbone_m2s.cyc);

  run : process (clock) is
    variable base : signed(31 downto 0);
  begin
    if rising_edge(clock) then
      sampled    <= accept and is_good;
      failed     <= accept and not is_good;
      now        <= now + 1;
      rate_phase <= ('0' & rate_phase(rate_bits - 1 downto 0)) + phase_increment(clock_hz, sample_hz);
      us_phase   <= ('0' & us_phase(us_bits - 1 downto 0)) + phase_increment(clock_hz, 1_000_000);
      due        <= (due or rate_phase(rate_bits)) and not begins;
      if us_phase(us_bits) = '1' and age /= age_most then
        age <= age + 1;
      end if;
      base := position;
      if written(6) = '1' then
        base := signed(write_words(6));
      end if;
      position <= base;

      if rests = '1' and enable = '0' then
        is_valid_now <= '0';
      elsif accept = '1' and is_good = '0' then
        failure  <= reason;
        failures <= failures + 1;
        if in_a_row = failures_most - 1 then
          in_a_row     <= 0;
          is_valid_now <= '0';
        else
          in_a_row <= in_a_row + 1;
        end if;
      elsif accept = '1' then
        is_valid_now <= '1';
        begun        <= '1';
        in_a_row     <= 0;
        failure      <= fine;
        warning      <= warns;
        stamp        <= began;
        age          <= (others => '0');
        raw          <= value;
        -- The shorter way from the last reading, or the way from zero.
        if begun = '1' then
          position <= base + resize(signed(value - raw), 32);
        else
          position <= resize(signed(value - first), 32);
        end if;
      end if;

      if reset = '1' then
        sampled      <= '0';
        failed       <= '0';
        rate_phase   <= (others => '0');
        us_phase     <= (others => '0');
        now          <= (others => '0');
        due          <= '0';
        is_valid_now <= '0';
        begun        <= '0';
        warning      <= '0';
        failure      <= fine;
        in_a_row     <= 0;
        failures     <= (others => '0');
        age          <= age_most;
        stamp        <= (others => '0');
        raw          <= (others => '0');
        position     <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
