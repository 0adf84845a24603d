-- SPDX-License-Identifier: BSD-3-Clause
--
-- The invariant of the framed application for its proof: the program is where it can be, and what frame_facts_pkg says
-- of that place is true. ABC shows by induction that it stays so, and that the properties of frame_application follow.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_facts_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_facts_pkg.all;
use work.frame_pkg.all;
use work.frame_tables_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity frame_places is
  generic (
    program : frame_program_t;
    lists   : boolean
  );
  port (
    clk             : in std_ulogic;
    w               : in frame_work_t;
    -- The sequencer: which instruction is executed, unless `idle`, and which one was fetched.
    place_now, place_ahead, caller : in unsigned(bits_for(program'length) - 1 downto 0);
    busy, first_clock, jump, begins : in std_ulogic;
    turns           : in unsigned(2 downto 0);
    -- The judge: what it sees in this clock.
    sees_missing, sees_not_new, sees_failed : in std_ulogic;
    jump_kept       : in std_ulogic;             -- it jumps because of what was judged before
    marks, shape    : in byte_t;
    count           : in unsigned(7 downto 0);
    -- The frame that waits.
    stands          : in std_ulogic;
    waiting         : in entry_t;                -- its entry
    barrier         : in std_ulogic;
    length, taken   : in unsigned;
    -- The bus, and the dead-man.
    bus_open, over, failed, silent_bus : in std_ulogic;
    denied_write    : in std_ulogic;
    tripped         : in std_ulogic;
    commanded       : in std_ulogic;             -- the dead-man was started, stopped or armed
    data            : in word32_t;
    word_index      : in unsigned(7 downto 0);
    reply_idle      : in std_ulogic;
    fresh, repeated : in std_ulogic;
    id              : in std_ulogic_vector(15 downto 0);
    -- For frame_list_places: the instruction, and what may be of a list there, and behind the call.
    now             : out frame_instruction_t;
    acts            : out std_ulogic;            -- this is not its first clock
    here, there     : out list_facts_t;
    busy_here, busy_there : out std_ulogic
  );
end entity;

architecture properties of frame_places is

  constant table   : facts_table_t(program'range)   := facts_of(program, lists);
  constant effects : effects_table_t(program'range) := effects_of(program, lists);

  signal condition : natural range 0 to 31;
  signal number    : natural range 0 to 255;
  signal place     : unsigned(place_now'range);  -- the one that is executed, or comes next
  signal following : unsigned(place_now'range);  -- what is fetched behind it, unless it jumps
  signal marked    : std_ulogic;            -- mark_repeated is set
  signal executes  : std_ulogic;            -- mark_executing is
  signal bytes_begun : std_ulogic;          -- bytes of the answer were sent before this instruction
  signal same_id   : std_ulogic;            -- the id is the one that was judged
  signal starts    : std_ulogic;            -- nothing was executed since the reset
  signal waits     : std_ulogic;            -- a request waits, which needs a session

  signal registers_true, works_true, steps_true, rests_true : std_ulogic;
  signal work_true, id_true, bus_true, status_true, answer_true : std_ulogic;  -- of the place
  signal caller_true, marks_true : std_ulogic;

begin

  default clock is rising_edge(clk);

  now       <= program(to_integer(place_now));
  condition <= to_integer(unsigned(now(condition_f)));
  number    <= to_integer(unsigned(now(number_f)));
  place     <= place_ahead when w.idle = '1' else place_now;
  marked    <= or (marks and byte_t(to_unsigned(mark_repeated, 8)));
  bytes_begun <= w.begun_payload and not (acts and to_bit(now(say_f) = say_byte or now(say_f) = say_kept));
  executes  <= or (marks and byte_t(to_unsigned(mark_executing, 8)));
  starts    <= busy and w.idle and first_clock;
  waits     <= stands and to_bit(unsigned(waiting) < 16);
  acts      <= not w.idle and not first_clock;

  -- Other marks than mark_repeated belong to lists. They change only at the end of an instruction.
  marks_true <= to_bit(
    (marks and not byte_t(to_unsigned(mark_repeated, 8))) = x"00" or
    (lists and w.frame = '0') or
    (w.listed = '1' and ((marks and byte_t(to_unsigned(mark_posting, 8))) = x"00" or
                         work_of(w.entry, lists) = work_post_list)));

  tell_lists : process (all) is
  begin
    here       <= table(to_integer(place))(list_f);
    there      <= table(to_integer(caller))(list_f);
    busy_here  <= busy and not starts;
    busy_there <= busy and not starts and w.routine;
  end process;

  follow : process (all) is
  begin
    following <= resize(unsigned(now(following_f)), following'length);
    if now(do_return) = '1' then
      following <= caller;
    elsif now(do_dispatch) = '1' then
      following(3 downto 0) <= unsigned(waiting(3 downto 0));
    end if;
  end process;

  -- The id is sent byte by byte, and rotates meanwhile.
  compare : process (all) is
  begin
    same_id <= to_bit(id = w.judged_id);
    if w.idle = '0' and now(source_f) = from_id and turns = 0 then
      same_id <= to_bit(id(7 downto 0) & id(15 downto 8) = w.judged_id);
    end if;
  end process;

  -- What is so at any time.
  know_registers : process (all) is
  begin
    registers_true <= to_bit(
      (marks_true = '1' or busy = '0') and
      (stands = '0' or (unsigned(waiting) < entry_trip and begins_work(to_integer(unsigned(waiting))))) and
      (bus_open = '0' or over = '0') and
      (w.accesses = 0 or (to_bit(w.trouble /= 0) = failed and to_bit(w.trouble = 2) = silent_bus and
                        to_bit(w.trouble = 3) = denied_write)) and w.accesses < 2);
  end process;

  know_works : process (all) is
  begin
    works_true <= '1';
    if busy = '1' then
      works_true <= to_bit((w.with_id = '1' or (w.judgements = 0 and (w.listed = '0' or w.begun_payload = '0'))) and
                           w.dones = 0 and w.memories = 0 and w.judgements <= 2 and
                           (marked = '0' or ((w.with_id = '0' or fresh = '0') and commanded = '0' and
                                             (w.listed = '1' or (w.accesses = 0 and bus_open = '0')))) and
                           (w.judged = '0' or fresh = '1') and
                           (w.frame = '0' or (stands = '1' and unsigned(waiting) = w.entry and
                                            w.had_id = to_bit(length >= 2))));
      if starts = '1' then
        works_true <= to_bit(w.routine = '0' and w.judgements = 0 and w.accesses = 0 and w.memories = 0 and
                             bus_open = '0' and
                             w.dones = 0 and w.kinds = 0 and w.given = '0' and w.frame = '0' and w.forgot = '0' and
                             (waits = '0' or w.in_session = '1'));
      end if;
    end if;
  end process;

  -- How an instruction is executed, and when it jumps.
  know_steps : process (all) is
    function only(seen : std_ulogic; so : boolean) return boolean is
    begin
      return (seen = '1') = so;
    end function;

    variable ok : boolean;
  begin
    ok := true;
    if starts = '0' then
      ok := only(sees_missing, w.idle = '0' and first_clock = '0' and condition = if_missing) and
            only(sees_not_new, w.idle = '0' and first_clock = '0' and condition = if_not_new) and
            only(sees_failed, w.idle = '0' and first_clock = '0' and (condition = if_failed or condition = if_over));
      if w.idle = '1' then  -- it jumps, or there is no work
        ok := ok and jump = '0' and turns = 0;
      else
        ok := ok and turns <= unsigned(now(times_f));
        if first_clock = '1' or is_dead(condition, lists) then
          ok := ok and jump = '0';
        elsif condition = if_missing or condition = if_not_new or condition = if_failed then
          ok := ok and jump_kept = '0';
        elsif condition = if_mark then
          ok := ok and jump = (or (marks and now(number_f)));
        elsif condition = if_flag and number = flag_tripped then
          ok := ok and (jump = '0' or tripped = '1');
        elsif condition = if_denied then
          ok := ok and jump = denied_write;
        elsif condition = if_duplicate then
          ok := ok and jump = (repeated xor now(if_not));
        elsif condition = if_busy then
          ok := ok and (jump = '1' or reply_idle = '1');
        elsif condition = if_shape then
          ok := ok and jump = (or (shape and now(number_f)));
        elsif condition = if_some_left then
          ok := ok and jump = (or count xor now(if_not));
        elsif condition = if_over then
          ok := ok and jump_kept = (nor count);
        elsif condition = if_barrier then
          ok := ok and jump = barrier;
        elsif condition = if_low and w.listed = '1' and not changes_data(now) then
          ok := ok and jump = (to_bit(data(7 downto 0) = now(number_f)) xor now(if_not));
        end if;
        if first_clock = '0' and now(do_begin) = '0' then
          ok := ok and place_ahead = following;
        end if;
        if now(take_f) = take_id then
          ok := ok and turns < 2 and (taken = 0 or (taken = 1 and turns = 0));
        end if;
        if now(do_rewind) = '1' and first_clock = '0' then
          ok := ok and taken = 0;
        end if;
        if now(data_f) = data_word and now(special_f) = by_silence then
          ok := ok and now(times_f) = "010" and (turns = 2 or w.looked_at_next = word_index) and
                (turns /= 0 or w.looked_at = word_index);
        end if;
        if condition = if_not_new then
          ok := ok and id = w.id_before and w.other = '0' and
                (first_clock = '1' or (id = w.id_then and w.other_before = '0'));
        end if;
      end if;
    end if;
    steps_true <= to_bit(ok);
  end process;

  know_rests : process (all) is
  begin
    rests_true <= '1';
    if busy = '0' then
      rests_true <= to_bit(
        w.idle = '1' and first_clock = '0' and w.routine = '0' and bus_open = '0' and
        w.given = '0' and (waits = '0' or w.in_session = '1') and
        (begins = '0' or
         (marks = x"00" and taken = 0 and place_ahead = first_of_entries + to_integer(unsigned(w.chosen)) and
          begins_work(to_integer(unsigned(w.chosen))) and
          (unsigned(w.chosen) >= entry_trip or
           (stands = '1' and unsigned(w.chosen) = place_of(to_integer(unsigned(waiting))))))));
    end if;
  end process;

  -- What the table says of the place, and of the one behind the call.
  know_places : process (all) is
    variable with_id, opens : boolean;
    variable f : facts_t;
    variable e : effects_t;

    impure function work_is(f : facts_t; here : std_ulogic) return boolean is
    begin
      return f(in_routine) = here and
             ((w.frame = '0' and f(work_none) = '1') or (w.frame = '1' and f(work_of(w.entry, lists)) = '1')) and
             only_if(f(is_new), with_id and fresh = '1') and only_if(f(is_repeated), with_id and repeated = '1') and
             only_if(f(is_stale), with_id and (fresh or repeated) = '0') and
             only_if(f(is_long), with_id and w.had_id = '1') and
             only_if(f(taken_some), taken /= 0 and not (acts = '1' and now(take_f) /= take_nothing)) and
             only_if(f(has_command), commanded = '1') and
             only_if(f(new_epoch), w.forgot = '1' or (waits = '1' and w.in_session = '0'));
    end function;

    impure function id_is(f : facts_t) return boolean is
    begin
      return only_if(f(first), marked = '0') and only_if(f(repeats), marked = '1') and
             only_if(f(judged_once), marked = '0' and w.judgements = 1) and
             only_if(f(judged_twice), marked = '0' and w.judgements = 2) and
             only_if(f(unjudged), with_id and marked = '0' and (w.judged = '0' or same_id = '0')) and
             only_if(f(judged_early), w.listed = '1' and executes = '0' and w.judgements /= 0) and
             only_if(f(repeats_early), w.listed = '1' and executes = '0' and marked = '1') and
             only_if(f(fine_run), w.listed = '1' and executes = '1' and (w.accesses = 0 or w.trouble = 0)) and
             only_if(f(unjudged_run), with_id and executes = '1' and marked = '0' and
                                      (w.judged = '0' or same_id = '0'));
    end function;

    impure function bus_is(f : facts_t) return boolean is
    begin
      return (w.accesses = 0 or bus_open = '0' or w.listed = '1') and
             only_if(f(untouched), w.accesses = 0 and bus_open = '0') and only_if(f(on_bus), bus_open = '1') and
             only_if(f(on_bus) or f(touched), w.accesses = 1) and
             only_if(f(failing), w.accesses = 1 and (w.trouble = 1 or w.trouble = 2 or
                                                     (w.trouble = 3 and w.listed = '1'))) and
             only_if(f(denying), w.accesses = 1 and w.trouble = 3 and w.listed = '0') and
             only_if(f(succeeding), w.accesses = 1 and w.trouble = 0) and
             only_if(f(unopened), opens and w.accesses = 0 and bus_open = '0');
    end function;

    impure function status_is(f : facts_t; still : effects_t) return boolean is
    begin
      return only_if(f(untold) or still(will_tell), with_id and w.accesses = 1 and
                                                    data(3 downto 0) /= w.status) and
             only_if(f(untrue), w.accesses = 1 and (still(will_say) = '1' or
                                                  (w.kinds /= 0 and w.kind(3 downto 0) /= w.status)));
    end function;

    impure function answer_is(f : facts_t; still : effects_t) return boolean is
    begin
      return only_if(f(sending), reply_idle = '0' and not (acts = '1' and now(say_f) /= say_nothing)) and
             only_if(f(unanswered) or still(will_say), with_id and w.kinds = 0) and
             only_if(f(begun_bytes) or still(will_say), w.given = '0' and
                                                        (still(will_put) = '1' or bytes_begun = '1')) and
             only_if(f(begun_early) or still(will_say), w.given = '0' and w.listed = '1' and executes = '0' and
                                                        (still(will_put) = '1' or bytes_begun = '1')) and
             ((still(will_say) = '0' and w.kinds = 0 and w.given = '0' and f(unsaid) = '1') or
              (still(will_say) = '0' and w.kinds = 1 and w.given = '1' and f(said) = '1') or
              (still(will_say) = '0' and w.kinds = 1 and w.given = '0' and f(ended) = '1') or
              (still(will_say) = '1' and w.kinds = 0 and w.given = '0' and f(said) = '1'));
    end function;
  begin
    with_id := w.frame = '1' and has_id(w.entry);
    opens   := w.frame = '1' and (work_of(w.entry, lists) = work_read or work_of(w.entry, lists) = work_write);
    work_true   <= '1';
    id_true     <= '1';
    bus_true    <= '1';
    status_true <= '1';
    answer_true <= '1';
    caller_true <= '1';
    if busy = '1' and starts = '0' then
      f := table(to_integer(place));
      work_true   <= to_bit(work_is(f, w.routine));
      id_true     <= to_bit(id_is(f));
      bus_true    <= to_bit(bus_is(f));
      status_true <= to_bit(status_is(f, no_effects));
      answer_true <= to_bit(answer_is(f, no_effects));
      if w.routine = '1' then
        f := table(to_integer(caller));
        e := effects(to_integer(place));
        caller_true <= f(returned_to) and to_bit(work_is(f, '0') and id_is(f) and bus_is(f) and status_is(f, e) and
                                                 answer_is(f, e));
      end if;
    end if;
  end process;

  -- Registers are as the others say. Marks are only those that this core has.
  registers_are : assert always w.begun = '1' -> registers_true = '1';

  -- While there is work, its frame stands, and is not done.
  work_stands : assert always w.begun = '1' -> works_true = '1';

  -- Instructions are executed one after the other, and jump only if their condition holds.
  steps_are : assert always w.begun = '1' -> steps_true = '1';

  -- Without work nothing is open. What begins is the frame that waits, or an event.
  rests_are : assert always w.begun = '1' -> rests_true = '1';

  -- The work is one of those that come to this place, with the verdict that leads here.
  work_is_true : assert always w.begun = '1' -> work_true = '1';

  -- The cache was asked as often as the table says, about this id.
  id_is_true : assert always w.begun = '1' -> id_true = '1';

  -- There was an access or none, as the table says, and it went well or failed.
  bus_is_true : assert always w.begun = '1' -> bus_true = '1';

  -- Where the table says so, `data` and the answer have the status of the access.
  status_is_true : assert always w.begun = '1' -> status_true = '1';

  -- There is no answer yet, or it has begun, or it has ended, as the table says.
  answer_is_true : assert always w.begun = '1' -> answer_true = '1';

  -- All that is true, too, of the place behind the call, when the routine will be over.
  caller_is_true : assert always w.begun = '1' -> caller_true = '1';

end architecture;
