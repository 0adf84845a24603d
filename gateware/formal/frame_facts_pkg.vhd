-- SPDX-License-Identifier: BSD-3-Clause
--
-- What may be at each place of the program of the framed application, for its proof. The functions go through the
-- program until nothing changes. The proof asserts what they find (frame_places), so a wrong table proves nothing.
--
-- A place in a routine has the facts of now. The place behind the call has what will be so when the routine is over:
-- `effects_of` says what the routine still does.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;

package frame_facts_pkg is

  -- Each bit says that something may be so. What may not be so is the fact. The first bits are the works of
  -- frame_works_pkg.
  subtype facts_t is std_ulogic_vector(40 downto 0);

  -- The id.
  constant first        : natural := 12;  -- mark_repeated is not set
  constant repeats      : natural := 13;  -- it is set
  constant judged_once  : natural := 14;  -- the cache was asked, and mark_repeated is not set
  constant judged_twice : natural := 15;
  constant judged_more  : natural := 16;
  constant unjudged     : natural := 17;  -- the cache has not called this id new, and mark_repeated is not set
  constant is_new       : natural := 18;  -- it is a request with an id, which is new
  constant is_repeated  : natural := 19;
  constant is_stale     : natural := 20;  -- neither
  constant is_long      : natural := 21;  -- it is a request with an id, and has both bytes of it
  constant taken_some   : natural := 22;  -- the next byte is not the first one

  -- The bus.
  constant untouched    : natural := 23;  -- there was no access
  constant on_bus       : natural := 24;  -- there is one, or its end was not seen yet
  constant touched      : natural := 25;  -- there was one
  constant failing      : natural := 26;  -- there was an access, and the bus refused it or did not answer
  constant denying      : natural := 39;  -- there was a write, and the dead-man denied it
  constant succeeding   : natural := 27;  -- there was an access, and it went well
  constant unopened     : natural := 28;  -- it is a READ or WRITE without an access
  constant untold       : natural := 29;  -- a request with an id had an access, and `data` is not its status

  -- The answer.
  constant unsaid       : natural := 30;  -- there is none
  constant unanswered   : natural := 38;  -- there is none, and it is a request with an id
  constant said         : natural := 31;  -- it has begun
  constant ended        : natural := 32;  -- it has ended
  constant untrue       : natural := 33;  -- there was an access, and the status of the answer is another one
  constant sending      : natural := 34;  -- the transmitter is not idle
  constant has_command  : natural := 40;  -- the dead-man was started, stopped or armed
  constant new_epoch       : natural := 35;  -- the epoch was loaded

  constant in_routine   : natural := 36;
  constant returned_to  : natural := 37;  -- a routine returns to this place

  type facts_table_t is array (natural range <>) of facts_t;  -- for each place

  -- What a routine still does.
  subtype effects_t is std_ulogic_vector(4 downto 0);

  constant will_say    : natural := 0;  -- the kind of an answer
  constant will_send   : natural := 1;  -- something
  constant will_load   : natural := 2;  -- an epoch
  constant will_tell   : natural := 3;  -- loads the status of the access into `data`
  constant will_change : natural := 4;  -- changes `data`

  constant no_effects : effects_t := (others => '0');

  type effects_table_t is array (natural range <>) of effects_t;

  function facts_of(program : frame_program_t) return facts_table_t;

  function effects_of(program : frame_program_t) return effects_table_t;

  -- The condition never holds, because the core lacks what it is about.
  function is_dead(condition : natural) return boolean;

end package;

