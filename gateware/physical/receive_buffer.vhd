-- SPDX-License-Identifier: BSD-3-Clause
--
-- The receive buffer of a line that cannot wait. It holds bytes, and errors in their place between them.
--
--   line_valid/ready/data/error --> fifo --+--> rx_valid/ready/data
--                                          +--> rx_error
--
-- Items     An item is a byte. If a bit of line_error is set, it is an error instead.
-- Errors    rx_error pulses for one clock after all bytes before it were taken, and before any byte after it is
--           offered. It has no ready, so it must be taken at once. The bits are those of physical_pkg.
-- Pressure  line_ready is low while the memory is full. The source must then hold its item, or report an overrun.
-- Latency   2 clocks from line_valid to rx_valid or rx_error.
-- Capacity  rx_depth items in the memory and one at its output.
-- Reset     Empties the buffer.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity receive_buffer is
  generic (
    rx_depth : positive := 16 -- items, a power of two
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    line_valid : in  std_ulogic;
    line_ready : out std_ulogic;
    line_data  : in  std_ulogic_vector(7 downto 0);
    line_error : in  receive_error_t;

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t
  );
end entity;

architecture rtl of receive_buffer is

  -- The error is above the data.
  subtype item_t is std_ulogic_vector(receive_error_t'length + 7 downto 0);

  signal line_item, item        : item_t;
  signal item_valid, item_ready : std_ulogic;
  signal is_byte                : std_ulogic;

begin

  line_item <= line_error & line_data;

  items : entity work.fifo
    generic map (width => item_t'length, depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => line_valid, write_ready => line_ready, write_data => line_item,
      read_valid => item_valid, read_ready => item_ready, read_data => item);

  is_byte    <= '1' when item(item_t'high downto 8) = no_receive_error else '0';
  rx_valid   <= item_valid and is_byte;
  rx_data    <= item(7 downto 0);
  rx_error   <= item(item_t'high downto 8) when item_valid = '1' else no_receive_error;
  item_ready <= rx_ready or not is_byte;

end architecture;
