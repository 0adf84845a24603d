-- SPDX-License-Identifier: BSD-3-Clause
--
-- Incremental encoder on the Wishbone bus: position from two signals a quarter period apart, four counts per period.
--
--   a      __/‾‾‾\___/‾‾‾\__        a before b counts up
--   b      ____/‾‾‾\___/‾‾‾\
--   index  ____/‾\__________        once per turn
--
--   +0  position, two's complement; wraps at the word          write: preset
--   +1  position at the last rising edge of index
--   +2  rising edges of index so far; wraps at the word
--   +3  impossible steps: both signals changed at once         write: sets the number
--
-- Reads give the words of the moment when cyc rose, so a publish of many encoders has one moment for all. A preset
-- loses no step that comes in the same clock.
--
-- Speed     At most one step per stable_clocks. A faster step is counted in +3, and the position is then wrong by at
--           least two counts.
-- Latency   2 clocks per access (register_slave). The position follows the pins 3 + stable_clocks clocks later.
-- Errors    err for writes to +1 and +2 and for addresses from 4 on.
-- Reset     All words are zero. If the reset lasts at least 5 clocks, the levels of the pins at that time are not
--           counted as a step.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity quadrature_encoder is
  generic (
    data_width    : positive range 8 to 32 := 32;
    stable_clocks : positive               := 2 -- clocks for which a level must be stable
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    a     : in std_ulogic; -- asynchronous, like the next two
    b     : in std_ulogic;
    index : in std_ulogic := '0'
  );
end entity;

architecture rtl of quadrature_encoder is

  signal read_words  : word_vector_t(0 to 3);
  signal write_words : word_vector_t(0 to 3);
  signal written     : std_ulogic_vector(0 to 3);

  signal levels, before : std_ulogic_vector(2 downto 0); -- index, b, a
  signal position       : unsigned(word_t'range);
  signal index_position : unsigned(word_t'range);
  signal index_count    : unsigned(word_t'range);
  signal impossible     : unsigned(word_t'range);

begin

  registers : entity work.register_slave
    generic map (writable => "1001", data_width => data_width, snapshot => true)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  inputs : entity work.input_filter
    generic map (width => 3, stable_clocks => stable_clocks)
    port map (
      clock => clock, reset => reset,
      pins(0) => a, pins(1) => b, pins(2) => index, levels => levels);

  read_words <= (
    std_ulogic_vector(position), std_ulogic_vector(index_position), std_ulogic_vector(index_count),
    std_ulogic_vector(impossible));

  process (clock) is
    variable changed_a, changed_b : std_ulogic;
    variable next_position        : unsigned(word_t'range);
    variable next_impossible      : unsigned(word_t'range);
  begin
    if rising_edge(clock) then
      before    <= levels;
      changed_a := levels(0) xor before(0);
      changed_b := levels(1) xor before(1);

      next_position   := position;
      next_impossible := impossible;
      if written(0) = '1' then
        next_position := unsigned(write_words(0));
      end if;
      if written(3) = '1' then
        next_impossible := unsigned(write_words(3));
      end if;

      if (changed_a and changed_b) = '1' then
        next_impossible := next_impossible + 1;
      elsif (changed_a or changed_b) = '1' then
        if (levels(0) xor before(1)) = '1' then
          next_position := next_position + 1;
        else
          next_position := next_position - 1;
        end if;
      end if;
      position   <= next_position;
      impossible <= next_impossible;

      if levels(2) = '1' and before(2) = '0' then
        index_position <= next_position;
        index_count    <= index_count + 1;
      end if;

      if reset = '1' then
        before         <= levels;
        position       <= (others => '0');
        index_position <= (others => '0');
        index_count    <= (others => '0');
        impossible     <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
