-- SPDX-License-Identifier: BSD-3-Clause
--
-- First-in first-out buffer on one clock. The first word falls through.
--
--   write_valid/ready/data --> | memory of `depth` words | --> output register --> read_valid/ready/data
--
-- Ports     A word moves on a side in every clock in which its valid and ready are both high.
-- Latency   A word written into an empty buffer is on read_data two clocks later. After that, one word per clock on
--           both sides.
-- Capacity  `depth` words in the memory and one in the output register. The read side is a plain synchronous memory
--           read, so large buffers become block RAM.
-- Pressure  write_ready is low while the memory is full. Nothing is ever lost or overwritten.
-- Reset     Empties the buffer. The memory keeps its contents, which are not used.

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

  -- Equal indices mean full or empty. The flag is a register, because a comparison would make write_ready late.
  signal write_index, read_index : unsigned(index_bits - 1 downto 0) := (others => '0');
  signal full         : std_ulogic := '0';
  signal loaded       : std_ulogic := '0';
  signal empty        : std_ulogic;
  signal last_place   : std_ulogic;  -- the memory has room for one word
  signal store, load  : std_ulogic;

begin

  assert depth = 2 ** index_bits
    report "fifo: depth must be a power of two and at least 2" severity failure;

  empty      <= '1' when read_index = write_index and full = '0' else '0';
  last_place <= '1' when write_index + 1 = read_index else '0';

  store <= write_valid and not full;
  load  <= not empty and (not loaded or read_ready);

  write_ready <= not full;
  read_valid  <= loaded;

  move : process (clock)
  begin
    if rising_edge(clock) then
      if store = '1' then
        memory(to_integer(write_index)) <= write_data;
      end if;
      if load = '1' then
        read_data <= memory(to_integer(read_index));
      end if;
    end if;
  end process;

  count : process (clock)
  begin
    if rising_edge(clock) then
      write_index <= write_index + unsigned'("" & store);
      read_index  <= read_index + unsigned'("" & load);  -- an adder is faster than an enable
      full        <= (full or (last_place and store)) and not load;
      loaded      <= load or (loaded and not read_ready);
      if reset = '1' then
        write_index <= (others => '0');
        read_index  <= (others => '0');
        full        <= '0';
        loaded      <= '0';
      end if;
    end if;
  end process;

end architecture;
