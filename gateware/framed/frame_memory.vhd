-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of the framed application: control registers, the program's own words, and tables (frame_layout_pkg).
--
-- Ports     index: the address of a word, which is in `word` two clocks later. store: see frame_instruction_pkg. What
--           is counted up is the word that was addressed in the clock before.
--           enable: goes with `store`, and may come late in the clock. data: the value of store_data, a clock later.
-- Latency   Two clocks, because a block RAM may need most of a clock. A word is stored one clock late: whoever
--           addresses it in the next clock gets any value.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.width_pkg.all;

entity frame_memory is
  generic (
    content : word_memory_t  -- at power-up; its length is a power of two
  );
  port (
    clock : in  std_ulogic;
    index : in  unsigned(bits_for(content'length) - 1 downto 0);
    store : in  std_ulogic_vector(1 downto 0);
    enable : in std_ulogic;
    data  : in  word32_t;
    word  : out word32_t
  );
end entity;

architecture rtl of frame_memory is

  signal words  : word_memory_t(0 to content'length - 1) := content;
  signal looked : word32_t;
  signal kept   : word32_t := (others => '0');   -- what was looked at
  signal stored : word32_t;
  signal full   : std_ulogic;                    -- it is all ones, so it is not counted up
  signal noted, counts, limits : std_ulogic := '0';
  signal stores : std_ulogic;
  signal place  : unsigned(index'range) := (others => '0');

begin

  word   <= kept;
  stored <= std_ulogic_vector(unsigned(kept) + 1) when counts = '1' else data;
  full <= limits and and kept;
  stores <= noted and not full;

  choose : process (clock)
  begin
    if rising_edge(clock) then
      noted  <= enable and or store;
      counts <= store(store'left);
      limits <= to_bit(store = store_count);
      place  <= index;
      kept   <= to_stdulogicvector(to_bitvector(looked));  -- known before the first look, too
    end if;
  end process;

  move : process (clock)
  begin
    if rising_edge(clock) then
      if stores = '1' then
        words(to_integer(place)) <= stored;
      end if;
      looked <= words(to_integer(index));
      if stores = '1' and place = index then
        looked <= (others => '-');  -- block RAMs differ in what such a read gives
      end if;
    end if;
  end process;

end architecture;
