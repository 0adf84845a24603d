-- SPDX-License-Identifier: BSD-3-Clause
--
-- The framed application's program: what it does for every frame, tick and publish (docs/protocol.md). Sessions, ids
-- and single words are here. frame_post_pkg has posts, frame_state_pkg the device itself, frame_list_pkg lists, and
-- frame_group_pkg both kinds of groups.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_group_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_pkg.all;
use work.frame_pkg.all;
use work.frame_post_pkg.all;
use work.frame_state_pkg.all;
use work.frame_timing_pkg.all;
use work.protocol_pkg.all;

package frame_program_pkg is

  -- The program. Its length is a power of two, at most 512.
  function frame_program_for(s : frame_settings_t) return frame_program_t;

end package;

package body frame_program_pkg is

  -- Power-up, reset, and endings that several routines share.
  procedure common(p : inout assembler_t; s : frame_settings_t) is

    procedure refuse(label_name : label_t; status : natural) is
    begin
      at(p, label_name);
      call(p, counted, say(say_kind) or number(device_kind_reply_c + status));
      go_to(p, end_plain);
    end procedure;

    procedure drop(counter : natural) is
    begin
      bump(p, counter, act(do_done));
      go_to(p, next_work);
    end procedure;
  begin
    point(p, control_frames_c, loaded(word_zero));
    at(p, clear_next);
    put(p, act(do_pointer) or store(store_data, word_barrier + 1) or act(do_point_up), if_pointer, cleared);
    go_to(p, clear_next);
    at(p, cleared);
    load(p, word_ones);
    put(p, store(store_data, word_session));
    go_to(p, next_work);

    at(p, write_ok);  -- nothing was sent, and nothing is to be sent
    call(p, answer);
    at(p, end_ok);
    put(p, say(say_end) or act(do_place) or number(reply_status_ok_c) or act(do_done));
    go_to(p, next_work);
    at(p, tail_ok);
    call(p, head);
    go_to(p, end_ok);
    at(p, end_plain);
    put(p, say(say_end) or act(do_done));
    go_to(p, next_work);
    at(p, end_counted);
    bump(p, control_frames_c);
    go_to(p, end_plain);
    at(p, answer);
    put(p, say(say_kind) or number(device_kind_reply_c));
    at(p, counted);
    put(p, number(mark_repeated), if_mark, head);  -- it was counted before
    bump(p, control_frames_c);
    at(p, head);
    say_head(p);
    p.code(p.last) := p.code(p.last) or act(do_return);
    at(p, finish_ok);  -- only the end is still to be sent
    put(p, say(say_last) or number(device_kind_reply_c) or act(do_place) or act(do_done));
    go_to(p, next_work);
    at(p, failed);
    call(p, count_failure, say(say_again));
    call(p, head, say(say_kind, from_other) or number(status_of_data));
    if s.lists then
      put(p, number(mark_executing), if_mark, list_done);
    end if;
    at(p, end_failed);
    put(p, say(say_end) or act(do_place) or number(status_of_data) or act(do_done));
    go_to(p, next_work);
    at(p, count_failure);  -- and load its status into `data`
    if s.deadman then
      put(p, nothing_done, if_denied, count_denial);
    end if;
    bump(p, control_bus_errors_c, also(by_silence, control_bus_errors_c));
    at(p, load_failure);
    load(p, word_one, also(by_silence, word_one) or act(do_return));
    if s.deadman then
      at(p, count_denial);  -- a list or group was executed in part
      bump(p, control_refused_c);
      go_to(p, load_failure);
    end if;

    at(p, denied);
    bump(p, control_refused_c);
    refuse(denied_too, reply_status_denied_c);
    refuse(bad_address, reply_status_bad_address_c);
    refuse(too_long, reply_status_too_long_c);
    refuse(order, reply_status_order_c);
    refuse(behind, reply_status_behind_c);
    refuse(no_group, reply_status_no_group_c);
    at(p, invalid);
    put(p, number(mark_posting), if_mark, drop_kind);
    refuse(invalid_too, reply_status_invalid_c);

    at(p, drop_stale);
    drop(control_discarded_stale_c);
    at_entry(p, entry_kind);
    p.labels(drop_kind) := p.here;
    drop(control_discarded_kind_c);
    at_entry(p, entry_check);
    drop(control_discarded_check_c);
    at_entry(p, entry_long);
    drop(control_discarded_long_c);
    at_entry(p, entry_session);
    bump(p, control_discarded_session_c);
    put(p, number(flag_untold), if_flag, tell_closed);
    at(p, drop_done);
    put(p, act(do_done));
    go_to(p, next_work);
    at(p, tell_closed);
    put(p, also(clear_flags, flag_untold));
    put(p, say(say_last) or number(device_kind_closed_c) or act(do_done));
    go_to(p, next_work);

    at_entry(p, entry_half_turn);
    put(p, nothing_done, if_half_turn, turn_down);
    put(p, also(half_turn));
    go_to(p, next_work);
    at(p, turn_down);
    put(p, store(store_next, word_high) or also(half_turn, word_high) or times(2));
    go_to(p, next_work);
    at_entry(p, entry_receive_overrun);
    bump(p, control_receive_overruns_c);
    go_to(p, next_work);
    if s.groups > 0 then
      at_entry(p, entry_publish_overrun);
      bump(p, control_publish_overruns_c);
      go_to(p, next_work);
    end if;
  end procedure;

  -- HELLO, OPEN, CLOSE.
  procedure sessions(p : inout assembler_t; s : frame_settings_t) is

    -- `data` is nonce and epoch of the new session, or all ones.
    procedure begin_session is
    begin
      at(p, session_begins);
      put(p, also(load_epoch) or store(store_data, word_session));
      put(p, data(data_turn) or times(2) or store(store_data, word_own_nonce));
      load(p, word_upper);
      put(p, store(store_data, word_failed));
      point(p, control_deadman_ticks_c, loaded(word_zero) or manage(manage_clear));
      at(p, begin_next);
      put(p, act(do_pointer) or store(store_data, word_posts + 1) or act(do_point_up), if_pointer, begin_rest);
      go_to(p, begin_next);
      at(p, begin_rest);
      for index in 0 to s.exchanges - 1 loop
        if index = 0 then
          point(p, exchange_base(s) + 1);
        end if;
        put(p, act(do_pointer) or store(store_data, 0));
        if index < s.exchanges - 1 then
          also_point(p, exchange_base(s) + (index + 1) * exchange_stride(s) + 1);
        end if;
      end loop;
      if s.exchanges > 0 then
        also_point(p, 0);
      else
        point(p, 0);
      end if;
      at(p, forget_next);
      put(p, also(forget_place, no_status) or act(do_point_up));
      put(p, number(s.window), if_pointer, forgotten);
      go_to(p, forget_next);
      at(p, forgotten);
      put(p, also(clear_flags, flag_running + flag_publishing + flag_tripped_now + flag_failed) or act(do_return));
    end procedure;
  begin
    at_entry(p, entry_hello);
    put(p, take(take_first) or number(2), if_left_not, drop_kind);
    put(p, say(say_kind) or number(device_kind_hello_c));
    put(p, take(take_first) or number(frame_version_c), if_above, hello_none);
    put(p, number(0), if_low, hello_none);
    put(p, say(say_byte) or number(frame_version_c));
    go_to(p, hello_more);
    at(p, hello_none);
    put(p, say(say_byte) or number(0));
    at(p, hello_more);
    put(p, store(store_next, word_nonce) or times(2));
    put(p, also(set_flags, flag_offered + flag_untold));  -- until the nonce is stored
    find_half(p, say_byte, word_nonce);
    find_half(p, say_byte, word_session);
    also_point(p, word_hello);
    at(p, hello_next);
    put(p, data(data_word) or act(do_pointer) or times(3));
    put(p, say(say_byte, from_top) or times(4) or act(do_point_up) or number(word_hello + hello_words - 1),
        if_pointer, end_counted);
    go_to(p, hello_next);

    at_entry(p, entry_open);
    put(p, take(take_first) or times(3) or number(5), if_left_not, drop_kind);
    put(p, number(16#FF#), if_low, drop_stale);  -- an epoch never begins with FF
    put(p, take(take_data) or store(store_data, word_operand));
    put(p, number(word_session));
    put(p, data(data_turn), if_half_not, open_new);
    put(p, data(data_turn) or number(word_own_nonce));
    put(p, nothing_done, if_half_not, open_new);
    go_to(p, open_answer);
    at(p, open_new);
    put(p, number(flag_offered), if_flag, open_offered);
    go_to(p, drop_stale);
    at(p, open_offered);
    load(p, word_operand);
    put(p, data(data_turn) or number(word_nonce) or times(2));
    put(p, take(take_first), if_half_not, drop_stale);
    put(p, number(0) or act(if_not), if_low, drop_stale);  -- a flag is set
    if s.deadman then
      put(p, also(set_flags, flag_tripped));  -- works if it runs
    end if;
    at(p, open_begin);
    put(p, also(clear_flags, flag_offered), if_busy, open_begin);
    call(p, session_begins, loaded(word_operand));
    at(p, open_answer);
    put(p, say(say_kind) or number(device_kind_open_c));
    find_half(p, say_byte, word_session);
    put(p, data(data_clock));
    put(p, say(say_byte, from_top) or times(4));
    go_to(p, end_counted);

    at_check(p, request_kind_close_c);
    put(p, number(mark_repeated), if_mark, invalid);
    call(p, answer);
    put(p, say(say_end));
    at(p, close_wait);
    put(p, nothing_done, if_busy, close_wait);  -- the answer is sent in the epoch that ends
    call(p, session_begins, loaded(word_ones));
    go_to(p, drop_done);
    begin_session;
  end procedure;

  -- Form, place, chained, barrier; READ, WRITE, SYNC.
  procedure requests(p : inout assembler_t; s : frame_settings_t) is

    procedure exact(kind : natural; bytes : natural) is
    begin
      at_form(p, kind);
      put(p, number(bytes), if_left_not, invalid);
      go_to(p, places);
    end procedure;
  begin
    at_entry(p, entry_unknown);  -- and all others that frame_dispatcher has no place for
    p.labels(general) := p.here;
    put(p, act(do_rewind));
    go_to(p, general_taken);
    for operation in 2 to entry_unknown loop  -- replaced below for the known operations
      if operation /= request_kind_post_c mod 16 and operation /= request_kind_post_list_c mod 16 then
        at_form(p, operation);
        put(p, nothing_done);
        go_to(p, invalid);
      end if;
    end loop;
    if not s.lists then
      at_entry(p, request_kind_post_list_c mod 16);
      put(p, nothing_done);
      go_to(p, drop_kind);
    end if;

    at_entry(p, request_kind_read_c mod 16);
    put(p, take(take_id) or times(2) or number(2 + s.address_bytes), if_not_plain, general);
    at(p, exec_read);
    put(p, take(take_address) or times(s.address_bytes));
    put(p, store(store_count, control_frames_c) or times(2) or act(do_read), if_not_new, not_new);
    put(p, act(do_await) or say(say_kind) or number(device_kind_reply_c), if_failed, failed);
    say_head(p);
    put(p, say(say_kept, from_word) or times(s.data_bytes));
    go_to(p, end_ok);

    at_entry(p, request_kind_write_c mod 16);
    put(p, take(take_id) or times(2) or number(2 + s.address_bytes + s.data_bytes), if_not_plain, general);
    at(p, exec_write);
    put(p, take(take_address) or times(s.address_bytes));
    put(p, take(take_data) or times(s.data_bytes) or act(do_write), if_not_new, not_new);
    bump(p, control_frames_c);
    put(p, act(do_await) or say(say_kind) or number(device_kind_reply_c), if_failed, write_failed);
    go_to(p, tail_ok);
    at(p, write_failed);
    put(p, nothing_done, if_denied, write_denied);
    go_to(p, failed);
    at(p, write_denied);  -- the dead-man tripped before the write reached the bus
    bump(p, control_refused_c, say(say_again));
    call(p, head, say(say_kind) or number(device_kind_reply_c + reply_status_denied_c));  -- it was counted before
    go_to(p, end_plain);

    at(p, general_taken);
    put(p, take(take_id) or times(2), if_missing, drop_kind);
    put(p, nothing_done, if_barrier, take_barrier);
    at(p, form_dispatch);
    put(p, act(do_dispatch));
    p.code(p.last)(following_f) := std_ulogic_vector(to_unsigned(first_of_forms, 9));
    at(p, take_barrier);
    put(p, take(take_first) or times(2) or store(store_data, word_barrier), if_missing, invalid);
    go_to(p, form_dispatch);

    exact(request_kind_read_c, s.address_bytes);
    exact(request_kind_write_c, s.address_bytes + s.data_bytes);
    exact(request_kind_write_control_c, 6);
    exact(request_kind_sync_c, 0);
    exact(request_kind_close_c, 0);

    at(p, form_end);
    put(p, number(0), if_left_not, invalid);
    at(p, places);
    put(p, nothing_done, if_not_new, not_new);
    put(p, nothing_done, if_chained, check_order);
    at(p, past_order);
    put(p, nothing_done, if_barrier, check_barrier);
    at(p, skip_check);
    put(p, act(do_rewind));
    put(p, take(take_skip) or times(2), if_barrier, skip_barrier);
    at(p, check_dispatch);
    put(p, act(do_dispatch));
    p.code(p.last)(following_f) := std_ulogic_vector(to_unsigned(first_of_checks, 9));
    at(p, skip_barrier);
    put(p, take(take_skip) or times(2));
    go_to(p, check_dispatch);
    at(p, check_order);
    put(p, act(do_before));
    put(p, nothing_done, if_order, order);
    go_to(p, past_order);
    at(p, check_barrier);
    load(p, word_barrier);
    put(p, number(word_posts));
    put(p, nothing_done, if_half_not, behind);
    go_to(p, skip_check);

    at(p, not_new);
    put(p, also(load_kept), if_duplicate, duplicate);
    go_to(p, drop_stale);
    at(p, duplicate);
    bump(p, control_duplicates_c);
    put(p, nothing_done, if_not_kept, repeat);
    call(p, head, say(say_kind, from_other));
    at(p, duplicate_next);
    put(p, act(if_not), if_some_left, end_plain);
    put(p, say(say_byte, from_cache) or act(do_count));
    go_to(p, duplicate_next);
    -- For LIST, EXCHANGE or READ_CONTROL. Otherwise the id belongs to another request, and this one is invalid.
    at(p, repeat);
    put(p, also(set_marks, mark_repeated));
    go_to(p, skip_check);

    at_check(p, request_kind_read_c);
    put(p, number(mark_repeated), if_mark, invalid);
    go_to(p, exec_read);
    at_check(p, request_kind_write_c);
    put(p, number(mark_repeated), if_mark, invalid);
    go_to(p, exec_write);

    at_check(p, request_kind_sync_c);
    put(p, number(mark_repeated), if_mark, invalid);
    call(p, answer);
    say_half(p, say_kept, word_posts);
    find_half(p, say_kept, word_failed);
    find_half(p, say_kept, word_first);
    load(p, word_status);
    put(p, say(say_kept, from_top));
    go_to(p, end_ok);
  end procedure;

  function frame_program_for(s : frame_settings_t) return frame_program_t is
    variable p    : assembler_t := assembler_empty;
    variable size : positive    := 128;
  begin
    for pass in 1 to 3 loop
      next_pass(p);
      common(p, s);
      sessions(p, s);
      requests(p, s);
      posts(p, s);
      registers(p, s);
      if s.lists then
        lists(p, s);
      end if;
      if s.exchanges > 0 then
        exchanges(p, s);
      end if;
      if s.groups > 0 then
        publishes(p, s);
      end if;
    end loop;
    check_timing(p);
    while size < p.free loop
      size := 2 * size;
    end loop;

    return p.code(0 to size - 1);
  end function;

end package body;
