-- SPDX-License-Identifier: BSD-3-Clause
--
-- The application's program: what each command does and answers, instruction by instruction.
--
-- Position 0 waits for work, and 1 to 3 answer failed accesses. The first instruction of a command is at 32 + command.
-- All other instructions use the free positions. A routine is written in order, and `go_to` names what follows its last
-- instruction.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.datalink_pkg.all;
use work.instruction_pkg.all;
use work.program_sharing_pkg.all;
use work.protocol_pkg.all;

package program_pkg is

  constant first_of_commands : natural := 32;

  -- The program. Its length is a power of two, at most 512. Where it has more than 256 instructions, equal ones share a
  -- place.
  function program_for(
    address_bytes, data_bytes, most_words, publish_mode, base_hz, groups, group_size, rate_bytes, mask_bytes : natural;
    whole_requests : boolean)
    return program_t;

end package;

package body program_pkg is

  -- Bytes of a frequency. Examples: 255 -> 1, 256 -> 2.
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

  -- The program with as many places as a block RAM has.
  function padded(program : program_t) return program_t is
    variable size : positive            := 128;
    variable code : program_t(0 to 511) := (others => nothing_done);
  begin
    while size < program'length loop
      size := 2 * size;
    end loop;
    code(0 to program'length - 1) := program;
    return code(0 to size - 1);
  end function;

  function program_for(
    address_bytes, data_bytes, most_words, publish_mode, base_hz, groups, group_size, rate_bytes, mask_bytes : natural;
    whole_requests : boolean)
    return program_t is

    constant never        : natural := 0;
    constant fixed        : positions_t(0 to 511) := (
      0 to position_silent | first_of_commands to first_of_commands + 31 => true, others => false);
    constant take_address : instruction_t := act(do_take) or act(do_shift_address);
    constant acts         : instruction_t := take_address or act(do_shift_data) or act(do_count) or
      act(do_load_address) or act(do_load_count) or act(do_load_group) or act(do_read) or act(do_write) or
      act(do_finish);

    variable code : program_t(0 to 511) := (others => nothing_done);
    variable free : natural := 4;                       -- the first free position
    variable here : natural := 0;                       -- position of the next instruction
    variable last : natural := 0;                       -- position of the last instruction

    -- Routines to which other routines lead.
    variable finish, last_word, missing_address, missing_data, invalid_block_size, invalid_group, invalid_group_size,
      branch, next_word, more, list_addresses, list_none, list_size, zero_rate : natural;
    type branches_t is array (0 to 3) of natural;
    variable branches : branches_t;

    procedure put(i : instruction_t; condition : natural := never; target : natural := 0) is
    begin
      if here = free then
        free := free + 1;
        if free = first_of_commands then
          free := first_of_commands + 32;
        end if;
      end if;
      code(here) := i;
      if condition /= never then
        code(here)(condition) := '1';
      end if;
      code(here)(target_f)    := std_ulogic_vector(to_unsigned(target, 9));
      code(here)(following_f) := std_ulogic_vector(to_unsigned(free, 9));
      last := here;
      here := free;
    end procedure;

    procedure go_to(position : natural) is
    begin
      code(last)(following_f) := std_ulogic_vector(to_unsigned(position, 9));
    end procedure;

    procedure begin_command(command : natural) is
    begin
      here := first_of_commands + command;
    end procedure;

    -- Sends the letters of a reply. `first` is done with the first letter.
    procedure spell(text : string; first : instruction_t := nothing_done) is
    begin
      for place in text'range loop
        if place = text'left then
          put(letter(text(place)) or first);
        else
          put(letter(text(place)));
        end if;
      end loop;
    end procedure;

    procedure spell_error(text : string) is
    begin
      spell("?" & text);
      go_to(finish);
    end procedure;

    -- Lets an earlier instruction jump here.
    procedure jump_from(position : natural; condition : natural) is
    begin
      code(position)(condition) := '1';
      code(position)(target_f) := std_ulogic_vector(to_unsigned(here, 9));
    end procedure;

    -- Waits in this instruction while the condition holds.
    procedure wait_while(condition : natural; i : instruction_t := nothing_done) is
    begin
      put(i, condition, here);
    end procedure;

    procedure take_bytes(count : natural; i : instruction_t; last_one : instruction_t := nothing_done;
                         too_few : natural := 0) is
    begin
      for number in 1 to count loop
        if number = count then
          put(i or act(do_take) or last_one, if_missing, too_few);
        else
          put(i or act(do_take), if_missing, too_few);
        end if;
      end loop;
    end procedure;

    procedure say_data(count : natural; i : instruction_t := nothing_done) is
    begin
      for number in 1 to count loop
        put(say(word_byte, from_data) or act(do_shift_data) or i);
      end loop;
    end procedure;

    -- Sends the lowest byte of `address`.
    procedure say_lowest is
    begin
      for number in 2 to address_bytes loop
        put(act(do_shift_address));
      end loop;
      put(say(word_byte, from_address));
    end procedure;

    procedure say_number(value : natural; bytes : natural := 1) is
      variable rest : unsigned(31 downto 0) := to_unsigned(value, 32);
    begin
      rest := shift_left(rest, 32 - 8 * bytes);
      for number in 1 to bytes loop
        put(say(word_byte, from_number, to_integer(rest(31 downto 24))));
        rest := shift_left(rest, 8);
      end loop;
    end procedure;

    -- Sends a word of a block. The access is open, and `count` is the number of words after this one. `again` fetches
    -- the next word.
    procedure block_word(again : natural) is
    begin
      branch := here;
      put(act(do_await) or act(do_hold));
      go_to(last_word);
      jump_from(branch, if_some_left);
      next_word := here;
      say_data(data_bytes, act(do_hold));
      go_to(again);
    end procedure;

    -- Takes the group, which is the first argument of a command.
    procedure take_group is
    begin
      take_bytes(1, take_address, too_few => missing_data);
      put(act(do_load_group), if_bad_group, invalid_group);
    end procedure;

  begin
    -- What all commands share.
    here := 0;
    put(say(word_head, from_number) or act(do_begin));
    go_to(first_of_commands);
    here   := free;
    finish := here;
    put(say(word_tail, from_number) or act(do_finish));
    go_to(0);
    here := position_refused_read;
    spell_error(application_error_bus_error_read_c);
    here := position_refused_write;
    spell_error(application_error_bus_error_write_c);
    here := position_silent;
    spell_error(application_error_bus_timeout_c);
    last_word := here;
    say_data(data_bytes);  -- the bus is free again
    go_to(finish);
    begin_command(command_error);
    put(say(word_head, from_number, character'pos('?')));
    say_lowest;
    go_to(finish);
    here := free;

    missing_address := here;
    spell_error(application_error_missing_address_c);
    missing_data := here;
    spell_error(application_error_missing_data_c);
    begin_command(command_unknown);
    spell_error(application_error_incomplete_command_c);
    for number in command_unknown + 1 to command_error - 1 loop  -- replaced below for the known commands
      code(first_of_commands + number) := code(first_of_commands + command_unknown);
    end loop;

    begin_command(command_read);
    take_bytes(address_bytes, take_address, act(do_read), missing_address);
    put(act(do_await));
    spell(reply_read_c & ":");
    say_data(data_bytes);
    go_to(finish);

    begin_command(command_write);
    take_bytes(address_bytes, take_address, nothing_done, missing_address);
    take_bytes(data_bytes, act(do_shift_data), act(do_write), missing_data);
    put(act(do_await));
    spell(reply_write_c);
    go_to(finish);

    if most_words > 0 then
      invalid_block_size := here;
      spell_error(application_error_invalid_block_size_c);
      more := here;
      take_bytes(address_bytes, take_address or act(do_hold), act(do_read) or act(do_count), missing_address);
      block_word(more);
      -- The first word is read while the letters are sent. The letters are sent even if its address is missing.
      begin_command(command_read_many);
      take_bytes(1, take_address, too_few => missing_data);
      put(act(do_load_count) or act(do_hold), if_bad_read_many, invalid_block_size);
      for place in reply_read_many_c'range loop
        branch := here;
        put(letter(reply_read_many_c(place)) or act(do_hold));
        if place - reply_read_many_c'left < address_bytes then
          code(branch) := code(branch) or take_address;
          code(branch)(if_missing) := '1';
        end if;
        if place - reply_read_many_c'left = address_bytes - 1 then
          code(branch) := code(branch) or act(do_read) or act(do_count);
        end if;
        branches(place - reply_read_many_c'left) := branch;
      end loop;
      put(letter(':') or act(do_await) or act(do_hold), if_some_left, next_word);
      go_to(last_word);
      for number in 0 to address_bytes - 1 loop
        code(branches(number))(target_f) := std_ulogic_vector(to_unsigned(here, 9));
        spell(reply_read_many_c(reply_read_many_c'left + number + 1 to reply_read_many_c'right) & ":");
        go_to(missing_address);
      end loop;
    end if;

    begin_command(command_read_configuration);
    spell(reply_read_configuration_c & ":");
    say_number(address_bytes);
    spell(",");
    say_number(data_bytes);
    spell(",");
    say_number(most_words);
    spell(",");
    say_number(publish_mode);
    spell(",");
    say_number(base_hz, frequency_bytes(base_hz));
    spell(",");
    say_number(groups mod 256);  -- a byte cannot hold 256: it is sent as 00
    spell(",");
    say_number(group_size);
    spell(",");
    say_number(rate_bytes);
    go_to(finish);

    if publish_mode > 0 then
      invalid_group := here;
      spell_error(application_error_invalid_group_c);
      invalid_group_size := here;
      spell_error(application_error_invalid_group_size_c);

      begin_command(command_publish);
      spell(reply_publish_c & ":");  -- `count` is 0 here: the number of words
      put(say(word_byte, from_group) or act(do_load_address));
      put(act(do_load_count));
      say_lowest;
      more := here;
      put(act(do_load_address) or act(do_read) or act(do_count) or act(do_hold));
      block_word(more);

      begin_command(command_write_group_addresses);
      take_group;
      take_bytes(1, take_address, too_few => missing_data);
      put(act(do_load_count), if_bad_size, invalid_group_size);
      if whole_requests then  -- the group is not changed unless all its addresses have come
        more := here;
        take_bytes(address_bytes, nothing_done, act(do_count), missing_address);
        put(nothing_done, if_some_left, more);
        put(act(do_rewind));
        for number in 1 to 3 loop  -- skips the entry before the data and the group, up to the count
          put(take_address);
        end loop;
        put(act(do_load_count));
      else
        put(manage(manage_empty));
      end if;
      put(manage(manage_write_word) or place(0));
      more := here;
      take_bytes(address_bytes, take_address, nothing_done, missing_address);
      put(manage(manage_write_word) or act(do_count));
      put(nothing_done, if_some_left, more);
      spell(reply_write_group_addresses_c, manage(manage_fill));
      go_to(finish);

      begin_command(command_write_group_rate);
      take_group;
      for number in 1 to rate_bytes loop
        take_bytes(1, take_address or act(do_shift_data), nothing_done, missing_data);
        put(manage(manage_write_word) or place(-number - rate_bytes));
      end loop;
      for number in 1 to rate_bytes loop
        put(place(-number - rate_bytes));
        put(act(do_load_address));
        put(manage(manage_write_word) or place(-number));
      end loop;
      wait_while(if_rate_pending, manage(manage_write_rate));
      spell(reply_write_group_rate_c);
      go_to(finish);

      list_addresses := here;
      put(place(0));
      put(act(do_load_address));
      put(act(do_load_count));
      say_lowest;
      more := here;
      put(act(do_load_address) or act(do_count));
      for number in 1 to address_bytes loop
        put(say(word_byte, from_address) or act(do_shift_address));
      end loop;
      put(nothing_done, if_some_left, more);
      go_to(finish);

      list_none := here;
      say_number(0);
      go_to(finish);
      list_size := here;
      put(nothing_done, if_group_empty, list_none);
      go_to(list_addresses);
      zero_rate := here;
      say_number(0, rate_bytes);
      go_to(list_size);

      begin_command(command_read_group);
      take_group;
      spell(reply_read_group_c & ":");
      put(nothing_done, if_group_inactive, zero_rate);
      for number in 1 to rate_bytes loop
        put(place(-number));
        put(act(do_load_address));
        say_lowest;
      end loop;
      go_to(list_size);

      begin_command(command_enable_publishing);
      put(manage(manage_enable) or number(0));
      spell(reply_enable_publishing_c);
      go_to(finish);

      begin_command(command_enable_checked_publishing);
      put(manage(manage_enable) or number(1));
      spell(reply_enable_checked_publishing_c);
      go_to(finish);

      begin_command(command_disable_publishing);
      spell(reply_disable_publishing_c, manage(manage_disable));
      go_to(finish);

      begin_command(command_write_event_mask);
      if whole_requests then  -- nothing changes unless all bytes have come
        take_bytes(mask_bytes, nothing_done, nothing_done, missing_data);
        put(act(do_rewind));
        put(act(do_take));
      end if;
      for number in mask_bytes - 1 downto 0 loop
        take_bytes(1, take_address, nothing_done, missing_data);
        put(manage(manage_write_mask) or place(number));
      end loop;
      spell(reply_write_event_mask_c);
      go_to(finish);

      begin_command(command_read_event_mask);
      spell(reply_read_event_mask_c & ":");
      for number in mask_bytes - 1 downto 0 loop
        put(say(word_byte, from_mask) or place(number));
      end loop;
      go_to(finish);
    end if;

    for place in code'range loop
      assert not ((code(place)(do_begin) or code(place)(do_await)) = '1' and or (code(place) and acts) = '1')
        report "program_for: an instruction that begins or awaits does something else" severity failure;
      assert not (code(place)(do_finish) = '1' and (code(place)(do_take) = '1' or code(place)(do_say) = '0'))
        report "program_for: an instruction that finishes must say, and take nothing" severity failure;
      assert not ((code(place)(do_load_count) or code(place)(do_load_group)) = '1' and
                  (code(place)(do_take) or code(place)(do_say)) = '1')
        report "program_for: an instruction that loads must not wait" severity failure;
    end loop;

    if free > 256 then
      return padded(with_shared_places(code(0 to free - 1), fixed(0 to free - 1)));
    end if;
    return padded(code(0 to free - 1));
  end function;

end package body;