package body frame_facts_pkg is

  constant verdicts : facts_t := (is_new | is_repeated | is_stale => '1', others => '0');

  function is_dead(condition : natural) return boolean is
  begin
    return condition = never or condition = if_top or condition = if_left_other or
           condition = if_shape;
  end function;

  function tells_kind(i : frame_instruction_t) return boolean is
  begin
    return i(say_f) = say_kind or i(say_f) = say_last;
  end function;

  -- It loads the status of an access that failed.
  function tells_status(i : frame_instruction_t) return boolean is
  begin
    return i(data_f) = data_word and i(special_f) = by_silence and i(do_pointer) = '0' and
           to_integer(unsigned(i(number_f))) = word_one;
  end function;

  function changes_data(i : frame_instruction_t) return boolean is
  begin
    return i(data_f) /= data_stays or i(take_f) = take_first or i(take_f) = take_data or i(source_f) = from_top or
           i(source_f) = from_word;
  end function;

  -- It starts, stops or arms the dead-man.
  function commands(i : frame_instruction_t) return boolean is
  begin
    return i(special_f) = start_dead_man or
           (i(special_f) = clear_flags and to_integer(unsigned(i(number_f))) mod 2 = flag_tripped);
  end function;

  -- What may be behind an instruction that goes on, or that jumps.
  function behind(i : frame_instruction_t; facts : facts_t; jumps : boolean) return facts_t is
    variable f         : facts_t := facts;
    variable condition : natural;
    variable number    : natural;
    variable acts      : boolean;  -- it does more than wait for an access that failed
  begin
    condition := to_integer(unsigned(i(condition_f)));
    number    := to_integer(unsigned(i(number_f)));
    acts      := not (jumps and condition = if_failed and i(do_await) = '1');
    f(returned_to) := '0';

    case condition is
      when if_not_new =>
        f(judged_more downto judged_once) := f(judged_twice downto judged_once) & f(first);
        if jumps then
          f(is_new) := '0';
        else
          f(is_repeated) := '0';
          f(is_stale)    := '0';
          f(unjudged)    := '0';
        end if;
      when if_duplicate =>
        if jumps = (i(if_not) = '0') then
          f(is_new)   := '0';
          f(is_stale) := '0';
        else
          f(is_repeated) := '0';
        end if;
      when if_denied =>
        if jumps then
          f(failing)    := '0';
          f(succeeding) := '0';
        else
          f(denying) := '0';
        end if;
      when if_busy =>
        if not jumps and i(if_not) = '0' then
          f(sending) := '0';
        end if;
      when if_missing =>
        if jumps and i(take_f) = take_id then
          f(is_long) := '0';
        end if;
      when others =>
        if jumps and is_dead(condition) then
          f := (others => '0');
        end if;
    end case;

    -- The bus.
    if i(do_await) = '1' then
      f(touched) := f(touched) or f(on_bus);
      f(on_bus)  := '0';
      if condition = if_failed then
        if jumps then
          f(succeeding) := '0';
        else
          f(failing) := '0';
          f(denying) := '0';
        end if;
      end if;
    end if;
    if not jumps and (i(do_read) or i(do_write)) = '1' then
      f(untouched)  := '0';
      f(unopened)   := '0';
      f(on_bus)     := '1';
      f(failing)    := '1';
      f(succeeding) := '1';
      f(denying)    := i(do_write);
      f(untold)     := '1';
      f(untrue)     := f(said) or f(ended);
    end if;

    -- The answer.
    if acts then
      if i(say_f) /= say_nothing then
        f(sending) := '1';
      end if;
      if tells_kind(i) then
        if i(source_f) = from_other and number / 32 mod 2 = 1 then
          f(untrue) := f(untold);
        elsif i(source_f) = from_number and number mod 16 = reply_status_ok_c then
          f(untrue) := f(failing) or f(denying);
        elsif i(source_f) = from_number and number mod 16 = reply_status_denied_c then
          f(untrue) := f(failing) or f(succeeding);
        else
          f(untrue) := '1';
        end if;
        f(untrue) := f(untrue) and (f(touched) or f(on_bus));
        f(said)   := '1';
        f(unsaid) := '0';
        f(unanswered) := '0';
      end if;
      if i(say_f) = say_end or i(say_f) = say_last then
        f(ended) := f(ended) or f(said);
        f(said)  := '0';
      end if;
      if tells_status(i) and (f(succeeding) or f(denying)) = '0' then
        f(untold) := '0';
      elsif changes_data(i) then
        f(untold) := f(touched) or f(on_bus);
      end if;
    end if;

    -- The request, its id and the epoch.
    if i(do_rewind) = '1' then
      f(taken_some) := '0';
    end if;
    if i(take_f) /= take_nothing then
      f(taken_some) := '1';
    end if;
    if i(take_f) = take_id then
      f(unjudged) := '1';
    end if;
    if commands(i) and not (jumps and condition = if_flag and number = flag_tripped) then
      f(has_command) := '1';
    end if;
    if i(special_f) = load_epoch then
      f(new_epoch) := '1';
    end if;
    if i(special_f) = set_marks then
      f(repeats) := f(repeats) or f(first);
      f(first)   := '0';
    end if;
    if condition = if_mark then
      if number /= mark_repeated then  -- no other mark is ever set
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
      f(unjudged) := '0';
    end if;
    if (f(first) = '0' and f(repeats) = '0') or (or f(works_t'high downto works_t'low)) = '0' or
        (f(untouched) or f(failing) or f(succeeding) or f(denying)) = '0' then
      f := (others => '0');
    end if;
    return f;
  end function;

  -- What may be when a routine with these effects is over.
  function past(effects : effects_t; facts : facts_t) return facts_t is
    variable f : facts_t := facts;
  begin
    f(returned_to) := '1';
    f(in_routine)  := '0';
    f(sending)     := f(sending) or effects(will_send);
    f(new_epoch)      := f(new_epoch) or effects(will_load);
    if effects(will_say) = '1' then
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
    return f;
  end function;

  function effects_of(program : frame_program_t) return effects_table_t is
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
        if not is_dead(to_integer(unsigned(i(condition_f)))) then
          e := e or table(to_integer(unsigned(i(target_f))));
        end if;
        e(will_say)    := e(will_say) or to_bit(tells_kind(i));
        e(will_send)   := e(will_send) or to_bit(i(say_f) /= say_nothing);
        e(will_load)   := e(will_load) or to_bit(i(special_f) = load_epoch);
        e(will_tell)   := e(will_tell) or to_bit(tells_status(i));
        e(will_change) := e(will_change) or to_bit(changes_data(i));
        table(place)   := e;
      end loop;
      exit when table = before;
    end loop;
    return table;
  end function;

  -- What may be when work begins with this entry, or after a reset.
  function beginning(work : works_t) return facts_t is
    variable f : facts_t := (others => '0');
  begin
    f(work)      := '1';
    f(first)     := '1';
    f(unjudged)  := '1';
    f(untouched) := '1';
    f(unsaid)    := '1';
    f(sending)   := '1';
    if work >= work_read then
      f          := f or verdicts;
      f(is_long) := '1';
      f(unanswered) := '1';
    end if;
    f(unopened) := to_bit(work = work_read or work = work_write);
    return f;
  end function;

  function facts_of(program : frame_program_t) return facts_table_t is
    constant effects : effects_table_t(program'range) := effects_of(program);
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
          table(first_of_entries + place_of(entry)) or beginning(work_of(entry));
      end if;
    end loop;
    loop
      before := table;
      for place in program'range loop
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
          table(target) := table(target) or past(effects(following), facts);
          facts(in_routine) := '1';
          table(following)  := table(following) or facts;
        elsif i(do_dispatch) = '1' then
          for operation in 0 to 15 loop
            if has_id(operation) and facts(work_of(operation)) = '1' then
              part := facts;
              part(works_t'high downto works_t'low) := (others => '0');
              part(work_of(operation)) := '1';
              if work_of(operation) /= work_read and work_of(operation) /= work_write then
                part(unopened) := '0';
              end if;
              table(following + operation) := table(following + operation) or part;
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
