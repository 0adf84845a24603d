-- SPDX-License-Identifier: BSD-3-Clause
--
-- A program in fewer places: equal instructions share one.
--
-- Every instruction names the one that follows it. So two instructions with the same bits do the same, from there on
-- and for ever. One place is enough for both: what led to the other one leads to it. Then more instructions are equal,
-- so the search goes on until there are no such two. What is executed, and in which clock, stays the same.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.instruction_pkg.all;

package program_sharing_pkg is

  type positions_t is array (natural range <>) of boolean;

  -- The program in as few places as this gives. The instructions at the `fixed` places stay there.
  function with_shared_places(program : program_t; fixed : positions_t) return program_t;

end package;

package body program_sharing_pkg is

  constant nowhere : natural := 512;

  type places_t is array (natural range <>) of natural range 0 to nowhere;

  function place_of(field : std_ulogic_vector) return natural is
  begin
    return to_integer(unsigned(field));
  end function;

  -- The instruction, with each place that it names in its new place.
  function moved(i : instruction_t; places : places_t) return instruction_t is
    variable other : instruction_t := i;
  begin
    if i(do_begin) = '0' then  -- otherwise it is the beginning of the table of commands
      other(following_f) := std_ulogic_vector(to_unsigned(places(place_of(i(following_f))), 9));
    end if;
    if or i(condition_f) then
      other(target_f) := std_ulogic_vector(to_unsigned(places(place_of(i(target_f))), 9));
    end if;
    return other;
  end function;

  function with_shared_places(program : program_t; fixed : positions_t) return program_t is
    variable code   : program_t(0 to program'length - 1) := program;
    variable gone   : positions_t(code'range)            := (others => false);
    variable places : places_t(0 to nowhere);  -- where the instruction of each place is now
    variable first  : places_t(code'range);    -- of the instructions with the same `following`
    variable later  : places_t(code'range);    -- the next one of these
    variable found  : boolean;
    variable here   : natural := 0;

    -- Looks for an instruction with the same bits among those that were looked at before.
    procedure look(place : natural) is
      constant following : natural := place_of(code(place)(following_f));
      variable other     : natural := first(following);
    begin
      while other /= nowhere loop
        if code(other) = code(place) then
          places(place) := other;
          if not fixed(place) then
            gone(place) := true;
            found       := true;
          end if;
          return;
        end if;
        other := later(other);
      end loop;
      later(place)     := first(following);
      first(following) := place;
    end procedure;

    procedure start is
    begin
      for place in places'range loop
        places(place) := place;
      end loop;
      first := (others => nowhere);
      found := false;
    end procedure;

    procedure move is
    begin
      for place in code'range loop
        code(place) := moved(code(place), places);
      end loop;
    end procedure;
  begin
    loop
      start;
      for place in code'range loop
        if fixed(place) then
          look(place);
        end if;
      end loop;
      for place in code'range loop
        if not fixed(place) and not gone(place) then
          look(place);
        end if;
      end loop;
      exit when not found;
      move;
    end loop;

    -- Those that are left close up.
    start;
    for place in code'range loop
      if not fixed(place) and not gone(place) then
        while fixed(here) loop
          here := here + 1;
        end loop;
        places(place) := here;
        here          := here + 1;
      end if;
    end loop;
    move;
    for place in code'range loop
      if not fixed(place) and not gone(place) then
        code(places(place)) := code(place);  -- which is the same place or an earlier one
      end if;
      if fixed(place) then
        here := maximum(here, place + 1);
      end if;
    end loop;
    return code(0 to here - 1);
  end function;

end package body;
