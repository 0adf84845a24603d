-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of pdm with two channels of 4 bits, and bits of 5 clocks. A reference knows in which clock of a bit the
-- word is taken, and adds the densities up. From any clock `mark` on it compares them with the ones at the pins.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.wishbone_pkg.all;

entity pdm_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    mark  : in std_ulogic;
    word  : in unsigned(4 downto 0); -- shows the signals of the design
    total : in unsigned(3 downto 0)
  );
end entity;

architecture properties of pdm_formal is

  constant period : positive := 5;
  constant whole  : positive := 16;
  constant start  : positive := 5;

  subtype word_t is unsigned(4 downto 0);
  subtype off_t is signed(5 downto 0);
  type words_t is array (0 to 1) of word_t;
  type offs_t is array (0 to 1) of off_t;

  constant started : words_t := (others => to_unsigned(start, 5));
  constant zeros   : words_t := (others => (others => '0'));

  signal s2m       : wishbone_s2m_t;
  signal pins      : std_ulogic_vector(1 downto 0);
  signal begun     : std_ulogic := '0';
  signal was_reset : std_ulogic := '0';
  signal asked     : std_ulogic := '0';
  signal clearing  : unsigned(3 downto 0) := "1000";        -- clocks until accesses are answered
  signal known     : std_ulogic;
  signal address   : natural range 0 to 1;
  signal expected  : word_t := (others => '0');             -- of a read that is answered now
  signal words     : words_t := started;
  signal taken     : words_t := zeros;                      -- … when they were taken
  signal totals    : words_t := zeros;
  signal places    : unsigned(2 downto 0) := "001";         -- the clock within the bit; 0 is the last one
  signal opened    : std_ulogic := '0';                     -- the first bit has begun
  signal levels    : std_ulogic_vector(1 downto 0) := "00";
  signal given     : std_ulogic_vector(1 downto 0) := "00"; -- the pin has the bit of `taken` since this clock
  signal behind    : words_t := zeros;                      -- the total behind the bit at the pin
  signal marked    : words_t := zeros;                      -- … at the mark
  signal off       : offs_t := (others => (others => '0')); -- ones less densities since the mark, in 1/16

  -- A density from 16 on is all ones.
  function share_of (word : word_t) return word_t is
  begin
    if word >= whole then
      return to_unsigned(whole, 5);
    end if;
    return word;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.pdm
    generic map (
      clock_hz => 5_000_000, channels => 2, rate_hz => 1_000_000, bits => 4, start => start, pulse_ns => 1000,
      data_width => 16)
    port map (clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pins => pins);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  asked   <= m2s.cyc and m2s.stb and not s2m.ack and not s2m.err and to_bit(clearing = 0);
  address <= to_integer(unsigned(m2s.adr(0 downto 0)));
  known   <= (nor m2s.adr(31 downto 1)) and (not m2s.we or and m2s.sel(1 downto 0));

  follow : process (clk) is
    variable sum : word_t;
  begin
    if rising_edge(clk) then
      begun     <= '1';
      was_reset <= reset;
      expected  <= words(address);
      if asked = '1' and known = '1' and m2s.we = '1' then
        words(address) <= unsigned(m2s.dat(4 downto 0));
      end if;

      given <= "00";
      if clearing /= 0 then
        clearing <= clearing - 1;
      else
        places <= places + 1;
        if places = period - 1 then
          places <= (others => '0');
        end if;
        if places = 0 then
          opened <= '1';
        end if;
      end if;
      for channel in 0 to 1 loop
        if places = 2 * channel + 1 then
          taken(channel) <= words(channel);
        elsif places = 2 * channel + 2 and opened = '1' then
          sum             := totals(channel) + share_of(taken(channel));
          levels(channel) <= sum(4);
          totals(channel) <= '0' & sum(3 downto 0);
          given(channel)  <= '1';
        end if;
        if given(channel) = '1' then
          behind(channel) <= totals(channel);
          off(channel)    <= off(channel) - signed('0' & share_of(taken(channel)));
          if pins(channel) = '1' then
            off(channel) <= off(channel) - signed('0' & share_of(taken(channel))) + whole;
          end if;
        end if;
        if mark = '1' or reset = '1' then
          off(channel)    <= (others => '0');
          marked(channel) <= behind(channel);
          if given(channel) = '1' then
            marked(channel) <= totals(channel);
          end if;
        end if;
      end loop;

      if reset = '1' then
        clearing <= "1000";
        words    <= started;
        totals   <= zeros;
        marked   <= zeros;
        places   <= "001";
        opened   <= '0';
        levels   <= "00";
        given    <= "00";
        behind   <= zeros;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and reset = '0' -> next (m2s.stb = '1');

  -- Nothing is accepted but the channels, and no write of a part of a word.
  refused : assert always begun = '1' and s2m.ack = '1' -> known = '1';

  -- Nothing else is refused.
  only_these_refused : assert always begun = '1' and s2m.err = '1' -> known = '0';

  -- An access takes two clocks.
  two_clocks : assert always begun = '1' and reset = '0' and asked = '1' and m2s.cyc = '1' ->
                      next (s2m.ack = '1' or s2m.err = '1');

  -- A read gives what was written last, or the density of the start after a reset.
  words_kept : assert always begun = '1' and s2m.ack = '1' and m2s.we = '0' ->
                      unsigned(s2m.dat(4 downto 0)) = expected;

  -- Each bit is the carry of the total and the density. The density is the word at one clock of the bit before. The pin
  -- changes in no other clock, so a bit lasts 5 clocks.
  bit_is_carry : assert always begun = '1' -> pins = levels;

  -- From any clock to any later one, the ones of channel 0 are less than one off from the sum of its densities.
  ones_follow_0 : assert always begun = '1' -> off(0) > -whole and off(0) < whole;

  -- So are those of channel 1.
  ones_follow_1 : assert always begun = '1' -> off(1) > -whole and off(1) < whole;

  -- They are off by as much as the total was then, less what it is now.
  off_is_total_0 : assert always begun = '1' -> off(0) = signed('0' & marked(0)) - signed('0' & behind(0));

  -- So are those of channel 1.
  off_is_total_1 : assert always begun = '1' -> off(1) = signed('0' & marked(1)) - signed('0' & behind(1));

  -- In the turn of channel 0 the adder has its density and its total.
  adds_0 : assert always opened = '1' and places = 2 -> word = taken(0) and total = totals(0)(3 downto 0);

  -- In the turn of channel 1 it has those of channel 1.
  adds_1 : assert always opened = '1' and places = 4 -> word = taken(1) and total = totals(1)(3 downto 0);

  -- A density of 0 gives no one, whatever came before.
  no_density_is_low : assert always given(0) = '1' and taken(0) = 0 -> pins(0) = '0';

  -- A density of 16 and more gives a one, whatever came before.
  all_is_high : assert always given(0) = '1' and taken(0) >= whole -> pins(0) = '1';

  -- A reset makes the pins low at once.
  reset_is_low : assert always was_reset = '1' -> pins = "00";

  -- A word is written in the clock in which the old one is taken.
  written_when_taken : cover {begun = '1' and places = 1 and asked = '1' and m2s.we = '1' and known = '1' and
                              address = 0 and unsigned(m2s.dat(4 downto 0)) /= words(0)};

  -- There are as many more ones than the densities as may be.
  most_off : cover {off(0) = whole - 1};

  -- There are as many fewer ones.
  least_off : cover {off(1) = 1 - whole};

end architecture;
