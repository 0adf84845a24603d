-- SPDX-License-Identifier: BSD-3-Clause
--
-- UART physical layer. On one side is an asynchronous line, on the other are byte streams with buffers.
--
--   rx_line --> uart_rx --> receive_buffer --+--> rx_valid/ready/data
--                                            +--> rx_error              in its place between the bytes
--   tx_line <-- uart_tx <------------ fifo <----- tx_valid/ready/data
--
-- Errors    Errors go through the receive buffer with the bytes. rx_error pulses for one clock after all bytes before
--           it were taken, and before any byte after it is offered. So the datalink assigns the error to the right
--           message. There is no ready: take it at once. The bits are those of physical_pkg: parity, framing, overrun.
-- Pressure  tx_ready is low while the transmit buffer is full. The line cannot be stalled. Once rx_depth + 2 characters
--           wait, further ones are lost, and an overrun takes their place.
-- Latency   Receive: 7 clocks from the middle of the stop bit to rx_valid. Transmit: 3 clocks from tx_valid to the
--           start bit.
-- Baud rate, break, protection against metastability and spikes: see uart_rx and uart_tx.

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
    line_break : out std_ulogic; -- for one clock, when the line sees it: not in its place between the bytes

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

  signal line_valid, line_ready : std_ulogic;
  signal line_data              : std_ulogic_vector(7 downto 0);
  signal line_error             : receive_error_t;
  signal send_valid, send_ready : std_ulogic;
  signal send_data              : std_ulogic_vector(7 downto 0);

begin

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity)
    port map (
      clock => clock, reset => reset, line => rx_line, line_break => line_break,
      rx_valid => line_valid, rx_ready => line_ready,
      rx_data => line_data, rx_error => line_error);

  received : entity work.receive_buffer
    generic map (rx_depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

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
