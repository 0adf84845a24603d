-- SPDX-License-Identifier: BSD-3-Clause
--
-- The invariant of the framed application for its proof: the program is where it can be, and what frame_facts_pkg says
-- of that place is true. `holds` says so. The proof of frame_application asserts it together with each property that
-- it proves for ever, so the solver need not find it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_facts_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_places is
  generic (
    program : frame_program_t  -- 256 instructions
  );
  port (
    -- The sequencer: which instruction is executed, unless `idle`, and which one was fetched.
    place_now, place_ahead, caller : in unsigned(7 downto 0);
    idle, busy, first_clock, jump, begins : in std_ulogic;
    turns           : in unsigned(2 downto 0);
    -- The judge: what it looks at in this clock.
    sees_missing, sees_not_new, sees_failed : in std_ulogic;
    marks           : in byte_t;
    -- The frame that waits, and the work in hand.
    stands          : in std_ulogic;
    waiting         : in entry_t;                -- entry of the frame
    chosen          : in entry_t;                -- what begins
    entry           : in natural range 0 to 31;  -- of the work
    frame, routine  : in std_ulogic;
    bus_open        : in std_ulogic;
    accesses        : in natural range 0 to 2;
    memories        : in natural range 0 to 2;
    judgements      : in natural range 0 to 3;
    holds           : out std_ulogic
  );
end entity;

architecture properties of frame_places is

  constant table : facts_table_t := facts_of(program);

begin

  know : process (all) is
    variable now       : frame_instruction_t;
    variable condition : natural range 0 to 31;
    variable following : unsigned(7 downto 0);
    variable repeated  : std_ulogic;
    variable starts    : boolean;              -- nothing was executed since the reset
    variable ok        : boolean;

    impure function is_true(place : natural; here : std_ulogic) return boolean is
      variable f : facts_t;
    begin
      f := table(place);
      return (f(first) or repeated) = '1' and (f(repeats) or not repeated) = '1' and f(in_routine) = here and
             judgements <= 2 and
             (repeated = '1' or ((f(judged_once) = '1' or judgements < 1) and
                                 (f(judged_twice) = '1' or judgements < 2))) and
             (f(touched) = '1' or (accesses = 0 and bus_open = '0')) and (f(noted) = '1' or memories = 0) and
             (f(strange) = '1' or (has_id(entry) and frame = '1' and stands = '1' and unsigned(waiting) = entry));
    end function;

    impure function sees_only(seen : std_ulogic; what : natural) return boolean is
    begin
      return seen = '0' or (idle = '0' and first_clock = '0' and condition = what);
    end function;
  begin
    now       := program(to_integer(place_now));
    condition := to_integer(unsigned(now(condition_f)));
    repeated  := or (marks and byte_t(to_unsigned(mark_repeated, 8)));
    starts    := busy = '1' and idle = '1' and first_clock = '1';

    following := resize(unsigned(now(following_f)), 8);
    if now(do_return) = '1' then
      following := caller;
    elsif now(do_dispatch) = '1' then
      following(3 downto 0) := unsigned(waiting(3 downto 0));
    end if;

    ok := (marks and not byte_t(to_unsigned(mark_repeated, 8))) = x"00" and
          (stands = '0' or (unsigned(waiting) < entry_trip and begins_work(to_integer(unsigned(waiting))))) and
          (starts or (sees_only(sees_missing, if_missing) and sees_only(sees_not_new, if_not_new) and
                      sees_only(sees_failed, if_failed)));

    if starts then
      ok := ok and routine = '0' and judgements = 0 and accesses = 0 and memories = 0 and bus_open = '0';
    elsif busy = '0' then
      ok := ok and idle = '1' and first_clock = '0' and jump = '0' and turns = 0 and routine = '0' and bus_open = '0';
      if begins = '1' then
        ok := ok and marks = x"00" and place_ahead = first_of_entries + to_integer(unsigned(chosen)) and
              begins_work(to_integer(unsigned(chosen))) and
              (unsigned(chosen) >= entry_trip or
               (stands = '1' and unsigned(chosen) = place_of(to_integer(unsigned(waiting)))));
      end if;
    elsif idle = '1' then  -- it jumps
      ok := ok and jump = '0' and is_true(to_integer(place_ahead), routine);
    else
      ok := ok and is_true(to_integer(place_now), routine);
      if first_clock = '1' or condition = never then
        ok := ok and jump = '0';
      elsif condition = if_mark then
        ok := ok and jump = (or (marks and now(number_f)));
      end if;
      if first_clock = '0' and now(do_begin) = '0' then
        ok := ok and place_ahead = following;
      end if;
    end if;
    if busy = '1' and routine = '1' then
      ok := ok and table(to_integer(caller))(returned_to) = '1' and is_true(to_integer(caller), '0');
    end if;
    holds <= to_bit(ok);
  end process;

end architecture;
