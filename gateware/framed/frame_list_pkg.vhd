-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the framed application's program about lists: LIST and POST_LIST. A list is walked through twice, first to
-- check its form and to count its words, then to execute it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_list_pkg is

  procedure lists(p : inout assembler_t; s : frame_settings_t);

end package;

package body frame_list_pkg is

  -- An operation and the bytes of its next word, as far as to the access; from the first byte on.
  procedure operation(p : inout assembler_t; s : frame_settings_t) is
    constant most_reads : natural := (s.reply_max - 6) / s.data_bytes;
  begin
    at(p, list_op);
    put(p, take(take_first), if_missing, invalid);
    put(p, also(load_shape));
    put(p, number(shape_none), if_shape, invalid);
    put(p, number(shape_fifo), if_shape, list_fifo);
    at(p, list_count);
    put(p, take(take_first), if_missing, invalid);
    put(p, also(load_count, 0), if_low, invalid);
    put(p, number(mark_executing), if_mark, list_counted);
    put(p, number(shape_reads), if_shape, list_reads);
    put(p, also(set_marks, mark_writes));
    at(p, list_total);
    put(p, data(data_add) or number(word_total) or times(2));
    put(p, store(store_data, word_total));
    at(p, list_counted);
    put(p, number(shape_once), if_shape, list_once);
    at(p, list_word);
    put(p, take(take_address) or times(s.address_bytes), if_missing, invalid);
    at(p, list_value);
    put(p, number(shape_reads), if_shape, list_access);
    put(p, number(shape_mask), if_shape, list_mask);
    at(p, list_data);
    take_bytes(p, s.data_bytes, if_missing, invalid);
    at(p, list_access);
    put(p, number(mark_executing), if_mark, run);
    at(p, list_next);
    put(p, act(do_count));
    put(p, number(shape_once), if_shape, list_again);
    put(p, nothing_done, if_some_left, list_word);
    at(p, list_more);
    put(p, number(0), if_left_not, list_op);
    put(p, number(mark_executing), if_mark, list_executed);
    put(p, number(mark_posting), if_mark, post_formed);
    go_to(p, places);

    at(p, list_again);
    put(p, nothing_done, if_some_left, list_value);
    go_to(p, list_more);
    at(p, list_fifo);
    put(p, also(set_marks, mark_fifo));
    go_to(p, list_count);
    at(p, list_once);
    put(p, take(take_address) or times(s.address_bytes), if_missing, invalid);
    put(p, number(mark_executing), if_mark, list_value);
    put(p, number(shape_reads), if_shape, list_more);  -- no byte more to look at
    go_to(p, list_value);
    at(p, list_mask);
    take_bytes(p, s.data_bytes, if_missing, invalid);
    put(p, store(store_data, word_mask));
    go_to(p, list_data);

    at(p, list_reads);
    put(p, number(mark_posting), if_mark, invalid);
    put(p, store(store_data, word_operand));
    put(p, data(data_add) or number(word_reads) or times(2));
    put(p, number(most_reads), if_above, list_many);
    put(p, store(store_data, word_reads));
    at(p, list_back);
    load(p, word_operand);
    go_to(p, list_total);
    at(p, list_many);
    put(p, also(set_marks, mark_many));
    go_to(p, list_back);
  end procedure;

  -- Executes one word: the value is in `data`.
  procedure access_word(p : inout assembler_t; s : frame_settings_t) is

    procedure count_done is
    begin
      put(p, store(store_next, word_done) or times(2));
    end procedure;
  begin
    at(p, run);
    put(p, number(shape_reads), if_shape, run_read);
    put(p, number(mark_repeated), if_mark, run_skip);
    put(p, number(shape_mask), if_shape, run_masked);
    put(p, number(shape_add), if_shape, run_add);
    put(p, act(do_write));
    count_done;
    at(p, run_await);
    put(p, act(do_await), if_failed, list_failed);
    at(p, run_next);
    put(p, number(shape_up), if_shape, run_up);
    go_to(p, list_next);
    at(p, run_up);
    put(p, also(address_up));
    go_to(p, list_next);
    at(p, run_skip);
    count_done;
    go_to(p, run_next);
    at(p, run_read);
    put(p, act(do_read));
    count_done;
    put(p, act(do_await), if_failed, list_failed);
    put(p, say(say_kept, from_word) or times(s.data_bytes));
    go_to(p, run_next);
    at(p, run_masked);
    put(p, data(data_and) or number(word_mask) or times(2));
    put(p, store(store_data, word_operand));
    put(p, act(do_read));
    count_done;
    put(p, act(do_await), if_failed, list_failed);
    put(p, data(data_and_not) or number(word_mask) or times(2));
    at(p, run_again);
    put(p, data(data_add) or number(word_operand) or times(2));
    put(p, act(do_write));
    go_to(p, run_await);
    at(p, run_add);
    put(p, store(store_data, word_operand));
    put(p, act(do_read));
    count_done;
    put(p, act(do_await), if_failed, list_failed);
    go_to(p, run_again);

    at(p, list_executed);
    put(p, number(mark_posting), if_mark, post_end);
    go_to(p, finish_ok);
    at(p, post_end);
    put(p, store(store_next, word_posts) or times(2) or act(do_done));
    go_to(p, next_work);

    at(p, list_failed);
    put(p, number(mark_posting), if_mark, list_unposted);
    call(p, count_failure, say(say_again));
    put(p, say(say_kind, from_other) or number(status_of_data));
    put(p, store(store_data, word_answer));
    call(p, head);
    put(p, number(word_done));
    say_half(p, say_kept, word_done);
    load(p, word_answer);
    put(p, number(mark_repeated), if_mark, end_plain);
    go_to(p, end_failed);
    at(p, list_unposted);
    put(p, store(store_next, word_posts) or times(2));
    go_to(p, post_failed);
  end procedure;

  procedure lists(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_form(p, request_kind_list_c);
    put(p, take(take_first), if_missing, invalid);
    put(p, number(frame_atomic_flag_c), if_above, invalid);
    at(p, list_start);
    load(p, word_zero);
    put(p, store(store_data, word_total));
    put(p, store(store_data, word_reads));
    load(p, word_ones);
    put(p, store(store_data, word_done));
    operation(p, s);
    access_word(p, s);

    at_entry(p, request_kind_post_list_c mod 16);
    put(p, also(set_marks, mark_posting));
    put(p, take(take_skip) or times(2), if_missing, drop_kind);
    go_to(p, list_start);
    at(p, post_formed);
    put(p, act(do_rewind));
    put(p, take(take_first) or times(2) or number(word_posts));
    put(p, number(word_posts), if_half_not, post_other);
    if s.deadman then
      put(p, number(flag_tripped), if_flag, post_denied);
    end if;
    bump(p, control_posts_c);
    at(p, list_execute);
    put(p, also(set_marks, mark_executing));
    go_to(p, list_op);

    at_check(p, request_kind_list_c);
    put(p, take(take_first));
    put(p, number(0), if_low, list_plain);
    put(p, also(hold_bus));
    at(p, list_plain);
    put(p, number(mark_repeated), if_mark, list_say);
    if s.deadman then
      put(p, number(flag_tripped), if_flag, list_tripped);
    end if;
    at(p, list_free);
    put(p, number(mark_many), if_mark, too_long);
    put(p, number(mark_fifo), if_mark, list_has_fifo);
    at(p, list_ok);
    bump(p, control_frames_c);
    at(p, list_say);
    call(p, head);
    put(p, number(word_total));
    say_half(p, say_kept, word_total);
    go_to(p, list_execute);
    at(p, list_has_fifo);
    load(p, word_reads);
    put(p, number((s.cache_bytes - 2) / s.data_bytes), if_above, too_long);
    go_to(p, list_ok);
    if s.deadman then
      at(p, list_tripped);
      put(p, number(mark_writes), if_mark, denied);
      go_to(p, list_free);
    end if;
  end procedure;

end package body;
