-- SPDX-License-Identifier: BSD-3-Clause
--
-- The Unity-Link core without a bus: classic protocol on byte streams, requests and publishes on the bus-independent
-- interface. `core` puts a Wishbone master behind it, `core_axi_lite` an AXI4-Lite one; yours may be another.
--
--   rx --> datalink --> request_buffer --> application <--> bii
--   tx <--    "     <-- fifo <-----------------+   ^
--                                subscription_manager <-- events
--
-- Ports     rx, tx: byte streams, valid/ready/data. tx_last: with the last byte of a message, tx_publish: with all bytes of a
--           publish. rx_error: one-clock pulses of the physical layer (bit 0 parity, 1 framing, 2 overrun).
--           events: one line a group, synchronous to the clock. bii: see bii_pkg; word addresses.
-- Latency   From the last byte of a request to the first of its reply: 6 clocks. Then a byte a clock, as far as the bus and
--           the reply go: the figures are in docs/gateware/core.md and asserted in tests/gateware/test_cycles.py.
-- Errors    docs/classic-protocol.md section 4. An error takes nothing but its own message along.
-- Pressure  tx_ready stalls replies, then execution, then rx_ready. Two requests are kept, in execution and behind it.
-- Checksum  "none" also takes checked requests and EPC away.
-- Datalink  "lite" and "none" keep nothing: a request is executed while it comes in (docs/gateware/datalink.md).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bii_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity core_bii is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    clock_hz      : positive                := limits_clock_hz_default_c;
    base_hz       : positive                := limits_base_hz_default_c;  -- of publishing
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;   -- addresses a group can have
    rate_bytes    : positive range 1 to 4   := 2;
    read_many     : natural  range 0 to 255 := 32;   -- most words of a read-many; 0: no such command
    publish_mode  : natural  range 0 to 2   := 2;    -- 0 none, 1 prefers requests, 2 prefers publishes
    configuration_command : boolean         := true; -- RLC exists
    datalink      : string                  := "full";  -- "full", "lite" or "none"
    checksum      : string                  := "crc8";  -- "crc8", "xor" or "none"; of the full datalink
    polynomial    : natural range 0 to 255  := to_integer(unsigned(crc8_polynomial_c));
    edge_events   : std_ulogic_vector(255 downto 0) := (others => '0')  -- bit g: event of group g by edge, else level
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    rx_valid     : in  std_ulogic;
    rx_ready     : out std_ulogic;
    rx_data      : in  std_ulogic_vector(7 downto 0);
    rx_error     : in  std_ulogic_vector(2 downto 0) := "000";
    tx_valid     : out std_ulogic;
    tx_ready     : in  std_ulogic;
    tx_data      : out std_ulogic_vector(7 downto 0);
    tx_last      : out std_ulogic;
    tx_publish   : out std_ulogic;
    events       : in  std_ulogic_vector(groups - 1 downto 0) := (others => '0');
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of core_bii is

  constant words : positive := 16;  -- between application and transmitter, so that they work at the same time

  constant mask_bytes : positive := maximum(limits_event_mask_bytes_min_c, (groups + 7) / 8);

  constant entries : positive := entries_for(
    bytes_for(address_width), bytes_for(data_width), read_many, publish_mode, group_size, rate_bytes, mask_bytes);

  signal receive                          : receive_t;
  signal room                             : std_ulogic;
  signal message_end                      : std_ulogic;

  signal request            : request_t;
  signal request_take       : std_ulogic;
  signal request_rewind     : std_ulogic;
  signal request_done       : std_ulogic;

  signal subscription_request  : subscription_request_t;
  signal subscription_response : subscription_response_t;

  signal said_valid, said_ready   : std_ulogic;
  signal said_data                : word_t;
  signal word_valid, word_ready   : std_ulogic;
  signal word_data                : word_t;

begin

  datalink_layer : entity work.datalink
    generic map (datalink => datalink, message_entries => entries, checksum => checksum, polynomial => polynomial)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      receive => receive, room => room, message_end => message_end,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  requests : if datalink = "full" generate
    request_buffer : entity work.request_buffer
      generic map (
        message_entries => entries, has_read_many => read_many > 0, has_publishing => publish_mode > 0,
        has_checksum => checksum /= "none", configuration_command => configuration_command)
      port map (
        clock => clock, reset => reset, receive => receive, room => room,
        request => request, take => request_take, rewind => request_rewind, request_done => request_done);
    message_end <= '0';
  else generate
    request_stream : entity work.request_stream
      generic map (
        address_bytes => bytes_for(address_width), data_bytes => bytes_for(data_width), rate_bytes => rate_bytes,
        mask_bytes => mask_bytes, has_read_many => read_many > 0, has_publishing => publish_mode > 0,
        configuration_command => configuration_command)
      port map (
        clock => clock, reset => reset, receive => receive, room => room, message_end => message_end,
        request => request, take => request_take, request_done => request_done);
  end generate;

  application : entity work.application
    generic map (
      address_width => address_width, data_width => data_width, base_hz => base_hz, groups => groups,
      group_size => group_size, most_words => read_many, rate_bytes => rate_bytes, publish_mode => publish_mode,
      whole_requests => datalink = "full")
    port map (
      clock => clock, reset => reset,
      request => request, take => request_take, rewind => request_rewind, request_done => request_done,
      subscription_request => subscription_request, subscription_response => subscription_response,
      bii_request => bii_request, bii_response => bii_response,
      word_valid => said_valid, word_ready => said_ready, word_data => said_data);

  publishing : if publish_mode > 0 generate
    subscription_manager : entity work.subscription_manager
      generic map (
        address_width => address_width, clock_hz => clock_hz, base_hz => base_hz, groups => groups,
        group_size => group_size, rate_bytes => rate_bytes, edge_events => edge_events)
      port map (
        clock => clock, reset => reset, events => events,
        request => subscription_request, response => subscription_response);
  end generate;

  silence : if publish_mode = 0 generate
    subscription_response <= subscription_response_idle;
  end generate;

  between : if datalink = "full" generate
    word_fifo : entity work.fifo
      generic map (width => word_t'length, depth => words)
      port map (
        clock => clock, reset => reset,
        write_valid => said_valid, write_ready => said_ready, write_data => said_data,
        read_valid => word_valid, read_ready => word_ready, read_data => word_data);
  else generate
    word_valid <= said_valid;
    said_ready <= word_ready;
    word_data  <= said_data;
  end generate;

end architecture;
