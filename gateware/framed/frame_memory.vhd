-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of the framed application: control registers, what its program keeps, tables (frame_layout_pkg).
--
-- Ports     index: the word that is looked at, which stands in `word` one clock later; in a clock in which something is stored
--           at index nothing is looked at. store: see frame_instruction_pkg, with `enable`, which may come late in the clock;
--           data: what store_data stores.
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
    content : word_memory_t  -- at power-up; as many as a power of two
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
  signal known  : word32_t;  -- and before the first clock, too, which a block RAM does not begin with
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

  -- No word is looked at in the clock in which it is stored: block RAMs do not agree about what that gives.
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
