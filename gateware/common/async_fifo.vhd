-- SPDX-License-Identifier: BSD-3-Clause
--
-- First-in first-out buffer between two independent clocks. The first word falls through.
--
--   write_clock                                                          read_clock
--   write_valid/ready/data --> | memory of `depth` words | --> output register --> read_valid/ready/data
--             write count, grey ---- synchroniser ----------------> what is there to read
--      what is free to write <-------------- synchroniser ----- read count, grey
--
-- Ports     A word moves on a side in every clock in which its valid and ready are both high.
-- Margin    write_ready falls while there is still room for `margin` words. This is for a writer that cannot stop at
--           once: so many words are taken while write_ready is low.
-- Crossing  Only one bit of a Grey count changes at a time. So a reader that samples it during a change sees the old
--           count or the new one. Both counts come out of registers. Their bits must arrive within one clock of each
--           other. `unitylink build` writes that constraint: set_max_delay of the period they come from, no false path.
-- Latency   A word written into an empty buffer is on read_data after 3 to 4 clocks of the reader. A word taken makes
--           room after 3 to 4 clocks of the writer. One word per clock, if depth is at least 8.
-- Capacity  `depth` words in the memory and one in the output register.
-- Reset     Each reset is synchronous to its clock. Both sides must be in reset at the same time once, and neither may
--           leave before the other has been in it. ft245_sync shows a way. Until then nothing is ready and nothing
--           valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;

entity async_fifo is
  generic (
    width  : positive := 8;
    depth  : positive := 16; -- words, a power of two, at least 4
    margin : natural  := 0   -- words
  );
  port (
    write_clock : in  std_ulogic;
    write_reset : in  std_ulogic;
    write_valid : in  std_ulogic;
    write_ready : out std_ulogic := '0';
    write_data  : in  std_ulogic_vector(width - 1 downto 0);

    read_clock : in  std_ulogic;
    read_reset : in  std_ulogic;
    read_valid : out std_ulogic;
    read_ready : in  std_ulogic;
    read_data  : out std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture rtl of async_fifo is

  constant index_bits : positive := bits_for(depth);

  type memory_t is array (0 to depth - 1) of std_ulogic_vector(width - 1 downto 0);
  subtype count_t is unsigned(index_bits downto 0); -- counts all words so far, so that full differs from empty

  function grey (count : count_t) return count_t is
  begin
    return count xor ('0' & count(count'left downto 1));
  end function;

  function binary (grey : count_t) return count_t is
    variable count : count_t := grey;
  begin
    for place in count'left - 1 downto 0 loop
      count(place) := count(place + 1) xor grey(place);
    end loop;
    return count;
  end function;

  signal memory : memory_t;

  signal write_count, write_grey     : count_t := (others => '0');
  signal read_grey_seen              : std_ulogic_vector(count_t'range); -- synchronised to the writer's clock
  signal read_seen                   : count_t := (others => '0');
  signal has_room                    : std_ulogic := '0';

  signal read_count, read_grey       : count_t := (others => '0');
  signal write_grey_seen             : std_ulogic_vector(count_t'range); -- synchronised to the reader's clock
  signal data_crossed                : std_ulogic_vector(width - 1 downto 0); -- of the memory: it stood still
  signal loaded                      : std_ulogic := '0';
  signal store, load                 : std_ulogic;

begin

  assert depth = 2 ** index_bits and depth >= 4
    report "async_fifo: depth must be a power of two and at least 4" severity failure;
  assert margin < depth
    report "async_fifo: margin must be less than depth" severity failure;

  store <= write_valid and has_room;
  load  <= '1' when read_grey /= unsigned(write_grey_seen) and (loaded = '0' or read_ready = '1') else '0';

  read_valid <= loaded;
  read_data  <= data_crossed;

  read_synchroniser : entity work.synchroniser
    generic map (width => index_bits + 1)
    port map (
      clock => write_clock, reset => write_reset,
      asynchronous => std_ulogic_vector(read_grey), levels => read_grey_seen);

  write_synchroniser : entity work.synchroniser
    generic map (width => index_bits + 1)
    port map (
      clock => read_clock, reset => read_reset,
      asynchronous => std_ulogic_vector(write_grey), levels => write_grey_seen);

  write_side : process (write_clock) is
    variable count : count_t;
    variable held  : count_t;
  begin
    if rising_edge(write_clock) then
      read_seen <= binary(unsigned(read_grey_seen));

      count       := write_count + unsigned'("" & store);
      write_count <= count;
      write_grey  <= grey(count);

      held        := count - read_seen;
      has_room    <= '0' when held = depth else '1';
      write_ready <= '1' when held < depth - margin else '0';

      if write_reset = '1' then
        read_seen   <= (others => '0');
        write_count <= (others => '0');
        write_grey  <= (others => '0');
        has_room    <= '0';
        write_ready <= '0';
      end if;
    end if;
  end process;

  write_memory : process (write_clock) is
  begin
    if rising_edge(write_clock) then
      if store = '1' then
        memory(to_integer(write_count(index_bits - 1 downto 0))) <= write_data;
      end if;
    end if;
  end process;

  read_memory : process (read_clock) is
  begin
    if rising_edge(read_clock) then
      if load = '1' then
        data_crossed <= memory(to_integer(read_count(index_bits - 1 downto 0)));
      end if;
    end if;
  end process;

  read_side : process (read_clock) is
    variable count : count_t;
  begin
    if rising_edge(read_clock) then
      count      := read_count + unsigned'("" & load);
      read_count <= count;
      read_grey  <= grey(count);
      loaded     <= load or (loaded and not read_ready);

      if read_reset = '1' then
        read_count   <= (others => '0');
        read_grey    <= (others => '0');
        loaded       <= '0';
      end if;
    end if;
  end process;

end architecture;
