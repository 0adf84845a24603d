-- SPDX-License-Identifier: BSD-3-Clause
--
-- What may be at each place of the program of the framed application, for its proof. The function goes through the
-- program until nothing changes. The proof asserts what it finds (frame_places), so a wrong table proves nothing.
--
-- A routine changes none of these facts. So what follows a call knows what the call knew.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_facts_pkg is

  -- Each bit says that something may be so. What may not be so is the fact.
  subtype facts_t is std_ulogic_vector(9 downto 0);

  constant first        : natural := 0;  -- the program comes here without mark_repeated
  constant repeats      : natural := 1;  -- and with it
  constant judged_once  : natural := 2;  -- the cache was asked, and mark_repeated is not set
  constant judged_twice : natural := 3;
  constant judged_more  : natural := 4;
  constant touched      : natural := 5;  -- the bus was opened
  constant noted        : natural := 6;  -- the id was remembered
  constant strange      : natural := 7;  -- the work is not a request with an id
  constant in_routine   : natural := 8;  -- this is in a routine
  constant returned_to  : natural := 9;  -- a routine returns to this place

  type facts_table_t is array (0 to 255) of facts_t;

  function facts_of(program : frame_program_t) return facts_table_t;

  -- Work begins with this entry, in a core without lists, groups and dead-man. It is a request with an id.
  function begins_work(entry : natural) return boolean;
  function has_id(entry : natural) return boolean;

  -- The entry in the program for a frame: most requests have the same one (frame_dispatcher).
  function place_of(entry : natural) return natural;

end package;

package body frame_facts_pkg is

  function has_id(entry : natural) return boolean is
  begin
    return entry > 1 and entry < 15 and entry /= request_kind_post_c mod 16 and
           entry /= request_kind_post_list_c mod 16;
  end function;

  function place_of(entry : natural) return natural is
  begin
    if has_id(entry) and entry /= request_kind_read_c mod 16 and entry /= request_kind_write_c mod 16 then
      return entry_unknown;
    end if;
    return entry;
  end function;

  function begins_work(entry : natural) return boolean is
  begin
    return entry > 1 and entry /= 15 and (entry < entry_trip or entry = entry_half_turn or
           entry = entry_receive_overrun);
  end function;

  -- What may be behind an instruction that goes on, or that jumps.
  function behind(i : frame_instruction_t; facts : facts_t; jumps : boolean) return facts_t is
    variable f : facts_t := facts;
  begin
    f(returned_to) := '0';
    if to_integer(unsigned(i(condition_f))) = if_not_new then
      f(judged_more downto judged_once) := f(judged_twice downto judged_once) & f(first);
    end if;
    if not jumps then
      f(touched) := f(touched) or i(do_read) or i(do_write);
      f(noted)   := f(noted) or i(do_place);
      if i(special_f) = set_marks then
        f(repeats) := f(repeats) or f(first);
        f(first)   := '0';
      end if;
    end if;
    if to_integer(unsigned(i(condition_f))) = if_mark then
      if to_integer(unsigned(i(number_f))) /= mark_repeated then  -- no other mark is ever set
        if jumps then
          f := (others => '0');
        end if;
      elsif jumps then
        f(first)   := '0';
      else
        f(repeats) := '0';
      end if;
    end if;
    if f(first) = '0' then
      f(judged_more downto judged_once) := "000";
    end if;
    if f(first) = '0' and f(repeats) = '0' then
      f := (others => '0');
    end if;
    return f;
  end function;

  function facts_of(program : frame_program_t) return facts_table_t is
    variable table, before : facts_table_t := (others => (others => '0'));
    variable i             : frame_instruction_t;
    variable facts         : facts_t;
    variable following, target : natural;
  begin
    table(0)(first)   := '1';
    table(0)(repeats) := '1';
    table(0)(strange) := '1';
    for entry in 0 to 31 loop
      if begins_work(entry) then
        table(first_of_entries + place_of(entry))(first) := '1';
        if not has_id(entry) then
          table(first_of_entries + place_of(entry))(strange) := '1';
        end if;
      end if;
    end loop;
    loop
      before := table;
      for place in 0 to 255 loop
        i         := program(place);
        following := to_integer(unsigned(i(following_f)));
        target    := to_integer(unsigned(i(target_f)));
        if to_integer(unsigned(i(condition_f))) /= never then
          table(target) := table(target) or behind(i, table(place), true);
        end if;
        facts := behind(i, table(place), false);
        if i(do_begin) = '1' or i(do_return) = '1' or (facts(first) = '0' and facts(repeats) = '0') then
          null;
        elsif i(do_call) = '1' then
          table(target)                 := table(target) or facts;
          table(target)(returned_to)    := '1';
          table(following)              := table(following) or facts;
          table(following)(in_routine)  := '1';
        elsif i(do_dispatch) = '1' then
          for operation in 0 to 15 loop
            if has_id(operation) then
              table(following + operation) := table(following + operation) or facts;
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
