-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of the framed application: control registers, the program's own words, and tables (frame_layout_pkg).
--
-- Ports     index: the address of a word, which is in `word` one clock later. A clock that stores reads no word.
--           store: see frame_instruction_pkg. enable: goes with `store`, and may come late in the clock. data: the
--           value of store_data.
-- Latency   One clock.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

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
  signal known  : word32_t;  -- known before the first clock, when a block RAM has no output yet
  signal stored : word32_t;
  signal ones   : std_ulogic;

begin

  known <= to_stdulogicvector(to_bitvector(looked));
  word <= known;
  ones <= and known;

  choose : process (all)
  begin
    stored <= data;
    if store(store'left) = '1' then
      stored <= std_ulogic_vector(unsigned(looked) + unsigned'("" & (store(store'right) or not ones)));
    end if;
  end process;

  -- A clock that stores reads no word, because block RAMs differ in what such a read gives.
  move : process (clock)
  begin
    if rising_edge(clock) then
      if enable = '1' and store /= store_nothing then
        words(to_integer(index)) <= stored;
      end if;
      if enable = '0' or store = store_nothing then
        looked <= words(to_integer(index));
      end if;
    end if;
  end process;

end architecture;
