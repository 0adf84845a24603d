-- SPDX-License-Identifier: BSD-3-Clause
--
-- What may be at a place of the program of the framed application, for its proof, and what an instruction makes of it.
-- frame_tables_pkg goes through the program with that. frame_list_facts_pkg has the part about lists.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_facts_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;

package frame_facts_pkg is

  -- Each bit says that something may be so. What may not be so is the fact. The first bits are the works of
  -- frame_works_pkg.
  subtype facts_t is std_ulogic_vector(100 downto 0);

  subtype list_f is natural range 100 downto 49;  -- list_facts_t

  -- The id.
  constant first        : natural := 14;  -- mark_repeated is not set
  constant repeats      : natural := 15;  -- it is set
  constant judged_once  : natural := 16;  -- the cache was asked, and mark_repeated is not set
  constant judged_twice : natural := 17;
  constant judged_more  : natural := 18;
  constant unjudged     : natural := 19;  -- the cache has not called the id of the request new, and mark_repeated is
                                          -- not set
  constant is_new       : natural := 20;  -- it is a request with an id, which is new
  constant is_repeated  : natural := 21;
  constant is_stale     : natural := 22;  -- neither
  constant is_long      : natural := 23;  -- it is a request with an id, and has both bytes of it
  constant taken_some   : natural := 24;  -- the next byte is not the first one

  -- The bus.
  constant untouched    : natural := 25;  -- there was no access
  constant on_bus       : natural := 26;  -- there is one, or its end was not seen yet
  constant touched      : natural := 27;  -- there was one
  constant failing      : natural := 28;  -- there was an access, and the bus refused it or did not answer; or it is
                                          -- one of a list, and was denied
  constant denying      : natural := 41;  -- there was a write of no list, and the dead-man denied it
  constant succeeding   : natural := 29;  -- there was an access, and it went well
  constant unopened     : natural := 30;  -- it is a READ or WRITE without an access
  constant untold       : natural := 31;  -- a request with an id had an access, and `data` is not its status

  -- The answer.
  constant unsaid       : natural := 32;  -- there is none
  constant unanswered   : natural := 40;  -- there is none, and it is a request with an id
  constant said         : natural := 33;  -- it has begun
  constant ended        : natural := 34;  -- it has ended
  constant untrue       : natural := 35;  -- there was an access, and the status of the answer is another one
  constant sending      : natural := 36;  -- the transmitter is not idle
  constant begun_bytes  : natural := 43;  -- some of its bytes were sent, and no kind
  constant has_command  : natural := 42;  -- the dead-man was started, stopped or armed
  constant new_epoch       : natural := 37;  -- the epoch was loaded

  -- LIST and POST_LIST go through the same places twice. These are about the first time, and about the second one.
  constant judged_early : natural := 44;  -- the cache was asked
  constant repeats_early : natural := 45; -- `repeats`
  constant begun_early  : natural := 46;  -- `begun_bytes`
  constant unjudged_run : natural := 47;  -- `unjudged`
  constant fine_run     : natural := 48;  -- no access has failed

  constant in_routine   : natural := 38;
  constant returned_to  : natural := 39;  -- a routine returns to this place

  -- Without what contradicts the rest.
  function settled(facts : facts_t) return facts_t;

  -- What may be behind an instruction that goes on, or that jumps.
  function behind(i : frame_instruction_t; facts : facts_t; jumps, lists : boolean) return facts_t;

  -- What may be when work begins with this entry, or after a reset.
  function beginning(work : works_t) return facts_t;

  function tells_kind(i : frame_instruction_t) return boolean;

  -- It loads the status of an access that failed.
  function tells_status(i : frame_instruction_t) return boolean;

  function changes_data(i : frame_instruction_t) return boolean;

  -- The condition never holds, because the core lacks what it is about.
  function is_dead(condition : natural; lists : boolean) return boolean;

end package;

