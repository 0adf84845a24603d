-- SPDX-License-Identifier: BSD-3-Clause
--
-- One direction of TosNet's asynchronous channel: a queue whose words are passed on with the network cycle.
--
--   write_valid/ready/data --> | up to `depth` words | -- three per cycle --> read_valid/ready/data
--
-- Travel    A cycle passes up to three words to the reading side, the oldest first. They must have been written before
--           the cycle.
-- pending   Words have arrived. read_valid follows within two clocks. Wait for it if no word may be missed.
-- Pressure  write_ready is low while `depth` words are in the queue, arrived or not. Nothing is lost.
-- Reset     Empties the queue.

library ieee;
  use ieee.std_logic_1164.all;

entity tosnet_channel is
  generic (
    depth : positive range 2 to 2 ** 16 := 128; -- words, a power of two
    width : positive := 38
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic; -- synchronous
    cycle       : in  std_ulogic; -- high in the clock that ends a network cycle
    write_valid : in  std_ulogic;
    write_ready : out std_ulogic;
    write_data  : in  std_ulogic_vector(width - 1 downto 0);
    pending     : out std_ulogic;
    read_valid  : out std_ulogic;
    read_ready  : in  std_ulogic;
    read_data   : out std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture rtl of tosnet_channel is

  constant words_a_cycle : positive := 3;

  signal travelling : natural range 0 to depth; -- written, but not arrived
  signal arrived    : natural range 0 to depth;
  signal put, take  : std_ulogic;
  signal oldest     : std_ulogic;               -- the oldest word has come out of the memory

begin

  write_ready <= '1' when travelling + arrived < depth else '0';
  pending     <= '1' when arrived > 0 else '0';
  read_valid  <= pending and oldest;
  put         <= write_valid and write_ready;
  take        <= read_valid and read_ready;

  queue : entity work.fifo
    generic map (width => width, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => put, write_ready => open, write_data => write_data,
      read_valid => oldest, read_ready => take, read_data => read_data);

  process (clock) is
    variable on_the_way : natural range 0 to depth + 1;
    variable there      : natural range 0 to depth;
  begin
    if rising_edge(clock) then
      on_the_way := travelling;
      there      := arrived;
      if put = '1' then
        on_the_way := on_the_way + 1;
      end if;
      if take = '1' then
        there := there - 1;
      end if;
      if cycle = '0' then
        travelling <= on_the_way;
        arrived    <= there;
      elsif on_the_way > words_a_cycle then
        travelling <= on_the_way - words_a_cycle;
        arrived    <= there + words_a_cycle;
      else
        travelling <= 0;
        arrived    <= there + on_the_way;
      end if;
      if reset = '1' then
        travelling <= 0;
        arrived    <= 0;
      end if;
    end if;
  end process;

end architecture;
