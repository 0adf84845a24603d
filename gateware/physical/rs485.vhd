-- SPDX-License-Identifier: BSD-3-Clause
--
-- RS-485 physical layer: one of up to 63 nodes on a pair, with the framed protocol. The PC is the master, and a node
-- sends only when it is polled.
--
--   master   00 | select 3 | frame 00 … | poll 3 |
--   drive    ___________________________________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____
--   node 3                                       | 00 | select 3 | frame 00 … | poll 0 |
--
-- Tokens    Three bytes, the last of which is 00, between frames (docs/protocol.md, section 10). One with up to three
--           flipped bits is not accepted.
-- Turn      It begins `turnaround_bits` after a poll, so that the master can release the pair. It ends at the first end
--           of a message at which no byte waits or `turn_bytes` have been sent. If the core sends nothing for 255 bits
--           within a message, the message is cut off and the turn ends. drive rises one bit before the first start bit
--           and falls one bit after the last stop bit.
-- Echo      While drive is high, nothing is received. So a transceiver that receives its own signal does no harm.
-- Errors    They stand in their place between the bytes, as in uart. Errors outside this node's frames are ignored.
-- Pressure  tx_ready is low while the buffer is full. Messages wait for their turn, so the buffer is best as long as a
--           turn. Up to rx_depth + 2 characters may wait. Further ones are lost, and an overrun takes their place.
-- Latency   Receive: 7 clocks from the middle of the stop bit to rx_valid.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity rs485 is
  generic (
    clock_hz        : positive := 50_000_000;
    baud_hz         : positive := 3_000_000;
    rx_depth        : positive := 64;  -- bytes, a power of two
    tx_depth        : positive := 256; -- bytes, a power of two
    turn_bytes      : positive := 256; -- sent in a turn, without the rest of the last message
    turnaround_bits : positive := 10
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    node    : in  std_ulogic_vector(5 downto 0); -- 1 to 63; a constant, or switches that do not change
    rx_line : in  std_ulogic; -- asynchronous
    tx_line : out std_ulogic;
    drive   : out std_ulogic; -- DE of the transceiver, and RE# if that is a separate wire

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t;

    tx_valid : in  std_ulogic;
    tx_ready : out std_ulogic;
    tx_data  : in  std_ulogic_vector(7 downto 0);
    tx_last  : in  std_ulogic
  );
end entity;

architecture rtl of rs485 is

  signal line_valid, line_ready : std_ulogic;
  signal line_data              : std_ulogic_vector(7 downto 0);
  signal line_error             : receive_error_t;
  signal ours, room             : std_ulogic; -- the character is for the core
  signal said, send             : std_ulogic_vector(8 downto 0); -- the byte, with a bit above it: the last of a message
  signal send_valid, send_ready : std_ulogic;
  signal out_valid, out_ready   : std_ulogic;
  signal out_data               : std_ulogic_vector(7 downto 0);

begin

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, line => rx_line, line_break => open,
      rx_valid => line_valid, rx_ready => line_ready,
      rx_data => line_data, rx_error => line_error);

  on_the_pair : entity work.rs485_node
    generic map (
      bit_clocks => (clock_hz + baud_hz - 1) / baud_hz, turn_bytes => turn_bytes, turnaround_bits => turnaround_bits)
    port map (
      clock => clock, reset => reset, node => node, drive => drive,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => ours, rx_ready => room,
      send_valid => send_valid, send_ready => send_ready, send_data => send(7 downto 0), send_last => send(8),
      out_valid => out_valid, out_ready => out_ready, out_data => out_data);

  received : entity work.receive_buffer
    generic map (rx_depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      line_valid => ours, line_ready => room, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  said <= tx_last & tx_data;

  transmit_buffer : entity work.fifo
    generic map (width => 9, depth => tx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => tx_valid, write_ready => tx_ready, write_data => said,
      read_valid => send_valid, read_ready => send_ready, read_data => send);

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, tx_valid => out_valid, tx_ready => out_ready, tx_data => out_data,
      line => tx_line);

end architecture;
