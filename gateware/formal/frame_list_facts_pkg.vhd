-- SPDX-License-Identifier: BSD-3-Clause
--
-- What may be at each place of the program while a list is in work, for the proof of the framed application. It is the
-- part of frame_facts_pkg about LIST and POST_LIST.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_parts_pkg.all;

package frame_list_facts_pkg is

  -- Each bit says that something may be so while a list is in work. First come the parts, then the operations.
  subtype list_facts_t is std_ulogic_vector(51 downto 0);
  subtype parts_f is natural range 24 downto 0;

  constant operations  : natural := 25;
  constant checking    : natural := 34;  -- mark_executing is not set
  constant executing   : natural := 35;
  constant misshapen   : natural := 36;  -- `shape` is not that of the operation
  constant miscounted  : natural := 37;  -- `count` is not the number of words left, within an operation
  constant other_op    : natural := 38;  -- the lowest byte of `data` is not the operation
  constant other_size  : natural := 39;  -- nor the number of words left
  constant elsewhere   : natural := 40;  -- `address` is not that of the next access, if the list had it
  constant far_away    : natural := 41;  -- and would not be after a step, if the operation climbs
  constant formless    : natural := 42;  -- the frame was not gone through to its end before the last rewind
  constant some_left   : natural := 43;  -- bytes of the frame are left
  constant at_end      : natural := 44;  -- none are left where the list may end
  constant unposted    : natural := 45;  -- it is a POST_LIST without its mark
  constant going       : natural := 46;  -- the last access went well, and words are left
  constant post_reads  : natural := 47;  -- it is a POST_LIST, and its operation reads
  constant oddly       : natural := 48;  -- an operation before is none, or has no words, or reads for a POST_LIST
  constant empty       : natural := 49;  -- the operation has no words
  constant unformed    : natural := 51;  -- `formless`, and it is executed
  constant uncleared   : natural := 50;  -- `count` is not 0 behind an operation

  constant no_list : list_facts_t := (others => '0');
  -- What may be when a LIST or POST_LIST comes.
  function list_begins(list, post : std_ulogic) return list_facts_t;

  -- What may be behind an instruction that goes on, or that jumps. list, post: it may be a LIST, or a POST_LIST.
  -- marked, unmarked: mark_repeated may be set, or not. The result is `no_list` if there can be no list.
  function list_behind(i : frame_instruction_t; facts : list_facts_t; jumps : boolean;
                       list, post, marked, unmarked : std_ulogic) return list_facts_t;

  -- What may be when `data` has changed.
  function with_data(facts : list_facts_t) return list_facts_t;

  -- It is a list that is executed, and its operation reads. So it is no POST_LIST.
  function only_reads(facts : list_facts_t) return boolean;

end package;

