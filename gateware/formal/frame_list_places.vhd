-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the invariant of frame_places about lists: what frame_list_facts_pkg says of the place is true.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_facts_pkg.all;
use work.frame_list_parts_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;

entity frame_list_places is
  port (
    clk              : in std_ulogic;
    w                : in frame_work_t;
    l                : in frame_list_t;
    now              : in frame_instruction_t;
    acts             : in std_ulogic;            -- this is not its first clock
    turns            : in unsigned(2 downto 0);
    begins           : in std_ulogic;
    here, there      : in list_facts_t;          -- of the place, and of the one behind the call
    busy_here, busy_there : in std_ulogic;       -- there is such a place
    left             : in unsigned(3 downto 0);  -- bytes of the frame
    bus_open         : in std_ulogic;
    marks, shape     : in byte_t;
    count, address   : in unsigned(7 downto 0);
    data             : in byte_t                 -- its lowest byte
  );
end entity;

architecture properties of frame_list_places is

  signal repeats, posted : std_ulogic;
  signal list_true, parts_true, forms_true, values_true, caller_true : std_ulogic;

begin

  default clock is rising_edge(clk);

  repeats <= or (marks and byte_t(to_unsigned(mark_repeated, 8)));
  posted  <= or (marks and byte_t(to_unsigned(mark_posting, 8)));

  -- What is so at any time of the work.
  know_list : process (all) is
    variable runs, skips : boolean;
  begin
    runs  := is_run(l.part);
    skips := is_skip(l.part);
    list_true <= to_bit(to_unsigned(l.operation, 4) <= no_operation and to_unsigned(l.part, 5) <= part_astray);
    if begins = '1' then
      list_true <= l.at_start and to_bit(to_unsigned(l.operation, 4) <= no_operation);
    elsif w.listed = '1' and w.dones = 0 then
      list_true <= to_bit(
        to_unsigned(l.operation, 4) <= no_operation and
        belongs(l.part, l.operation) and
        l.part < part_astray and
        (not runs or (l.executes = '1' and (repeats = '0' or reads(l.operation)))) and
        (not skips or l.executes = '0' or l.words /= 0) and
        (not skips or l.executes = '0' or (repeats = '1' and not reads(l.operation))) and
        (not is_end(l.part) or l.words = 0) and
        ((l.part /= part_mask and l.part /= part_again and l.part /= part_value and l.part /= part_stream and
          l.part /= part_item) or
         l.words /= 0) and
        (l.part >= part_plain or (l.posts = '0' and l.barred = '1')) and
        (l.part /= part_plain or l.posts = '0') and
        (not is_head(l.part) or l.part < part_plain or l.posts = '1' or l.barred = '0') and
        (l.executes = '1' or (w.accesses = 0 and bus_open = '0')) and
        (l.posts = '0' or repeats = '0'));
    end if;
  end process;

  know_places : process (all) is
    variable takes   : boolean;
    variable rewound : boolean;               -- the instruction has rewound the frame
    variable origin  : natural range 0 to 31; -- what came next when the instruction began

    impure function part_is(f : list_facts_t; part : natural) return boolean is
    begin
      return rewound or f(part) = '1' or
             (takes and left = 0 and (unsigned(now(condition_f)) = if_missing or f(formless) = '1'));
    end function;

    impure function form_is(f : list_facts_t) return boolean is
    begin
      return f(operations + l.operation) = '1' and
             only_if(f(checking), l.executes = '0') and only_if(f(executing), l.executes = '1') and
             only_if(f(formless), l.formed = '0' and not rewound) and
             only_if(f(unformed), l.executes = '1' and l.formed = '0' and not rewound) and
             only_if(f(some_left), left /= 0 and not rewound) and
             only_if(f(at_end), left = 0 and is_end(l.part)) and
             only_if(f(unposted), l.posts = '1' and posted = '0') and
             only_if(f(post_reads), l.posts = '1' and l.part > part_size and reads(l.operation)) and
             only_if(f(oddly), l.odd = '1') and
             only_if(f(empty), l.words = 0 and
                               (l.part = part_base or l.part = part_item or l.part = part_block)) and
             only_if(f(going), w.accesses = 1 and bus_open = '0' and w.trouble = 0 and l.words /= 0);
    end function;

    impure function value_is(f : list_facts_t) return boolean is
      variable step : unsigned(7 downto 0);
    begin
      step := "0000000" & to_bit(climbs(l.operation));
      return only_if(f(misshapen), shape /= shape_of(l.operation)) and
             only_if(f(miscounted), not rewound and not is_end(l.part) and count /= l.words) and
             only_if(f(uncleared), is_end(l.part) and count /= 0) and
             only_if(f(other_op), operation_of(data) /= l.operation) and
             only_if(f(other_size), unsigned(data) /= l.words) and
             only_if(f(elsewhere), has_address(l.part) and address /= l.address) and
             only_if(f(far_away), has_address(l.part) and address + step /= l.address);
    end function;
  begin
    takes   := w.idle = '0' and now(take_f) /= take_nothing and unsigned(now(times_f)) /= 0;
    rewound := acts = '1' and now(do_rewind) = '1';
    origin  := l.part;
    if takes then
      origin := to_integer(to_unsigned(l.part, 5) - (unsigned(now(times_f)) - turns));
    end if;
    parts_true  <= '1';
    forms_true  <= '1';
    values_true <= '1';
    caller_true <= '1';
    if w.listed = '1' and busy_here = '1' then
      parts_true  <= to_bit(part_is(here, origin) and (not rewound or l.at_start = '1'));
      forms_true  <= to_bit(form_is(here));
      values_true <= to_bit(value_is(here));
    end if;
    if w.listed = '1' and busy_there = '1' then
      caller_true <= to_bit(part_is(there, l.part) and form_is(there) and value_is(there));
    end if;
  end process;

  -- What comes next of the list fits its operation, its marks and the words that are left.
  lists_are : assert always w.begun = '1' -> list_true = '1';

  -- What comes next of the list is what the table says.
  parts_are_true : assert always w.begun = '1' -> parts_true = '1';

  -- The list was gone through as far as the table says.
  forms_are_true : assert always w.begun = '1' -> forms_true = '1';

  -- Where the table says so, the registers have the shape, the count, the address and the value of the list.
  values_are_true : assert always w.begun = '1' -> values_true = '1';

  -- All that is true, too, of the place behind the call.
  list_caller_is_true : assert always w.begun = '1' -> caller_true = '1';

end architecture;
