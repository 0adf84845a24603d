-- SPDX-License-Identifier: BSD-3-Clause
--
-- The tables of the proof of the framed application. The functions go through the program until nothing changes. The
-- proof asserts what they find (frame_places), so a wrong table proves nothing.
--
-- A place in a routine has the facts of now. The place behind the call has what will be so when the routine is over:
-- `effects_of` says what the routine still does.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_facts_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_list_facts_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;

package frame_tables_pkg is

  type facts_table_t is array (natural range <>) of facts_t;  -- for each place

  -- What a routine still does.
  subtype effects_t is std_ulogic_vector(5 downto 0);

  constant will_say    : natural := 0;  -- the kind of an answer
  constant will_send   : natural := 1;  -- something
  constant will_load   : natural := 2;  -- an epoch
  constant will_tell   : natural := 3;  -- loads the status of the access into `data`
  constant will_change : natural := 4;  -- changes `data`
  constant will_put    : natural := 5;  -- bytes of an answer

  constant no_effects : effects_t := (others => '0');

  type effects_table_t is array (natural range <>) of effects_t;

  function facts_of(program : frame_program_t; lists : boolean) return facts_table_t;

  function effects_of(program : frame_program_t; lists : boolean) return effects_table_t;

end package;

package body frame_tables_pkg is

  -- What may be when a routine with these effects is over.
  function past(effects : effects_t; facts : facts_t) return facts_t is
    variable f : facts_t := facts;
  begin
    f(returned_to) := '1';
    f(in_routine)  := '0';
    f(sending)     := f(sending) or effects(will_send);
    f(new_epoch)      := f(new_epoch) or effects(will_load);
    f(begun_bytes) := f(begun_bytes) or (effects(will_put) and f(unsaid));
    f(begun_early) := f(begun_early) or f(begun_bytes);
    if effects(will_say) = '1' then
      f(begun_bytes) := '0';
      f(said)   := '1';
      f(unsaid) := '0';
      f(unanswered) := '0';
      f(untrue) := f(touched) or f(on_bus);
    end if;
    if effects(will_tell) = '1' and (f(succeeding) or f(denying)) = '0' then
      f(untold) := '0';
    elsif effects(will_change) = '1' then
      f(untold) := f(touched) or f(on_bus);
    end if;
    if effects(will_change) = '1' then
      f(list_f) := with_data(f(list_f));
    end if;
    return settled(f);
  end function;

  function effects_of(program : frame_program_t; lists : boolean) return effects_table_t is
    variable table, before : effects_table_t(program'range) := (others => no_effects);
    variable i : frame_instruction_t;
    variable e : effects_t;
  begin
    loop
      before := table;
      for place in program'range loop
        i := program(place);
        e := no_effects;
        if i(do_return) = '0' and i(do_begin) = '0' and i(do_call) = '0' and i(do_dispatch) = '0' then
          e := table(to_integer(unsigned(i(following_f))));
        end if;
        if not is_dead(to_integer(unsigned(i(condition_f))), lists) then
          e := e or table(to_integer(unsigned(i(target_f))));
        end if;
        e(will_say)    := e(will_say) or to_bit(tells_kind(i));
        e(will_send)   := e(will_send) or to_bit(i(say_f) /= say_nothing);
        e(will_load)   := e(will_load) or to_bit(i(special_f) = load_epoch);
        e(will_tell)   := e(will_tell) or to_bit(tells_status(i));
        e(will_change) := e(will_change) or to_bit(changes_data(i));
        e(will_put)    := e(will_put) or to_bit(i(say_f) = say_byte or i(say_f) = say_kept);
        table(place)   := e;
      end loop;
      exit when table = before;
    end loop;
    return table;
  end function;

  function facts_of(program : frame_program_t; lists : boolean) return facts_table_t is
    constant effects : effects_table_t(program'range) := effects_of(program, lists);
    variable table, before : facts_table_t(program'range) := (others => (others => '0'));
    variable i             : frame_instruction_t;
    variable facts, part   : facts_t;
    variable following, target : natural;
  begin
    table(0)             := beginning(work_none);  -- after a reset
    table(0)(repeats)    := '1';
    table(0)(taken_some) := '1';
    for entry in 0 to 31 loop
      if begins_work(entry) then
        table(first_of_entries + place_of(entry)) :=
          table(first_of_entries + place_of(entry)) or beginning(work_of(entry, lists));
      end if;
    end loop;
    loop
      before := table;
      for place in program'range loop
        i         := program(place);
        following := to_integer(unsigned(i(following_f)));
        target    := to_integer(unsigned(i(target_f)));
        if to_integer(unsigned(i(condition_f))) /= never then
          table(target) := table(target) or behind(i, table(place), true, lists);
        end if;
        facts := behind(i, table(place), false, lists);
        if i(do_begin) = '1' or i(do_return) = '1' or (facts(first) = '0' and facts(repeats) = '0') then
          null;
        elsif i(do_call) = '1' then
          table(target) := table(target) or past(effects(following), facts);
          facts(in_routine) := '1';
          table(following)  := table(following) or facts;
        elsif i(do_dispatch) = '1' then
          for operation in 0 to 15 loop
            if has_id(operation) and facts(work_of(operation, lists)) = '1' then
              part := facts;
              part(works_t'high downto works_t'low) := (others => '0');
              part(work_of(operation, lists)) := '1';
              if operation /= request_kind_read_c mod 16 and operation /= request_kind_write_c mod 16 then
                part(unopened) := '0';
              end if;
              table(following + operation) := table(following + operation) or settled(part);
            end if;
          end loop;
        else
          table(following) := table(following) or facts;
        end if;
      end loop;
      exit when table = before;
    end loop;
    return table;
  end function;

end package body;
