-- SPDX-License-Identifier: BSD-3-Clause
--
-- First-in first-out buffer on one clock, first word falls through.
--
--   write_valid/ready/data --> | memory of `depth` words | --> output register --> read_valid/ready/data
--
-- Ports     A word moves on a side in every clock in which its valid and ready are both high.
-- Latency   A word written into an empty buffer is on read_data two clocks later; then one word a clock, both sides.
-- Capacity  `depth` words in the memory and one in the output register. The read side is a plain synchronous memory
--           read, so that large buffers become block RAM.
-- Pressure  write_ready is low while the memory is full; nothing is ever lost or overwritten.
-- Reset     Empties the buffer; memory contents stay and do not matter.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.width_pkg.all;

entity fifo is
  generic (
    width : positive := 8;
    depth : positive := 16  -- words, a power of two
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    write_valid : in  std_ulogic;
    write_ready : out std_ulogic;
    write_data  : in  std_ulogic_vector(width - 1 downto 0);
    read_valid  : out std_ulogic;
    read_ready  : in  std_ulogic;
    read_data   : out std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture rtl of fifo is

  constant index_bits : positive := bits_for(depth);

  type memory_t is array (0 to 2 ** index_bits - 1) of std_ulogic_vector(width - 1 downto 0);

  signal memory : memory_t;

  -- One bit more than an index: equal pointers mean empty, pointers `depth` apart mean full.
  signal write_pointer : unsigned(index_bits downto 0) := (others => '0');
  signal read_pointer  : unsigned(index_bits downto 0) := (others => '0');
  signal loaded        : std_ulogic := '0';
  signal empty, full   : std_ulogic;
  signal load          : std_ulogic;

begin

  assert depth = 2 ** index_bits
    report "fifo: depth must be a power of two and at least 2" severity failure;

  empty <= '1' when write_pointer = read_pointer else '0';
  full  <= '1' when write_pointer = (not read_pointer(index_bits) & read_pointer(index_bits - 1 downto 0)) else '0';
  load  <= not empty and (not loaded or read_ready);

  write_ready <= not full;
  read_valid  <= loaded;

  store : process (clock)
  begin
    if rising_edge(clock) then
      if write_valid = '1' and full = '0' then
        memory(to_integer(write_pointer(index_bits - 1 downto 0))) <= write_data;
      end if;
      if load = '1' then
        read_data <= memory(to_integer(read_pointer(index_bits - 1 downto 0)));
      end if;
    end if;
  end process;

  count : process (clock)
  begin
    if rising_edge(clock) then
      if write_valid = '1' and full = '0' then
        write_pointer <= write_pointer + 1;
      end if;
      if load = '1' then
        read_pointer <= read_pointer + 1;
        loaded       <= '1';
      elsif read_ready = '1' then
        loaded <= '0';
      end if;
      if reset = '1' then
        write_pointer <= (others => '0');
        read_pointer  <= (others => '0');
        loaded        <= '0';
      end if;
    end if;
  end process;

end architecture;
