-- SPDX-License-Identifier: BSD-3-Clause
--
-- Words side by side, one for each address: the signals between a register slave and the logic behind it.

library ieee;
  use ieee.std_logic_1164.all;
  use work.wishbone_pkg.all;

package register_pkg is

  subtype word_t is std_ulogic_vector(wishbone_data_width - 1 downto 0);
  type word_vector_t is array (natural range <>) of word_t;

  constant no_words : word_vector_t(1 to 0) := (others => (others => '0'));

  -- `bits` as the lowest bits of a word.
  function extended (bits : std_ulogic_vector) return word_t;

end package;

package body register_pkg is

  function extended (bits : std_ulogic_vector) return word_t is
    variable result : word_t := (others => '0');
  begin
    result(bits'length - 1 downto 0) := bits;
    return result;
  end function;

end package body;
