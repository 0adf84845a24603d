-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the framed application's program for groups: DEFINE_EXCHANGE and EXCHANGE, DEFINE_GROUP and publishes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_group_pkg is

  procedure exchanges(p : inout assembler_t; s : frame_settings_t);
  procedure publishes(p : inout assembler_t; s : frame_settings_t);

end package;

package body frame_group_pkg is

  procedure define_exchange(p : inout assembler_t; s : frame_settings_t) is
    -- The reply may be too long, if the inputs of a group are long.
    constant sums_inputs : boolean := s.exchange_size * s.data_bytes > s.reply_max - 4;
  begin
    at_form(p, request_kind_define_exchange_c);
    put(p, take(take_skip), if_missing, invalid);
    load(p, word_defined);
    put(p, store(store_data, word_out_size));
    if sums_inputs then
      load(p, word_zero);
      put(p, store(store_data, word_in_size));
    end if;
    put(p, take(take_first) or times(2) or store(store_data, word_counts), if_missing, invalid);
    -- Checks the address and the number of bytes of each member, and adds that number to the word of its kind.
    point(p, word_out_size, data(data_turn) or also(load_count) or times(4));  -- the fourth byte
    at(p, define_member);
    put(p, act(if_not), if_some_left, define_second);
    put(p, take(take_skip) or times(s.address_bytes), if_missing, invalid);
    put(p, take(take_first), if_missing, invalid);
    put(p, number(0), if_low, invalid);
    put(p, number(s.data_bytes), if_above, invalid);
    put(p, data(data_add) or store(store_data, 0) or act(do_pointer) or times(3) or act(do_count));
    go_to(p, define_member);
    at(p, define_second);
    put(p, number(word_in_size), if_pointer, form_end);
    load(p, word_counts);
    point(p, word_in_size, also(load_count));
    go_to(p, define_member);

    at_check(p, request_kind_define_exchange_c);
    put(p, take(take_first) or number(mark_repeated), if_mark, invalid);
    put(p, also(load_group, s.exchanges - 1), if_above, no_group);
    put(p, take(take_first) or store(store_data, word_operand));
    put(p, take(take_first));
    put(p, data(data_add) or number(word_operand) or times(3));
    put(p, also(load_count, s.exchange_size), if_above, no_group);  -- members of both kinds
    if sums_inputs then
      load(p, word_in_size);
      put(p, number(s.reply_max - 4), if_above, too_long);
    end if;
    point(p, exchange_base(s), loaded(word_counts) or act(do_point_other));
    put(p, act(do_pointer) or store(store_data, 0) or act(do_point_up));
    load(p, word_out_size);
    put(p, act(do_pointer) or store(store_data, 0) or act(do_point_up));
    at(p, define_entries);
    put(p, act(if_not), if_some_left, write_ok);
    if s.address_bytes = 4 then
      take_bytes(p, 4);
      put(p, act(do_pointer) or store(store_data, 0) or act(do_point_up));
      take_bytes(p, 1);
    else
      take_bytes(p, s.address_bytes + 1);
    end if;
    -- The number of bytes is rotated to the top.
    put(p, data(data_turn) or times(3) or act(do_pointer) or store(store_data, 0) or act(do_point_up) or
           act(do_count));
    go_to(p, define_entries);
  end procedure;

  procedure exchange(p : inout assembler_t; s : frame_settings_t) is

    procedure next_member is
      constant looks : frame_instruction_t := act(do_pointer) or act(do_point_up) or times(3);
    begin
      if s.address_bytes = 4 then
        put(p, act(do_load_address) or looks);
        put(p, also(load_size) or act(do_count) or looks);
      else
        put(p, act(do_load_address) or also(load_size) or act(do_count) or looks);
      end if;
    end procedure;
  begin
    at_form(p, request_kind_exchange_c);
    put(p, take(take_skip), if_missing, invalid);
    go_to(p, places);

    at_check(p, request_kind_exchange_c);
    put(p, take(take_first));
    put(p, also(load_group, s.exchanges - 1), if_above, no_group);
    point(p, exchange_base(s), act(do_point_other));
    put(p, data(data_word) or act(do_pointer) or act(do_point_up) or times(3));
    put(p, store(store_data, word_counts));
    put(p, data(data_word) or act(do_pointer) or act(do_point_up) or times(3));
    put(p, nothing_done, if_top, exchange_defined);
    go_to(p, no_group);
    at(p, exchange_defined);
    put(p, nothing_done, if_left_other, invalid);
    put(p, number(mark_repeated), if_mark, exchange_go);
    if s.deadman then
      put(p, number(flag_tripped), if_flag, exchange_tripped);
    end if;
    at(p, exchange_go);
    call(p, counted);
    load(p, word_counts, also(hold_bus));
    put(p, data(data_turn) or also(load_count) or times(4));  -- the fourth byte
    at(p, exchange_outputs);
    put(p, nothing_done, if_some_left, exchange_out);
    load(p, word_counts);
    put(p, also(load_count));
    at(p, exchange_inputs);
    put(p, nothing_done, if_some_left, exchange_in);
    go_to(p, finish_ok);

    at(p, exchange_out);
    next_member;
    put(p, take(take_first) or for_size(times_size) or act(do_write) or number(mark_repeated),
        if_mark, exchange_outputs);
    put(p, act(do_await), if_failed, failed);
    go_to(p, exchange_outputs);

    at(p, exchange_in);
    next_member;
    p.code(p.last)(do_read) := '1';
    put(p, act(do_await) or data(data_turn) or for_size(times_rest), if_failed, failed);
    put(p, say(say_kept, from_top) or for_size(times_size));
    go_to(p, exchange_inputs);

    if s.deadman then
      at(p, exchange_tripped);
      put(p, number(0), if_low, exchange_go);  -- no outputs
      go_to(p, denied);
    end if;
  end procedure;

  procedure exchanges(p : inout assembler_t; s : frame_settings_t) is
  begin
    define_exchange(p, s);
    exchange(p, s);
  end procedure;

  procedure define_group(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_form(p, request_kind_define_group_c);
    put(p, take(take_skip), if_missing, invalid);
    put(p, take(take_skip) or times(4), if_missing, invalid);
    put(p, take(take_first), if_missing, invalid);
    put(p, number(frame_event_flag_c), if_above, invalid);
    put(p, take(take_first), if_missing, invalid);
    put(p, also(load_count));
    at(p, group_words);
    put(p, act(if_not), if_some_left, form_end);
    put(p, take(take_skip) or times(s.address_bytes) or act(do_count), if_missing, invalid);
    go_to(p, group_words);

    at_check(p, request_kind_define_group_c);
    put(p, take(take_first) or number(mark_repeated), if_mark, invalid);
    put(p, number(mark_executing), if_mark, group_go);
    put(p, also(load_group, s.groups - 1), if_above, no_group);
    if s.rate_bytes < 4 then
      take_bytes(p, 4 - s.rate_bytes);
      put(p, number(0), if_above, invalid);  -- a divisor that does not fit the generic
      put(p, take(take_skip) or times(s.rate_bytes + 1));
    else
      put(p, take(take_skip) or times(4));
      put(p, take(take_skip));
    end if;
    put(p, take(take_first));
    put(p, number(s.group_size), if_above, no_group);
    if s.group_size > (s.reply_max - 7) / s.data_bytes then
      put(p, number((s.reply_max - 7) / s.data_bytes), if_above, too_long);
    end if;
    put(p, also(set_marks, mark_executing));
    go_to(p, skip_check);
    at(p, group_go);
    put(p, take(take_first) or times(4) or manage(manage_empty));
    put(p, manage(manage_rate) or take(take_first));
    put(p, manage(manage_event) or take(take_first));
    put(p, manage(manage_word) or also(load_count));  -- at place 0
    put(p, nothing_done, if_some_left, group_store);
    go_to(p, group_end);
    at(p, group_store);
    take_bytes(p, s.address_bytes);
    put(p, manage(manage_word) or act(do_count));
    put(p, act(if_not), if_some_left, group_filled);
    go_to(p, group_store);
    at(p, group_filled);
    put(p, manage(manage_fill));
    at(p, group_end);
    point(p, sequence_base(s), loaded(word_zero) or act(do_point_group));
    put(p, act(do_pointer) or store(store_data, 0));
    go_to(p, write_ok);
  end procedure;

  procedure publish(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_entry(p, entry_publish);
    -- The number of its addresses, because `count` is 0.
    put(p, manage(manage_take) or also(hold_bus) or data(data_group));
    point(p, sequence_base(s), also(load_count) or data(data_clock) or act(do_point_group));
    put(p, say(say_byte, from_other) or act(do_pointer));
    put(p, say(say_byte, from_half) or act(do_pointer) or times(2));
    put(p, say(say_byte, from_top) or times(4));
    at(p, publish_word);
    put(p, act(do_find_address) or act(do_read) or act(do_count));
    put(p, act(do_await), if_failed, publish_failed);
    put(p, say(say_byte, from_word) or times(s.data_bytes) or act(if_not), if_some_left, publish_end);
    go_to(p, publish_word);
    at(p, publish_end);
    put(p, act(do_pointer) or store(store_next, 0) or times(2));
    bump(p, control_publishes_c);
    put(p, say(say_last) or number(device_kind_publish_c));
    go_to(p, next_work);

    at(p, publish_failed);
    put(p, say(say_again));
    go_to(p, next_work);
  end procedure;

  procedure publishes(p : inout assembler_t; s : frame_settings_t) is
  begin
    define_group(p, s);
    publish(p, s);
  end procedure;

end package body;
