-- SPDX-License-Identifier: BSD-3-Clause
--
-- The classic side of a core: text in and out, requests and publishes on the bus-independent interface
-- (docs/classic-protocol.md).
--
--   rx --> datalink --> request_buffer --> application <--> bii, subscription
--   tx <--    "     <-- fifo <-----------------+
--
-- Ports     may_begin: low while another application has the bus. busy: this one is in a message. locked: a session of
--           the framed protocol is open, so nothing may be changed. All other ports: see core_bii.
-- Errors    While locked, a write ends like one that the bus refuses, and changes nothing. A request that would change
--           groups or publishing is an unknown command.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bii_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity classic is
  generic (
    settings : settings_t := core_settings  -- docs/settings.md
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    rx_valid     : in  std_ulogic;
    rx_ready     : out std_ulogic;
    rx_data      : in  byte_t;
    rx_error     : in  std_ulogic_vector(2 downto 0) := "000";
    tx_valid     : out std_ulogic;
    tx_ready     : in  std_ulogic;
    tx_data      : out byte_t;
    tx_last      : out std_ulogic;
    tx_publish   : out std_ulogic;
    locked      : in  std_ulogic := '0';
    may_begin    : in  std_ulogic := '1';
    busy         : out std_ulogic;
    subscription_request  : out subscription_request_t;
    subscription_response : in  subscription_response_t := subscription_response_idle;
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of classic is

  constant words : positive := 16;  -- between application and transmitter, so that both work at the same time

  constant address_bytes  : positive := bytes_for(settings.address_bits);
  constant data_bytes     : positive := bytes_for(settings.data_bits);
  constant has_read_many  : boolean  := settings.read_many > 0;
  constant has_publishing : boolean  := settings.publish_mode > 0;
  constant whole_requests : boolean  := settings.datalink = datalink_full;

  constant mask_bytes : positive := maximum(limits_event_mask_bytes_min_c, (settings.groups + 7) / 8);

  constant entries : positive := entries_for(
    address_bytes, data_bytes, settings.read_many, settings.publish_mode, settings.group_size, settings.rate_bytes,
    mask_bytes);

  signal receive                          : receive_t;
  signal room                             : std_ulogic;
  signal message_end                      : std_ulogic;

  signal request_came, request : request_t;  -- as received, and as passed on
  signal request_take       : std_ulogic;
  signal request_rewind     : std_ulogic;
  signal request_done       : std_ulogic;

  signal groups_response : subscription_response_t;
  signal bus_request     : bii_request_t;
  signal bus_response    : bii_response_t;
  signal refused         : std_ulogic;  -- a write is refused

  signal said_valid, said_ready   : std_ulogic;
  signal said_data                : word_t;
  signal word_valid, word_ready   : std_ulogic;
  signal word_data                : word_t;

  -- Whether a command changes groups or publishing.
  function changes(command : command_t) return boolean is
  begin
    return command = std_ulogic_vector(to_unsigned(command_write_group_addresses, 5)) or
           command = std_ulogic_vector(to_unsigned(command_write_group_rate, 5)) or
           command = std_ulogic_vector(to_unsigned(command_enable_publishing, 5)) or
           command = std_ulogic_vector(to_unsigned(command_enable_checked_publishing, 5)) or
           command = std_ulogic_vector(to_unsigned(command_disable_publishing, 5)) or
           command = std_ulogic_vector(to_unsigned(command_write_event_mask, 5));
  end function;

begin

  datalink_layer : entity work.datalink
    generic map (
      datalink => text_of(settings.datalink), message_entries => entries, checksum => text_of(settings.checksum),
      polynomial => settings.polynomial)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      receive => receive, room => room, message_end => message_end,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  requests : if whole_requests generate
    request_buffer : entity work.request_buffer
      generic map (
        message_entries => entries, has_read_many => has_read_many, has_publishing => has_publishing,
        has_checksum => settings.checksum /= checksum_none, configuration_command => settings.configuration_command)
      port map (
        clock => clock, reset => reset, receive => receive, room => room,
        request => request_came, take => request_take, rewind => request_rewind, request_done => request_done);
    message_end <= '0';
  else generate
    request_stream : entity work.request_stream
      generic map (
        address_bytes => address_bytes, data_bytes => data_bytes, rate_bytes => settings.rate_bytes,
        mask_bytes => mask_bytes, has_read_many => has_read_many, has_publishing => has_publishing,
        configuration_command => settings.configuration_command)
      port map (
        clock => clock, reset => reset, receive => receive, room => room, message_end => message_end,
        request => request_came, take => request_take, request_done => request_done);
  end generate;

  guard : process (all)
  begin
    request       <= request_came;
    request.valid <= request_came.valid and may_begin;
    if locked = '1' and changes(request_came.command) then
      request.command <= std_ulogic_vector(to_unsigned(command_unknown, 5));
    end if;

    groups_response         <= subscription_response;
    groups_response.publish <= subscription_response.publish and may_begin and not locked;

    bii_request       <= bus_request;
    bii_request.valid <= bus_request.valid and not refused;
    bus_response      <= bii_response;
    if refused = '1' then
      bus_response.done   <= '1';
      bus_response.status <= error;
    end if;
  end process;

  refused <= locked and bus_request.valid and bus_request.write;

  application : entity work.application
    generic map (
      address_width => settings.address_bits, data_width => settings.data_bits, base_hz => settings.base_hz,
      groups => settings.groups, group_size => settings.group_size, most_words => settings.read_many,
      rate_bytes => settings.rate_bytes, publish_mode => settings.publish_mode, whole_requests => whole_requests)
    port map (
      clock => clock, reset => reset,
      request => request, take => request_take, rewind => request_rewind, request_done => request_done,
      busy => busy, subscription_request => subscription_request, subscription_response => groups_response,
      bii_request => bus_request, bii_response => bus_response,
      word_valid => said_valid, word_ready => said_ready, word_data => said_data);

  between : if whole_requests generate
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
