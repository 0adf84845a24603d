-- SPDX-License-Identifier: BSD-3-Clause
--
-- UART physical layer: an asynchronous line on one side, byte streams with buffers on the other.
--
--   rx_line --> uart_rx --> fifo --+--> rx_valid/ready/data
--                                  +--> rx_error              in its place between the bytes
--   tx_line <-- uart_tx <-- fifo <----- tx_valid/ready/data
--
-- Errors    What went wrong travels through the receive buffer with the bytes. rx_error pulses for one clock after every
--           byte before it was taken and before any behind it is offered, so that the datalink blames the right message.
--           No ready: it must be taken at once. Bits as in physical_pkg: parity, framing, overrun.
-- Pressure  tx_ready is low while the transmit buffer is full. The line cannot be stalled: once rx_depth + 2 characters
--           wait, further ones are lost and an overrun stands in their place.
-- Latency   Receive: 7 clocks from the middle of the stop bit to rx_valid. Transmit: 3 clocks from tx_valid to the start bit.
-- Baud rate, guard against metastability and spikes, break: see uart_rx and uart_tx.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity uart is
  generic (
    clock_hz  : positive              := 50_000_000;
    baud_hz   : positive              := 3_000_000;
    parity    : parity_t              := none;
    stop_bits : positive range 1 to 2 := 1;
    rx_depth  : positive              := 16; -- bytes, a power of two
    tx_depth  : positive              := 16  -- bytes, a power of two
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    rx_line    : in  std_ulogic; -- asynchronous
    tx_line    : out std_ulogic;
    line_break : out std_ulogic; -- one clock, when the line saw it: not in its place between the bytes

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t;

    tx_valid : in  std_ulogic;
    tx_ready : out std_ulogic;
    tx_data  : in  std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of uart is

  -- A character or an error in place of one: error above data.
  subtype item_t is std_ulogic_vector(receive_error_t'length + 7 downto 0);

  signal line_valid, line_ready : std_ulogic;
  signal line_item              : item_t;
  signal item_valid, item_ready : std_ulogic;
  signal item                   : item_t;
  signal is_byte                : std_ulogic;
  signal send_valid, send_ready : std_ulogic;
  signal send_data              : std_ulogic_vector(7 downto 0);

begin

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity)
    port map (
      clock => clock, reset => reset, line => rx_line, line_break => line_break,
      rx_valid => line_valid, rx_ready => line_ready,
      rx_data => line_item(7 downto 0), rx_error => line_item(item_t'high downto 8));

  receive_buffer : entity work.fifo
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

  transmit_buffer : entity work.fifo
    generic map (width => 8, depth => tx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => tx_valid, write_ready => tx_ready, write_data => tx_data,
      read_valid => send_valid, read_ready => send_ready, read_data => send_data);

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity, stop_bits => stop_bits)
    port map (
      clock => clock, reset => reset, tx_valid => send_valid, tx_ready => send_ready, tx_data => send_data,
      line => tx_line);

end architecture;
