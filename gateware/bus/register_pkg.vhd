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

end package;
