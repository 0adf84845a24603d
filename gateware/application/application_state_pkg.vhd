-- SPDX-License-Identifier: BSD-3-Clause
--
-- The states of the application's machine and what it knows; heads and CNF fields.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bii_pkg.all;
use work.protocol_pkg.all;

package application_state_pkg is

  type state_t is (
    idle,              -- between messages; sends the head of the next one
    error_code,        -- the code of a datalink error is handed to the writer
    gather,            -- takes `gather_left` bytes of the request into `argument`
    say,               -- sends `text`; then the writer goes on with `word`
    tail,              -- ends the reply
    open_read,         -- the address of a single read is complete
    write_address,     -- the address of a write is complete
    open_write,        -- its data too
    check_block,       -- the count of a read-many is complete
    open_block,        -- an address of a read-many is complete
    open_publish,      -- an address of a publish stands
    access_bus,        -- an access is open; leaves when it is done
    block_word,        -- a word of a block waits for the writer
    list_field,        -- CNF: field number `index` is handed to the writer
    check_group,       -- the group number is complete
    check_size,        -- the count of WSA is complete
    store_address,     -- an address of WSA is complete
    write_rate,        -- of a group; leaves when the subscription manager has done it
    list_rate,         -- RSI: waits until the rate has been looked up
    list_count,        -- RSI: the count is handed to the writer
    list_settle,       -- RSI: the next address is looked up
    list_address,      -- RSI: an address is handed to the writer
    store_mask,        -- a byte of the event mask is complete
    list_mask,         -- RIC: byte number `index` is handed to the writer
    publish_head       -- group and count of a publish are handed to the writer
  );

  -- What the machine knows.
  type record_t is record
    state       : state_t;
    following   : state_t;                        -- gather, say: what comes then
    serving     : std_ulogic;                     -- the message in hand is a request
    checked_publish : std_ulogic;
    turns       : natural range 0 to 15;          -- the preferred side has had in a row while the other waited
    argument    : std_ulogic_vector(31 downto 0); -- bytes of the request, the newest lowest
    gather_left : natural range 0 to 4;
    remaining   : unsigned(10 downto 0);          -- bytes of the request not yet taken
    text        : text_t;
    say_bytes   : natural range 0 to 4;           -- of `word` that follow the text
    word        : std_ulogic_vector(31 downto 0); -- the writer's, highest byte first
    word_left   : natural range 0 to 4;           -- bytes of it not yet sent
    group_number : unsigned(7 downto 0);
    index       : unsigned(7 downto 0);
    count       : unsigned(7 downto 0);           -- words or addresses still to come
    bus_out     : bii_request_t;
  end record;

  constant record_initial : record_t := (
    state => idle, following => idle, serving => '0', checked_publish => '0', turns => 0, argument => (others => '0'),
    gather_left => 0, remaining => (others => '0'), text => text_read, say_bytes => 0, word => (others => '0'),
    word_left => 0, group_number => (others => '0'), index => (others => '0'), count => (others => '0'),
    bus_out => bii_request_idle);

  -- The low `bytes` bytes of a value, where the writer wants them.
  function high(value : std_ulogic_vector(31 downto 0); bytes : positive) return std_ulogic_vector;
  function high(value : natural; bytes : positive) return std_ulogic_vector;

  type fields_t is array (0 to 7) of std_ulogic_vector(31 downto 0);  -- of CNF, as the writer wants them

  -- The head of the reply to a request, and of a publish.
  function head_of(request : request_t) return byte_t;
  function head_of(checked_publish : std_ulogic) return byte_t;

  -- What is said of an access that failed.
  function bus_error_text(status : bii_status_t; write : std_ulogic) return text_t;

  -- What is said of a request that ends while bytes are gathered for the state `following`.
  function missing_text(following : state_t) return text_t;

  -- Bytes a frequency needs: 255 -> 1, 256 -> 2.
  function frequency_bytes(frequency_hz : positive) return positive;

end package;

package body application_state_pkg is

  function high(value : std_ulogic_vector(31 downto 0); bytes : positive) return std_ulogic_vector is
  begin
    return std_ulogic_vector(shift_left(unsigned(value), 32 - 8 * bytes));
  end function;

  function high(value : natural; bytes : positive) return std_ulogic_vector is
  begin
    return high(std_ulogic_vector(to_unsigned(value, 32)), bytes);
  end function;

  function head_of(request : request_t) return byte_t is
  begin
    if request.error = '1' then
      return byte_error_mark_c;
    elsif request.checked = '1' then
      return byte_checked_head_c;
    end if;
    return byte_plain_head_c;
  end function;

  function head_of(checked_publish : std_ulogic) return byte_t is
  begin
    if checked_publish = '1' then
      return byte_checked_publish_c;
    end if;
    return byte_plain_publish_c;
  end function;

  function bus_error_text(status : bii_status_t; write : std_ulogic) return text_t is
  begin
    if status = silent then
      return text_bus_timeout;
    elsif write = '1' then
      return text_bus_error_write;
    end if;
    return text_bus_error_read;
  end function;

  function missing_text(following : state_t) return text_t is
  begin
    case following is
      when open_read | write_address | open_block | store_address =>
        return text_missing_address;
      when others =>
        return text_missing_data;
    end case;
  end function;

  function frequency_bytes(frequency_hz : positive) return positive is
    variable bytes : positive := 1;
    variable rest  : natural  := frequency_hz / 256;
  begin
    while rest > 0 loop
      bytes := bytes + 1;
      rest  := rest / 256;
    end loop;
    return bytes;
  end function;

end package body;
