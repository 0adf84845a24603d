-- SPDX-License-Identifier: BSD-3-Clause
--
-- The network registers of a TosNet ring: id and enabled registers of each node, in the order of the ring.
--
-- Write     write_entry and write_mask store one field each at write_index.
-- Read      entry and mask of read_index, one clock later. They are the fields of nodes that the ring does not have,
--           too: the reader counts.
-- Memory    16 words, which become block RAM. In the clock of a write, nothing is read, so that no logic around the RAM
--           has to say what comes then.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity tosnet_table is
  port (
    clock       : in  std_ulogic;
    write_entry : in  std_ulogic;
    write_mask  : in  std_ulogic;
    write_index : in  unsigned(3 downto 0);
    write_data  : in  std_ulogic_vector(7 downto 0);
    read_index  : in  unsigned(3 downto 0);
    entry       : out std_ulogic_vector(7 downto 0); -- address in the ring, id
    mask        : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of tosnet_table is

  type memory_t is array (0 to 15) of std_ulogic_vector(7 downto 0);

  signal entries, masks : memory_t := (others => x"00");

begin

  process (clock) is
  begin
    if rising_edge(clock) then
      if write_entry = '1' then
        entries(to_integer(write_index)) <= write_data;
      end if;
      if write_mask = '1' then
        masks(to_integer(write_index)) <= write_data;
      end if;
      if (write_entry or write_mask) = '0' then
        entry <= entries(to_integer(read_index));
        mask  <= masks(to_integer(read_index));
      end if;
    end if;
  end process;

end architecture;
