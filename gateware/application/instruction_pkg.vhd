-- SPDX-License-Identifier: BSD-3-Clause
--
-- An instruction of the application's program: what it does, what it sends, and which instruction follows.
--
-- An instruction does everything in one clock and goes on at `following`, or at `target` if its `condition` holds. No
-- access begins while a byte of the request is missing. An instruction that sends waits for the datalink. One that
-- takes waits for the request, and one that begins waits for work. One that awaits waits for the end of the access. If
-- the access failed, it goes on at one of the positions below.
--
-- Only sending and taking delay the other actions of an instruction. So an instruction that begins or awaits changes no
-- registers, one that finishes only sends, and one that loads `count` or `group_number` neither sends nor takes.
-- program_for checks this. Each action has a bit of its own, so that nothing must be decoded.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

package instruction_pkg is

  subtype instruction_t is std_ulogic_vector(58 downto 0);
  subtype position_t is unsigned(8 downto 0);  -- of an instruction

  type program_t is array (natural range <>) of instruction_t;

  subtype following_f is natural range 8 downto 0;
  subtype target_f    is natural range 17 downto 9;
  subtype number_f    is natural range 25 downto 18;
  subtype kind_f      is natural range 28 downto 26;
  subtype source_f    is natural range 31 downto 29;
  subtype manage_f    is natural range 34 downto 32;
  subtype condition_f is natural range 58 downto 51;

  -- Conditions of a jump, with one bit each.
  constant if_missing        : natural := 51;  -- all data bytes are taken
  constant if_some_left      : natural := 52;  -- `count` is not zero
  constant if_bad_read_many  : natural := 53;  -- the lowest byte of `address` is not a valid number of words
  constant if_bad_size       : natural := 54;  -- the lowest byte of `address` is not a valid size of a group
  constant if_bad_group      : natural := 55;  -- the lowest byte of `address` is not a valid group
  constant if_group_empty    : natural := 56;
  constant if_group_inactive : natural := 57;
  constant if_rate_pending   : natural := 58;  -- write_rate is not done

  -- Where the program goes on after a failed access.
  constant position_refused_read  : natural := 1;
  constant position_refused_write : natural := 2;
  constant position_silent        : natural := 3;

  -- The source of the byte that is sent.
  constant from_number : std_ulogic_vector(2 downto 0) := "000";
  constant from_data    : std_ulogic_vector(2 downto 0) := "001";  -- the highest byte of `data`
  constant from_address : std_ulogic_vector(2 downto 0) := "010";  -- the highest byte of `address`
  constant from_group   : std_ulogic_vector(2 downto 0) := "011";  -- the number of the group
  constant from_mask    : std_ulogic_vector(2 downto 0) := "100";  -- byte number `number` of the event mask

  -- Requests to the subscription manager.
  constant manage_nothing    : std_ulogic_vector(2 downto 0) := "000";
  constant manage_write_word : std_ulogic_vector(2 downto 0) := "001";
  constant manage_fill       : std_ulogic_vector(2 downto 0) := "010";
  constant manage_write_rate : std_ulogic_vector(2 downto 0) := "011";
  constant manage_write_mask : std_ulogic_vector(2 downto 0) := "100";
  constant manage_enable     : std_ulogic_vector(2 downto 0) := "101";  -- publishes with checksum if number is 1
  constant manage_disable    : std_ulogic_vector(2 downto 0) := "110";
  constant manage_empty      : std_ulogic_vector(2 downto 0) := "111";

  -- Actions with one bit each.
  constant do_say           : natural := 35;
  constant do_take          : natural := 36;  -- take a byte of the request
  constant do_rewind        : natural := 37;  -- take the bytes of the request from the start again
  constant do_finish        : natural := 38;  -- the request is done
  constant do_shift_data    : natural := 39;  -- shift `data` up by a byte, and insert the byte of the request
  constant do_shift_address : natural := 40;  -- the same for `address`
  constant do_load_address  : natural := 41;  -- load `address` from the word of the group
  constant do_load_count    : natural := 42;  -- load `count` from the lowest byte of `address`
  constant do_count         : natural := 43;  -- decrement `count`
  constant do_load_group    : natural := 44;  -- load `group_number` from the lowest byte of `address`
  constant do_read          : natural := 45;  -- begin an access
  constant do_write         : natural := 46;  -- begin an access
  constant do_hold          : natural := 47;  -- hold the bus
  constant do_begin         : natural := 48;  -- go on with the message in hand, and set `count` to zero
  constant do_place         : natural := 49;  -- the place of the group's word is `number`; otherwise `count`
  constant do_await         : natural := 50;  -- wait for the end of the access

  constant nothing_done : instruction_t := (others => '0');

  -- The instruction with the bit of this action or condition. Combine instructions with `or`.
  function act(action : natural) return instruction_t;
  function manage(action : std_ulogic_vector(2 downto 0)) return instruction_t;
  function number(value : natural) return instruction_t;
  function say(kind : std_ulogic_vector(2 downto 0); source : std_ulogic_vector(2 downto 0); value : natural := 0)
    return instruction_t;
  function letter(value : character) return instruction_t;  -- a letter, a mark, or an error mark

  -- The place of a word, for instructions that use the subscription manager.
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
