-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of the framed application: control registers, the program's own words, and tables (frame_layout_pkg).
--
-- Ports     index: the address of a word, which is in `word` one clock later. store: see frame_instruction_pkg.
--           enable: goes with `store`, and may come late in the clock. data: the value of store_data.
-- Latency   One clock. A word is stored one clock late: whoever reads it in the next clock gets any value.
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
  signal known  : word32_t;    -- known before the first clock, when a block RAM has no output yet
  signal full   : std_ulogic;  -- the word is all ones, so it is not counted up
  signal stores : std_ulogic := '0';
  signal place  : unsigned(index'range) := (others => '0');
  signal stored : word32_t;

begin

  known <= to_stdulogicvector(to_bitvector(looked));
  word  <= known;
  full  <= to_bit(store = store_count) and and known;

  choose : process (clock)
  begin
    if rising_edge(clock) then
      stores <= enable and or store and not full;
      place  <= index;
      stored <= data;
      if store(store'left) = '1' then
        stored <= std_ulogic_vector(unsigned(looked) + 1);
      end if;
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
