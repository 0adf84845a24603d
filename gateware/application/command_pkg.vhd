-- SPDX-License-Identifier: BSD-3-Clause
--
-- From the letters of a message to its command.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.protocol_pkg.all;

package command_pkg is

  -- The low five bits of a letter: the same for both cases. No command has more than three letters.
  subtype letter_t is std_ulogic_vector(4 downto 0);
  type letters_t is array (1 to 3) of letter_t;

  -- The command that `count` letters are, and `colon`; `unknown` for what is none or, by the flags, not there.
  -- One with arguments needs its colon and no letters more; one without is done with its last letter.
  function command_of(
    letters : letters_t; count : natural; colon : std_ulogic;
    has_read_many, has_publishing, has_checksum, has_configuration : boolean) return command_t;

end package;

package body command_pkg is

  function begins_with(letters : letters_t; count : natural; command : string) return boolean is
    variable same : boolean := count >= command'length;
  begin
    for place in 1 to command'length loop
      if letters(place) /= letter_t(to_unsigned(character'pos(command(place)) mod 32, 5)) then
        same := false;
      end if;
    end loop;
    return same;
  end function;

  function is_command(letters : letters_t; count : natural; colon : std_ulogic; command : string) return boolean is
  begin
    return begins_with(letters, count, command) and count = command'length and colon = '1';
  end function;

  function command_of(
    letters : letters_t; count : natural; colon : std_ulogic;
    has_read_many, has_publishing, has_checksum, has_configuration : boolean) return command_t is
  begin
    if is_command(letters, count, colon, command_read_c) then
      return read;
    elsif is_command(letters, count, colon, command_write_c) then
      return write;
    elsif has_read_many and is_command(letters, count, colon, command_read_many_c) then
      return read_many;
    elsif has_configuration and begins_with(letters, count, command_read_configuration_c) then
      return read_configuration;
    elsif not has_publishing then
      return unknown;
    elsif is_command(letters, count, colon, command_write_group_addresses_c) then
      return write_group_addresses;
    elsif is_command(letters, count, colon, command_write_group_rate_c) then
      return write_group_rate;
    elsif is_command(letters, count, colon, command_read_group_c) then
      return read_group;
    elsif begins_with(letters, count, command_enable_publishing_c) then
      return enable_publishing;
    elsif has_checksum and begins_with(letters, count, command_enable_checked_publishing_c) then
      return enable_checked_publishing;
    elsif begins_with(letters, count, command_disable_publishing_c) then
      return disable_publishing;
    elsif is_command(letters, count, colon, command_write_event_mask_c) then
      return write_event_mask;
    elsif begins_with(letters, count, command_read_event_mask_c) then
      return read_event_mask;
    end if;
    return unknown;
  end function;

end package body;
