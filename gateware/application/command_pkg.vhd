-- SPDX-License-Identifier: BSD-3-Clause
--
-- Recognises the command from the letters of a message, with a state machine that fits a block RAM.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

package command_pkg is

  -- From the state and a letter (its low five bits) to the next state. The last state is the command. A command with
  -- arguments ends with its colon and has no further letters. One without arguments ends with its last letter.
  type recogniser_t is array (0 to 1023) of command_t;

  constant letter_begin : std_ulogic_vector(4 downto 0) := "00000";  -- from every state to the first of a message
  constant letter_colon : std_ulogic_vector(4 downto 0) := "11011";

  function recogniser(has_read_many, has_publishing, has_checksum, has_configuration : boolean) return recogniser_t;

  -- The address of the next state in the recogniser.
  function step_of(state : command_t; receive : receive_t) return natural;

end package;

package body command_pkg is

  function recogniser(has_read_many, has_publishing, has_checksum, has_configuration : boolean) return recogniser_t is
    variable machine : recogniser_t := (others => std_ulogic_vector(to_unsigned(command_unknown, 5)));
    variable states  : natural := command_spelling;

    procedure learn(word : string; command : natural; arguments : boolean) is
      variable state : natural := command_spelling;
      variable code  : natural;
    begin
      for place in word'range loop
        code := character'pos(word(place)) mod 32;
        if place = word'right and not arguments then
          machine(32 * state + code) := std_ulogic_vector(to_unsigned(command, 5));
        elsif unsigned(machine(32 * state + code)) = command_unknown then
          states := states + 1;
          machine(32 * state + code) := std_ulogic_vector(to_unsigned(states, 5));
        end if;
        state := to_integer(unsigned(machine(32 * state + code)));
      end loop;
      if arguments then
        machine(32 * state + to_integer(unsigned(letter_colon))) := std_ulogic_vector(to_unsigned(command, 5));
      else
        for letter in 1 to 31 loop
          machine(32 * state + letter) := std_ulogic_vector(to_unsigned(command, 5));
        end loop;
      end if;
    end procedure;
  begin
    learn(command_read_c, command_read, true);
    learn(command_write_c, command_write, true);
    if has_read_many then
      learn(command_read_many_c, command_read_many, true);
    end if;
    if has_configuration then
      learn(command_read_configuration_c, command_read_configuration, false);
    end if;
    if has_publishing then
      learn(command_write_group_addresses_c, command_write_group_addresses, true);
      learn(command_write_group_rate_c, command_write_group_rate, true);
      learn(command_read_group_c, command_read_group, true);
      learn(command_enable_publishing_c, command_enable_publishing, false);
      if has_checksum then
        learn(command_enable_checked_publishing_c, command_enable_checked_publishing, false);
      end if;
      learn(command_disable_publishing_c, command_disable_publishing, false);
      learn(command_write_event_mask_c, command_write_event_mask, true);
      learn(command_read_event_mask_c, command_read_event_mask, false);
    end if;
    for state in 0 to 31 loop
      machine(32 * state) := std_ulogic_vector(to_unsigned(command_spelling, 5));
    end loop;
    return machine;
  end function;

  function step_of(state : command_t; receive : receive_t) return natural is
    variable letter_code : std_ulogic_vector(4 downto 0) := receive.data(4 downto 0);
  begin
    if receive.event = start then
      letter_code := letter_begin;
    elsif receive.event = colon then
      letter_code := letter_colon;
    end if;
    return to_integer(unsigned(std_ulogic_vector'(state & letter_code)));
  end function;

end package body;
