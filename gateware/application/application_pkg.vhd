-- SPDX-License-Identifier: BSD-3-Clause
--
-- What the application layer says and understands: commands, requests, texts of replies, tokens on their way out.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package application_pkg is

  type command_t is (
    unknown, read, write, read_many, read_configuration,
    write_group_addresses, write_group_rate, read_group,
    enable_publishing, enable_checked_publishing, disable_publishing,
    write_event_mask, read_event_mask);

  -- A complete request, or in its place the datalink error that its sender is to be told.
  type request_t is record
    valid   : std_ulogic;
    error   : std_ulogic;            -- nothing but `code` counts
    code    : byte_t;                -- with error
    checked : std_ulogic;            -- the reply carries a checksum too
    command : command_t;
    length  : unsigned(10 downto 0); -- data bytes behind the colon
  end record;

  constant request_none : request_t := (
    valid => '0', error => '0', code => x"00", checked => '0', command => unknown, length => (others => '0'));

  -- Texts of replies, with the colon where data follow.
  type text_t is (
    text_read, text_write, text_read_many, text_configuration, text_comma,
    text_write_group_addresses, text_write_group_rate, text_read_group,
    text_enable_publishing, text_enable_checked_publishing, text_disable_publishing,
    text_write_event_mask, text_read_event_mask, text_publish,
    text_incomplete_command, text_missing_address, text_missing_data, text_invalid_block_size,
    text_invalid_group_size, text_invalid_group, text_bus_error_read, text_bus_error_write, text_bus_timeout);

  function spelling(text : text_t) return string;

  -- A token of a reply: two bits of kind, one byte.
  subtype token_t is std_ulogic_vector(9 downto 0);

  constant token_head : std_ulogic_vector(1 downto 0) := "00";  -- the byte is the head character
  constant token_text : std_ulogic_vector(1 downto 0) := "01";  -- the byte is the position of a text_t
  constant token_byte : std_ulogic_vector(1 downto 0) := "10";  -- the byte is one of the reply's data
  constant token_tail : std_ulogic_vector(1 downto 0) := "11";  -- the end of the reply

  function token(text : text_t) return token_t;

  -- Entries a received message may have, as in the 2012 gateware: what the longest command needs, rounded up.
  function entries_for(address_bytes, data_bytes, read_most, publish_mode, group_size, rate_bytes, mask_bytes : natural)
    return positive;

end package;

package body application_pkg is

  function spelling(text : text_t) return string is
  begin
    case text is
      when text_read                      => return reply_read_c & ":";
      when text_write                     => return reply_write_c;
      when text_read_many                 => return reply_read_many_c & ":";
      when text_configuration             => return reply_read_configuration_c & ":";
      when text_comma                     => return ",";
      when text_write_group_addresses     => return reply_write_group_addresses_c;
      when text_write_group_rate          => return reply_write_group_rate_c;
      when text_read_group                => return reply_read_group_c & ":";
      when text_enable_publishing         => return reply_enable_publishing_c;
      when text_enable_checked_publishing => return reply_enable_checked_publishing_c;
      when text_disable_publishing        => return reply_disable_publishing_c;
      when text_write_event_mask          => return reply_write_event_mask_c;
      when text_read_event_mask           => return reply_read_event_mask_c & ":";
      when text_publish                   => return reply_publish_c & ":";
      when text_incomplete_command        => return "?" & application_error_incomplete_command_c;
      when text_missing_address           => return "?" & application_error_missing_address_c;
      when text_missing_data              => return "?" & application_error_missing_data_c;
      when text_invalid_block_size        => return "?" & application_error_invalid_block_size_c;
      when text_invalid_group_size        => return "?" & application_error_invalid_group_size_c;
      when text_invalid_group             => return "?" & application_error_invalid_group_c;
      when text_bus_error_read            => return "?" & application_error_bus_error_read_c;
      when text_bus_error_write           => return "?" & application_error_bus_error_write_c;
      when text_bus_timeout               => return "?" & application_error_bus_timeout_c;
    end case;
  end function;

  function token(text : text_t) return token_t is
  begin
    return token_text & std_ulogic_vector(to_unsigned(text_t'pos(text), 8));
  end function;

  function entries_for(address_bytes, data_bytes, read_most, publish_mode, group_size, rate_bytes, mask_bytes : natural)
    return positive is
    variable longest : positive := 7 + address_bytes + data_bytes;
    variable rounded : positive := 1;

    procedure fit(entries : positive) is
    begin
      if entries > longest then
        longest := entries;
      end if;
    end procedure;
  begin
    if read_most > 0 then
      fit(9 + address_bytes * read_most);
    end if;
    if publish_mode > 0 then
      fit(10 + address_bytes * group_size);
      fit(8 + rate_bytes);
      fit(7 + mask_bytes);
    end if;
    while rounded < longest loop
      rounded := 2 * rounded;
    end loop;
    return rounded + 1;
  end function;

end package body;