package body frame_facts_pkg is

  constant verdicts : facts_t := (is_new | is_repeated | is_stale => '1', others => '0');

  function is_dead(condition : natural; lists : boolean) return boolean is
  begin
    return condition = never or condition = if_top or condition = if_left_other or
           (condition = if_shape and not lists);
  end function;

  -- With those works only that are lists.
  function of_lists(facts : facts_t) return facts_t is
    variable f : facts_t := facts;
  begin
    f(works_t'high downto works_t'low) := (others => '0');
    f(work_list)      := facts(work_list);
    f(work_post_list) := facts(work_post_list);
    return f;
  end function;

  function has_lists(facts : facts_t) return std_ulogic is
  begin
    return facts(work_list) or facts(work_post_list);
  end function;

  -- Without what contradicts the rest.
  function settled(facts : facts_t) return facts_t is
    variable f : facts_t := facts;
  begin
    if has_lists(f) = '0' then
      f(list_f) := no_list;
    elsif list_facts_t'(f(list_f)) = no_list then
      f(work_list)      := '0';
      f(work_post_list) := '0';
    elsif only_reads(f(list_f)) then
      f(work_post_list) := '0';
    end if;
    if of_lists(f) = f and f(list_f'low + executing) = '0' then  -- it has had no access
      f(on_bus)     := '0';
      f(touched)    := '0';
      f(failing)    := '0';
      f(denying)    := '0';
      f(succeeding) := '0';
    end if;
    f(judged_early)  := f(judged_early) and f(list_f'low + checking);
    f(repeats_early) := f(repeats_early) and f(list_f'low + checking);
    f(begun_early)   := f(begun_early) and f(list_f'low + checking);
    f(unjudged_run)  := f(unjudged_run) and f(list_f'low + executing);
    f(fine_run)      := f(fine_run) and f(list_f'low + executing) and (f(untouched) or f(succeeding));
    if of_lists(f) = f and f(list_f'low + checking) = '0' and f(fine_run) = '0' then
      f(untouched)  := '0';
      f(succeeding) := '0';
    end if;
    if of_lists(f) = f and f(list_f'low + executing) = '0' then
      if f(judged_early) = '0' then
        f(judged_more downto judged_once) := "000";
      end if;
      f(repeats)     := f(repeats) and f(repeats_early);
      f(begun_bytes) := f(begun_bytes) and f(begun_early);
    end if;
    if of_lists(f) = f and f(work_list) = '0' then  -- a post has no id
      f(judged_more downto judged_once) := "000";
      f(is_long downto unjudged) := (others => '0');
      f(unanswered)  := '0';
      f(unopened)    := '0';
      f(untold)      := '0';
      f(repeats)     := '0';
      f(begun_bytes) := '0';
    end if;
    if of_lists(f) = f and f(list_f'low + checking) = '0' and f(unjudged_run) = '0' then
      f(unjudged) := '0';
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
  function behind(i : frame_instruction_t; facts : facts_t; jumps, lists : boolean) return facts_t is
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
        f(judged_early) := '1';
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
          f(failing)    := f(failing) and has_lists(f);
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
        if jumps and is_dead(condition, lists) then
          f := (others => '0');
        end if;
    end case;

    -- The bus.
    if i(do_await) = '1' then
      f(touched) := f(touched) or f(on_bus);
      f(on_bus)  := '0';
    end if;
    if condition = if_failed and jumps then
      f(succeeding) := '0';
      f(fine_run)   := f(fine_run) and f(untouched);
    elsif condition = if_failed or (condition = if_over and not jumps) then
      f(failing) := '0';
      f(denying) := '0';
    end if;
    if not jumps and (i(do_read) or i(do_write)) = '1' then
      f(untouched)  := '0';
      f(unopened)   := '0';
      f(on_bus)     := '1';
      f(failing)    := '1';
      f(succeeding) := '1';
      f(fine_run)   := '1';
      f(denying)    := i(do_write) and not to_bit(of_lists(f) = f);
      f(untold)     := '1';
      f(untrue)     := f(said) or f(ended);
    end if;

    -- The answer.
    if acts then
      if i(say_f) /= say_nothing then
        f(sending)     := '1';
        f(begun_bytes) := (f(begun_bytes) or f(unsaid)) and to_bit(i(say_f) = say_byte or i(say_f) = say_kept);
        f(begun_early) := f(begun_bytes);
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
      f(unjudged) := or f(works_t'high downto work_read);
    end if;
    if commands(i) and not (jumps and condition = if_flag and number = flag_tripped) then
      f(has_command) := '1';
    end if;
    if i(special_f) = load_epoch then
      f(new_epoch) := '1';
    end if;
    if i(special_f) = set_marks and number = mark_repeated then
      f(repeats) := f(repeats) or f(first);
      f(repeats_early) := '1';
      f(first)   := '0';
    end if;
    if condition = if_mark then
      if number /= mark_repeated then  -- only lists have others
        if jumps then
          f := of_lists(f);
        end if;
        if number = mark_posting and jumps then
          f(work_list)      := '0';
        elsif number = mark_posting and f(list_f'low + unposted) = '0' then
          f(work_post_list) := '0';
        end if;
      elsif jumps then
        f(first)   := '0';
      else
        f(repeats) := '0';
      end if;
    end if;
    f := settled(f);
    f(list_f) := list_behind(i, f(list_f), jumps, f(work_list), f(work_post_list), f(repeats), f(first));
    if i(special_f) = set_marks and number = mark_executing then
      f(unjudged_run) := f(unjudged);
      f(fine_run)     := '1';
    end if;
    f := settled(f);
    return f;
  end function;

  -- What may be when work begins with this entry, or after a reset.
  function beginning(work : works_t) return facts_t is
    variable f : facts_t := (others => '0');
  begin
    f(work)      := '1';
    f(first)     := '1';
    f(untouched) := '1';
    f(unsaid)    := '1';
    f(sending)   := '1';
    if work >= work_read then
      f          := f or verdicts;
      f(is_long) := '1';
      f(unjudged) := '1';
      f(unanswered) := '1';
    end if;
    f(unopened) := to_bit(work = work_read or work = work_write);
    if work = work_list or work = work_post_list then
      f(list_f) := list_begins(to_bit(work = work_list), to_bit(work = work_post_list));
    end if;
    return f;
  end function;

end package body;
