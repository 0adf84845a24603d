-- SPDX-License-Identifier: BSD-3-Clause
--
-- Compares a position with a place, and tells it by a pin: a pulse at each place of a row, or a level behind a place.
--
--   +0  bit 0 enable; bit 1 down: the places lie in the direction of falling positions; bit 2 level: no pulses    write
--   +1  the next place, two's complement                                                                          write
--   +2  the distance from place to place, 31 bits; 0: there is one place                                          write
--   +3  how often a place was reached since the reset; wraps at the word
--
--   position  0 1 2 3 4 5 6 7 8 9          at = 3, step = 3
--   pulses    ______/‾\___/‾\___/‾\_
--   level     ______/‾‾‾‾‾‾‾‾‾‾‾‾‾‾
--
-- Pulses    A place is reached when the position is at it or behind it, and has been before it since the last write of
--           +0 or +1. Then a pulse of pulse_ns comes, and +1 moves on by +2. If the position passes several places at
--           once, there is a pulse for each, with a clock between them. Without +2 there is one at each passing.
-- Level     The line is active while the position is at the place or behind it, and +1 stays.
-- Wire      position_wire is the position. While it is not valid, no place is reached, and a level rests. Then the
--           position must be before the place again. Differences wrap: a place is at most 2**31 - 1 counts away.
-- Event     reached: a pulse, or the begin of a level.
-- Latency   2 clocks per access (register_slave). The line follows the wire by 3 clocks, the event and +3 by 2. From a
--           write of +1 until it counts it takes 2 clocks more.
-- Errors    err for a write of +3 and for addresses from 4 on.
-- Reset     All words are 0. Without enable the line rests, from power-up on, and a pulse is cut.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity position_compare is
  generic (
    clock_hz     : positive                       := 50_000_000;
    pulse_ns     : positive range 20 to 1_000_000 := 1000; -- at least a clock
    active_level : natural range 0 to 1           := 1;    -- of a pulse, and of the level
    data_width   : positive range 32 to 32        := 32
  );
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic; -- synchronous
    wishbone_m2s  : in  wishbone_m2s_t;
    wishbone_s2m  : out wishbone_s2m_t;
    reached       : out std_ulogic := '0';

    position_wire : in  wire_t;

    line          : out std_ulogic
  );
end entity;

architecture rtl of position_compare is

  -- Rounded up. The whole product would not fit an integer.
  function pulse_clocks return positive is
    constant clock_khz : positive := (clock_hz + 999) / 1000;
    constant whole     : natural  := (pulse_ns / 1000) * clock_khz; -- thousandths of a clock
    constant rest      : natural  := (whole mod 1000) * 1000 + (pulse_ns mod 1000) * clock_khz; -- millionths
  begin
    return whole / 1000 + (rest + 999_999) / 1_000_000;
  end function;

  subtype word_t is unsigned(31 downto 0);

  signal read_words  : word_vector_t(0 to 3);
  signal write_words : word_vector_t(0 to 3);
  signal written     : std_ulogic_vector(0 to 3);

  signal enable, down, level : std_ulogic;
  signal step       : word_t;
  signal value      : word_t;
  signal behind     : unsigned(32 downto 0);
  signal onward     : unsigned(32 downto 0);
  signal at         : word_t := (others => '0');
  signal past       : std_ulogic := '0';                -- the position was at the place or behind it
  signal valid      : std_ulogic := '0';                -- and it was one
  signal fresh      : std_ulogic := '0';                -- and the place was this one
  signal armed      : std_ulogic := '0';                -- the position has been before the place
  signal current    : std_ulogic;
  signal usable     : std_ulogic;
  signal fires      : std_ulogic;
  signal pulse      : std_ulogic := '0';
  signal left       : natural range 0 to pulse_clocks - 1 := 0; -- clocks of the pulse behind this one
  signal above      : std_ulogic := '0';
  signal above_next : std_ulogic;
  signal count      : word_t := (others => '0');
  signal is_active  : std_ulogic := '0';

begin

  registers : entity work.register_slave
    generic map (writable => "1110", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written, was_read => open);

  read_words <= (
    0 => (2 => level, 1 => down, 0 => enable, others => '0'),
    1 => std_ulogic_vector(at),
    2 => std_ulogic_vector(step),
    3 => std_ulogic_vector(count));

  enable <= write_words(0)(0);
  down   <= write_words(0)(1);
  level  <= write_words(0)(2);
  step   <= '0' & unsigned(write_words(2)(30 downto 0));
  value  <= unsigned(value_of(position_wire));

  -- One adder for both directions, whose lowest bit makes its carry: how far the position is behind the place, or a
  -- count less for down. The same for the next place.
  behind <= (value & '1') + (not at & not down);
  onward <= (at & '1') + ((step xor (word_t'range => down)) & down);

  current    <= fresh and not written(0); -- before, `past` is of another place, or of the direction before a write
  usable     <= enable and valid and current;
  fires      <= usable and past and armed and not level and not pulse;
  above_next <= enable and valid and ((current and past) or (not current and above));

  process (clock) is
  begin
    if rising_edge(clock) then
      past    <= behind(32) xnor down;
      valid   <= is_valid(position_wire);
      fresh   <= '1';
      above   <= above_next;
      reached <= fires or (level and above_next and not above);

      if (fires or (level and above_next and not above)) = '1' then
        count <= count + 1;
      end if;

      if usable = '1' and past = '0' then
        armed <= '1';
      end if;
      if valid = '0' then
        armed <= '0';
      end if;
      if fires = '1' then
        armed <= or step;
        at    <= onward(32 downto 1);
      end if;
      if written(1) = '1' then
        at    <= unsigned(write_words(1));
        fresh <= '0';
      end if;
      if written(0) = '1' or written(1) = '1' then
        armed <= '0';
      end if;

      if fires = '1' then
        pulse <= '1';
        left  <= pulse_clocks - 1;
      elsif left = 0 then
        pulse <= '0';
      else
        left <= left - 1;
      end if;
      if enable = '0' or level = '1' then
        pulse <= '0';
      end if;

      is_active <= enable and pulse;
      if level = '1' then
        is_active <= enable and above;
      end if;

      if reset = '1' then
        reached   <= '0';
        at        <= (others => '0');
        fresh     <= '0';
        armed     <= '0';
        pulse     <= '0';
        above     <= '0';
        count     <= (others => '0');
        is_active <= '0';
      end if;
    end if;
  end process;

  line <= is_active xor to_bit(active_level = 0);

end architecture;
