-- SPDX-License-Identifier: BSD-3-Clause
--
-- An instruction of the application's program: where it goes on, what it says, what it does.
--
-- An instruction does all that it says in one clock and goes on at `following`. Where its `condition` holds it goes on at
-- `target` instead. No access begins while a byte of the request is missing. Saying waits for the datalink, taking for the
-- request, beginning for work, awaiting for the end of the access; if that failed, it goes on at one of the positions below.
-- Only saying and taking hold back what else an instruction does. So one that begins or awaits does nothing to registers,
-- one that finishes only says, and one that loads `count` or `group_number` neither says nor takes; program_for checks it.
-- Bits are not encoded further, so that none has to be decoded.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

package instruction_pkg is

  subtype instruction_t is std_ulogic_vector(58 downto 0);
  subtype position_t is unsigned(8 downto 0);  -- of an instruction

  subtype following_f is natural range 8 downto 0;
  subtype target_f    is natural range 17 downto 9;
  subtype number_f    is natural range 25 downto 18;
  subtype kind_f      is natural range 28 downto 26;
  subtype source_f    is natural range 31 downto 29;
  subtype manage_f    is natural range 34 downto 32;
  subtype condition_f is natural range 58 downto 51;

  -- What makes it jump, a bit each.
  constant if_missing        : natural := 51;  -- all data bytes are taken
  constant if_some_left      : natural := 52;  -- `count` is not zero
  constant if_bad_read_many  : natural := 53;  -- the lowest byte of `address` is no number of words
  constant if_bad_size       : natural := 54;  -- it is no size of a group
  constant if_bad_group      : natural := 55;  -- it is no group
  constant if_group_empty    : natural := 56;
  constant if_group_inactive : natural := 57;
  constant if_rate_pending   : natural := 58;  -- write_rate is not done

  -- Where an access that fails leads.
  constant position_refused_read  : natural := 1;
  constant position_refused_write : natural := 2;
  constant position_silent        : natural := 3;

  -- Where the byte that is said comes from.
  constant from_number : std_ulogic_vector(2 downto 0) := "000";
  constant from_data    : std_ulogic_vector(2 downto 0) := "001";  -- its highest byte
  constant from_address : std_ulogic_vector(2 downto 0) := "010";  -- its highest byte
  constant from_group   : std_ulogic_vector(2 downto 0) := "011";  -- the number of the group
  constant from_mask    : std_ulogic_vector(2 downto 0) := "100";  -- byte number `number` of the event mask

  -- What is asked of the subscription manager.
  constant manage_nothing    : std_ulogic_vector(2 downto 0) := "000";
  constant manage_write_word : std_ulogic_vector(2 downto 0) := "001";
  constant manage_fill       : std_ulogic_vector(2 downto 0) := "010";
  constant manage_write_rate : std_ulogic_vector(2 downto 0) := "011";
  constant manage_write_mask : std_ulogic_vector(2 downto 0) := "100";
  constant manage_enable     : std_ulogic_vector(2 downto 0) := "101";  -- publishes with checksum if number is 1
  constant manage_disable    : std_ulogic_vector(2 downto 0) := "110";
  constant manage_empty      : std_ulogic_vector(2 downto 0) := "111";

  -- What is done, a bit each.
  constant do_say           : natural := 35;
  constant do_take          : natural := 36;  -- take a byte of the request
  constant do_rewind        : natural := 37;  -- take its bytes from the start again
  constant do_finish        : natural := 38;  -- the request is done
  constant do_shift_data    : natural := 39;  -- `data` a byte up, the byte of the request into it
  constant do_shift_address : natural := 40;  -- `address` likewise
  constant do_load_address  : natural := 41;  -- `address` from the word of the group
  constant do_load_count    : natural := 42;  -- `count` from the lowest byte of `address`
  constant do_count         : natural := 43;  -- one less
  constant do_load_group    : natural := 44;  -- `group_number` from the lowest byte of `address`
  constant do_read          : natural := 45;  -- begin an access
  constant do_write         : natural := 46;  -- begin an access
  constant do_hold          : natural := 47;  -- hold the bus
  constant do_begin         : natural := 48;  -- go on where the message in hand says, with `count` zero
  constant do_place         : natural := 49;  -- the place of the group's word is `number`, else `count`
  constant do_await         : natural := 50;  -- wait for the end of the access

  constant nothing_done : instruction_t := (others => '0');

  -- The one with this bit, what is done or what makes it jump; join instructions with `or`.
  function act(action : natural) return instruction_t;
  function manage(action : std_ulogic_vector(2 downto 0)) return instruction_t;
  function number(value : natural) return instruction_t;
  function say(kind : std_ulogic_vector(2 downto 0); source : std_ulogic_vector(2 downto 0); value : natural := 0)
    return instruction_t;
  function letter(value : character) return instruction_t;  -- or a mark, or the mark of an error

  -- A word of its own to go with instructions which the manager is asked for.
  function place(value : integer) return instruction_t;

end package;

package body instruction_pkg is

  function act(action : natural) return instruction_t is
    variable i : instruction_t := nothing_done;
  begin
    i(action) := '1';
    return i;
  end function;

  function manage(action : std_ulogic_vector(2 downto 0)) return instruction_t is
    variable i : instruction_t := nothing_done;
  begin
    i(manage_f) := action;
    return i;
  end function;

  function number(value : natural) return instruction_t is
    variable i : instruction_t := nothing_done;
  begin
    i(number_f) := std_ulogic_vector(to_unsigned(value, 8));
    return i;
  end function;

  function say(kind : std_ulogic_vector(2 downto 0); source : std_ulogic_vector(2 downto 0); value : natural := 0)
    return instruction_t is
    variable i : instruction_t := number(value);
  begin
    i(do_say)   := '1';
    i(kind_f)   := kind;
    i(source_f) := source;
    return i;
  end function;

  function letter(value : character) return instruction_t is
    constant code : natural := character'pos(value);
  begin
    if value = ':' or value = ',' then
      return say(word_mark, from_number, code);
    elsif value = '?' then
      return say(word_error, from_number, code);
    end if;
    return say(word_letter, from_number, code);
  end function;

  function place(value : integer) return instruction_t is
  begin
    return number(value mod 256) or act(do_place);
  end function;

end package body;