package body frame_list_facts_pkg is

  -- There may be a part other than these, and than `also`.
  function others_than(facts : list_facts_t; first, last, also : part_t) return std_ulogic is
    variable f : list_facts_t := facts;
  begin
    f(last downto first) := (others => '0');
    f(also) := '0';
    return or f(parts_f);
  end function;

  function ends(facts : list_facts_t) return std_ulogic is
  begin
    return or facts(part_masked downto part_read);
  end function;

  function list_begins(list, post : std_ulogic) return list_facts_t is
    variable f : list_facts_t := (others => '1');
  begin
    f(parts_f)     := (others => '0');
    f(part_post)   := post;
    f(part_plain)  := list;
    f(part_barred) := list;
    f(executing)   := '0';
    f(at_end)      := '0';
    f(unposted)    := post;
    f(post_reads)  := post;
    f(oddly)       := '0';
    return f;
  end function;

  function with_data(facts : list_facts_t) return list_facts_t is
    variable f : list_facts_t := facts;
  begin
    f(other_op)    := '1';
    f(other_size)  := '1';
    return f;
  end function;

  function only_reads(facts : list_facts_t) return boolean is
  begin
    return facts(checking) = '0' and or facts(part_first downto 0) = '0' and
           or facts(operations + no_operation downto operations + 3) = '0';
  end function;

  -- The part may be one of this operation, in a list that may be checked only, or may be executed for the first time.
  function fits(part : part_t; operation : operation_t; checked, unmarked : std_ulogic) return boolean is
  begin
    return belongs(part, operation) and not (is_skip(part) and checked = '0' and reads(operation)) and
           not (is_run(part) and unmarked = '0' and not reads(operation));
  end function;

  -- Without what contradicts the rest. A list that was executed before only reads.
  function consistent(facts : list_facts_t; post, marked, unmarked : std_ulogic) return list_facts_t is
    variable f     : list_facts_t := facts;
    variable early : boolean := false;  -- the operation may still be that of a list before
    variable with_part, with_operation : boolean;
  begin
    for part in part_t loop
      if is_run(part) and f(executing) = '0' then
        f(part) := '0';
      elsif is_skip(part) and f(checking) = '0' and marked = '0' then
        f(part) := '0';
      end if;
      early := early or (f(part) = '1' and part <= part_first);
    end loop;
    if f(checking) = '0' and not early then
      f(operations + no_operation) := '0';
      f(post_reads) := '0';
    end if;
    for part in part_t loop
      with_operation := false;
      for operation in operation_t loop
        with_operation := with_operation or
                          (f(operations + operation) = '1' and fits(part, operation, f(checking), unmarked));
      end loop;
      f(part) := f(part) and to_bit(with_operation);
    end loop;
    for operation in operation_t loop
      with_part := false;
      for part in part_t loop
        with_part := with_part or (f(part) = '1' and fits(part, operation, f(checking), unmarked));
      end loop;
      f(operations + operation) := f(operations + operation) and to_bit(with_part);
    end loop;
    if not early and or f(operations + 7 downto operations) = '0' then
      f(executing) := '0';
    end if;
    f(at_end)     := f(at_end) and ends(f);
    f(elsewhere)  := f(elsewhere) and or f(part_stream downto part_mask);
    f(far_away)   := f(far_away) and or f(part_stream downto part_mask);
    f(unformed)   := f(unformed) and f(executing);
    f(unposted)   := f(unposted) and post;
    f(post_reads) := f(post_reads) and post and or f(operations + 2 downto operations);
    if or f(parts_f) = '0' or (f(executing) or f(checking)) = '0' then
      f := no_list;
    end if;
    return f;
  end function;

  -- What may be when an access begins.
  function with_access(facts : list_facts_t) return list_facts_t is
    variable f : list_facts_t := with_data(facts);
    variable climbs_or_stays : std_ulogic := '0';
  begin
    f(parts_f) := (others => '0');
    for part in part_t loop
      for operation in operation_t loop
        if facts(part) = '1' and facts(operations + operation) = '1' and belongs(part, operation) then
          f(opened(part, operation, false)) := '1';
          f(opened(part, operation, true))  := '1';
          climbs_or_stays := climbs_or_stays or to_bit(not changes(operation));
        end if;
      end loop;
    end loop;
    if climbs_or_stays = '1' then
      f(far_away)  := facts(elsewhere);
      f(elsewhere) := '1';
    end if;
    f(uncleared) := facts(miscounted);
    f(at_end)    := '1';
    f(going)     := '1';
    return f;
  end function;

  -- What may be when bytes are taken once.
  function with_bytes(i : frame_instruction_t; facts : list_facts_t; marked, unmarked : std_ulogic)
    return list_facts_t is
    constant many  : boolean := i(take_f) = take_many;
    constant loads : std_ulogic := to_bit(i(take_f) = take_first or i(take_f) = take_data);
    variable f     : list_facts_t := facts;
    variable addresses, others_too : std_ulogic := '0';
  begin
    f(parts_f) := (others => '0');
    for part in part_t loop
      for operation in operation_t loop
        if facts(part) = '1' and facts(operations + operation) = '1' and belongs(part, operation) then
          if i(take_f) = take_item and (facts(misshapen) = '1' or once(operation)) then
            f(part) := '1';
          end if;
          if i(take_f) /= take_item or facts(misshapen) = '1' or not once(operation) then
            if part /= part_size or facts(checking) = '1' or (marked = '1' and not reads(operation)) then
              f(taken(part, operation, many, false)) := '1';
            end if;
            if part = part_size and facts(executing) = '1' and (unmarked = '1' or reads(operation)) then
              f(taken(part, operation, many, true)) := '1';
            end if;
          end if;
        end if;
      end loop;
      if facts(part) = '1' and is_head(part) and facts(formless) = '1' and
          to_integer(unsigned(i(condition_f))) /= if_missing then  -- there may be no byte
        f(part) := '1';
      end if;
      if facts(part) = '1' and (part = part_base or part = part_item) then
        addresses := '1';
      elsif facts(part) = '1' then
        others_too := '1';
      end if;
    end loop;
    if many and facts(miscounted) = '1' then
      f(part_astray) := '1';
    end if;
    if (facts(part_first) or ends(facts)) = '1' then
      f(operations + no_operation downto operations) := (others => '1');
      f(misshapen) := '1';
      f(other_op)   := not loads or others_than(facts, part_read, part_masked, part_first);
      f(post_reads) := '1';
    elsif loads = '1' then
      f(other_op)  := '1';
    end if;
    if facts(part_size) = '1' then
      f(miscounted) := '1';
      f(other_size) := not loads or others_than(facts, part_size, part_size, part_size);
      f(empty)      := '1';
    elsif loads = '1' or (ends(f) or f(part_due)) = '1' then
      f(other_size) := '1';
    end if;
    if ends(f) = '1' then
      f(uncleared)  := '1';
      f(at_end)     := '1';
      f(oddly)      := f(oddly) or facts(operations + no_operation) or facts(post_reads) or facts(empty);
    end if;
    if addresses = '1' then
      f(elsewhere) := (others_too and facts(elsewhere)) or
                      to_bit(i(take_f) /= take_address and i(take_f) /= take_item);
      f(far_away)  := '1';
    end if;
    return f;
  end function;

  -- So many words of the operation are left: some, or none.
  function with_words(facts : list_facts_t; some : boolean) return list_facts_t is
    variable f : list_facts_t := facts;
  begin
    for part in part_t loop
      if (some and is_end(part) and f(uncleared) = '0') or
          (not some and f(miscounted) = '0' and is_run(part) and part /= part_due and part /= part_write) then
        f(part) := '0';
      end if;
    end loop;
    return f;
  end function;

  -- As many bytes are left as the instruction takes, if the list is executed.
  function has_bytes(i : frame_instruction_t; facts : list_facts_t) return boolean is
  begin
    if i(take_f) = take_nothing or facts(part_due) = '1' or facts(part_again) = '1' or facts(part_write) = '1' or
        facts(part_astray) = '1' or (facts(at_end) = '1' and ends(facts) = '1') then
      return false;
    end if;
    for part in part_t loop
      if facts(part) = '1' and (is_head(part) or
                                (i(take_f) = take_many and (not is_skip(part) or facts(miscounted) = '1')) or
                                (i(take_f) /= take_many and (part = part_values or part = part_masks))) then
        return false;
      end if;
    end loop;
    return true;
  end function;

  function list_behind(i : frame_instruction_t; facts : list_facts_t; jumps : boolean;
                       list, post, marked, unmarked : std_ulogic) return list_facts_t is
    variable f         : list_facts_t := facts;
    variable condition : natural;
    variable number    : natural;
  begin
    if facts = no_list then
      return facts;
    end if;
    condition := to_integer(unsigned(i(condition_f)));
    number    := to_integer(unsigned(i(number_f)));

    case condition is
      when if_shape =>
        for operation in operation_t loop
          if f(misshapen) = '0' and (or (shape_of(operation) and i(number_f)) = '1') /= jumps then
            f(operations + operation) := '0';
          end if;
        end loop;
      when if_low =>
        if number = 0 and f(other_size) = '0' and others_than(f, part_base, part_item, part_block) = '0' then
          if jumps then
            f(executing) := '0';
          else
            f(empty) := '0';
          end if;
        end if;
      when if_missing =>
        if jumps and has_bytes(i, f) then
          f(executing) := '0';
        elsif i(take_f) = take_nothing then
          f(some_left) := f(some_left) and not to_bit(jumps);
          f(at_end)    := f(at_end) and to_bit(jumps);
        end if;
      when if_mark =>
        if number = mark_executing then
          if jumps then
            f(checking) := '0';
          else
            f(executing) := '0';
          end if;
        end if;
      when if_barrier =>
        for part in 0 to part_first - 1 loop
          if (part < part_plain) /= jumps then
            f(part) := '0';
          end if;
        end loop;
      when if_some_left =>
        f := with_words(f, jumps = (i(if_not) = '0'));
      when if_over =>
        if jumps then
          f(going) := f(going) and f(miscounted);
        else
          f := with_words(f, true);
        end if;
      when if_failed =>
        if not jumps and f(going) = '0' then
          f(miscounted) := '0';
          f := with_words(f, false);
          f(miscounted) := facts(miscounted);
        end if;
      when others => null;
    end case;
    f := consistent(f, post, marked, unmarked);

    if i(do_rewind) = '1' then
      f(formless)    := f(some_left) or f(oddly) or others_than(f, part_read, part_masked, part_read);
      f(miscounted)  := '1';
      f(unformed)    := f(executing);
      f(some_left)   := '1';
      f(at_end)      := '0';
      f(oddly)       := '0';
      f(parts_f)     := (others => '0');
      f(part_barred) := list;
      f(part_plain)  := list;
      f(part_post)   := post;
    end if;
    if i(take_f) /= take_nothing then
      for turn in 0 to to_integer(unsigned(i(times_f))) loop
        f := with_bytes(i, f, marked, unmarked);
      end loop;
      if jumps and condition = if_missing then
        f(parts_f) := (others => '1');
        f := with_data(f);
        f(at_end)    := '1';
        f(misshapen)  := '1';
        f(miscounted) := '1';
        f(uncleared)  := '1';
        f(oddly)      := '1';
        f(operations + no_operation downto operations) := (others => '1');
      end if;
    elsif i(data_f) /= data_stays or i(source_f) = from_top or i(source_f) = from_word then
      f := with_data(f);
    end if;

    case i(special_f) is
      when load_shape =>
        f(misshapen) := facts(other_op);
      when load_count =>
        f(miscounted) := facts(other_size);
      when load_kept =>
        f(miscounted) := '1';
        f(uncleared)  := '1';
      when address_up =>
        f(elsewhere) := f(far_away) or (f(elsewhere) and to_bit(jumps));
        f(far_away)  := '1';
      when set_marks =>
        if number = mark_executing then
          f(executing) := '1';
          f(checking)  := '0';
          f(unformed)  := f(formless);
        elsif number = mark_posting then
          f(unposted)  := '0';
        end if;
      when others => null;
    end case;
    if not jumps and (i(do_read) or i(do_write)) = '1' then
      f := with_access(f);
    end if;
    if i(special_f) = set_marks and number = mark_repeated then
      return consistent(f, post, '1', '0');
    end if;
    return consistent(f, post, marked, unmarked);
  end function;

end package body;
