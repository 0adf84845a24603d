-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of pwm with one channel and a period of 16 clocks. A reference knows in which clock of a period the word
-- is taken, and says for how many clocks the pin must then be high. It divides where the design multiplies bit by bit.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.wishbone_pkg.all;

entity pwm_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    step    : in unsigned(3 downto 0);  -- shows the signals of the design
    product : in signed(6 downto 0);
    word    : in unsigned(12 downto 0);
    turning : in std_ulogic
  );
end entity;

architecture properties of pwm_formal is

  constant period : positive := 16;
  constant whole  : positive := 4096;  -- a share of it is always high

  subtype place_t is unsigned(3 downto 0);
  subtype word_t is unsigned(12 downto 0);
  subtype width_t is unsigned(4 downto 0);

  signal s2m      : wishbone_s2m_t;
  signal pin      : std_ulogic;
  signal begun    : std_ulogic := '0';
  signal asked    : std_ulogic := '0';
  signal was_asked : std_ulogic := '0';
  signal clearing : unsigned(2 downto 0) := "100";      -- clocks until accesses are answered
  signal known    : std_ulogic;
  signal enable   : std_ulogic := '0';
  signal share    : word_t := (others => '0');          -- the word of the channel
  signal taken    : word_t := (others => '0');          -- … when it was taken
  signal place    : place_t := (others => '0');         -- the clock within the period
  signal opened   : std_ulogic := '0';                  -- a period has begun before
  signal width    : width_t := (others => '0');         -- clocks for which the pin is high in this period
  signal address  : natural range 0 to 3;
  signal expected : word_t;                             -- of a read that is answered now
  signal partial  : signed(19 downto 0);                -- the product of the bits so far

  -- Clocks of the period for a share, rounded up.
  function clocks_of(share : word_t) return width_t is
  begin
    if share >= whole then
      return to_unsigned(period, 5);
    end if;
    return resize(shift_right(share + (whole / period - 1), 8), 5);
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.pwm
    generic map (clock_hz => 10_000_000, channels => 1, frequency_hz => 625_000, data_width => 16)
    port map (clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pins(0) => pin);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  asked   <= m2s.cyc and m2s.stb and not s2m.ack and not s2m.err and to_bit(clearing = 0);
  address <= to_integer(unsigned(m2s.adr(1 downto 0)));
  known   <= to_bit((nor m2s.adr(31 downto 2)) = '1' and (address = 0 or address = 2)) and
             (not m2s.we or and m2s.sel(1 downto 0));

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun     <= '1';
      was_asked <= asked;
      if clearing /= 0 then
        clearing <= clearing - 1;
      end if;
      expected <= share;
      if address = 0 then
        expected <= (0 => enable, others => '0');
      end if;
      if asked = '1' and known = '1' and m2s.we = '1' then
        if address = 0 then
          enable <= m2s.dat(0);
        else
          share <= unsigned(m2s.dat(12 downto 0));
        end if;
      end if;

      place <= place + 1;
      if place = 0 then
        width  <= (others => '0');
        opened <= '1';
        if opened = '1' then
          width <= clocks_of(taken);
        end if;
      elsif place = 1 then
        taken <= share;
      end if;
      if enable = '0' then
        place  <= (others => '0');
        opened <= '0';
        width  <= (others => '0');
      end if;
      if reset = '1' then
        clearing  <= "100";
        enable    <= '0';
        share     <= (others => '0');
        was_asked <= '0';
        place     <= (others => '0');
        opened    <= '0';
        width     <= (others => '0');
      end if;
    end if;
  end process;

  multiply : process (all) is
    variable bits : word_t;
  begin
    bits := taken;
    if taken >= whole then
      bits := to_unsigned(whole, 13);
    end if;
    -- The bits that have been added.
    for number in 0 to 12 loop
      if number + 1 >= step then
        bits(number) := '0';
      end if;
    end loop;
    partial <= shift_right(signed(resize(bits, 15) & "00000") - 1, to_integer(step) - 1);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and reset = '0' -> next (m2s.stb = '1');

  -- Nothing is accepted but +0 and the channels, and no write of a part of a word.
  refused : assert always begun = '1' and s2m.ack = '1' -> known = '1';

  -- Nothing else is refused.
  only_these_refused : assert always begun = '1' and s2m.err = '1' -> known = '0';

  -- An access takes two clocks.
  two_clocks : assert always begun = '1' and reset = '0' and asked = '1' and m2s.cyc = '1' ->
                      next (s2m.ack = '1' or s2m.err = '1');

  -- A read gives what was written last, or zero after a reset.
  words_kept : assert always begun = '1' and s2m.ack = '1' and m2s.we = '0' ->
                      unsigned(s2m.dat(12 downto 0)) = expected;

  -- The product is that of the bits so far. It is rounded up and less 1.
  product_grows : assert always begun = '1' and enable = '1' and turning = '1' and step > 0 ->
                         word = taken and resize(product, 20) = partial;

  -- In each period the pin is high for its share of the clocks, rounded up, from the same clock on. The share is the
  -- word at one clock of the period before. So no pulse is a mixture of two words.
  pulse_is_right : assert always begun = '1' and opened = '1' -> pin = to_bit((place - 1) < width);

  -- The pin is low in the first period, and while it is not enabled.
  low_before : assert always begun = '1' and opened = '0' and reset = '0' -> pin = '0';

  -- A reset makes the pin low at once.
  reset_is_low : assert always reset = '1' -> next (pin = '0');

  -- A word is written in the clock in which the old one is taken.
  written_when_taken : cover {begun = '1' and place = 1 and asked = '1' and m2s.we = '1' and address = 2 and
                              taken /= 0 and unsigned(m2s.dat(12 downto 0)) /= share};

end architecture;
