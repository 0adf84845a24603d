-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the framed application's program for lists: LIST and POST_LIST. It goes through a list twice. The first
-- time it checks the form and counts the words, and the second time it executes the list.

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

  -- Reads an operation up to its count. Then it skips the bytes of the operation if it only checks the form, or if the
  -- list was executed before.
  procedure operation(p : inout assembler_t; s : frame_settings_t) is
  begin
    at(p, list_op);
    put(p, take(take_first), if_missing, invalid);
    put(p, also(load_shape) or take(take_first), if_missing, invalid);
    put(p, also(load_count, shape_none), if_shape, invalid);
    put(p, number(0), if_low, invalid);
    put(p, number(mark_executing), if_mark, run);
    put(p, number(shape_reads), if_shape, list_reads);
    put(p, data(data_add) or store(store_data, word_writes) or times(3));
    at(p, list_pass);
    put(p, number(shape_once), if_shape, list_once);
    put(p, take(take_many) or times(s.address_bytes), if_missing, invalid);
    at(p, list_values);
    put(p, number(shape_reads), if_shape, list_more);
    put(p, take(take_many) or times(s.data_bytes), if_missing, invalid);
    put(p, number(shape_mask), if_shape, list_masks);
    at(p, list_more);
    put(p, nothing_done, if_missing, list_passed);
    go_to(p, list_op);
    at(p, list_passed);
    put(p, number(mark_executing), if_mark, list_executed);
    put(p, number(mark_posting), if_mark, post_formed);
    go_to(p, places);
    at(p, list_masks);
    put(p, take(take_many) or times(s.data_bytes), if_missing, invalid);
    go_to(p, list_more);
    at(p, list_once);
    put(p, take(take_skip) or times(s.address_bytes), if_missing, invalid);
    go_to(p, list_values);
    at(p, list_reads);
    put(p, number(mark_posting), if_mark, invalid);
    put(p, data(data_add) or store(store_data, word_reads) or times(3));
    go_to(p, list_pass);
  end procedure;

  -- Executes an operation. The count is also in `data`. A word counts as done once its access begins.
  procedure execute(p : inout assembler_t; s : frame_settings_t) is
    constant counted  : frame_instruction_t := act(do_count) or store(store_next, word_done);
    constant together : positive            := minimum(s.address_bytes, s.data_bytes);

    procedure await is
    begin
      put(p, act(do_await), if_failed, list_failed);
    end procedure;
  begin
    at(p, run);
    put(p, number(mark_repeated), if_mark, run_again);
    at(p, run_go);
    put(p, number(shape_once), if_shape, run_once);
    at(p, run_words);
    put(p, number(shape_reads), if_shape, run_reads);
    put(p, number(shape_mask + shape_add), if_shape, run_change);

    at(p, run_write);
    put(p, take(take_item) or times(s.address_bytes));
    put(p, take(take_data) or times(s.data_bytes) or act(do_write) or counted);
    put(p, act(do_await) or also(address_up), if_over, run_over);
    go_to(p, run_write);
    at(p, run_over);
    put(p, nothing_done, if_failed, list_failed);
    go_to(p, list_more);

    at(p, run_reads);
    put(p, take(take_item) or times(s.address_bytes) or act(do_read) or counted);
    at(p, run_read);
    await;
    if s.data_bytes > together then
      put(p, say(say_kept, from_word) or times(s.data_bytes - together) or also(address_up, word_done) or
             act(if_not), if_some_left, run_last);
    else
      put(p, also(address_up, word_done) or act(if_not), if_some_left, run_last);
    end if;
    -- Takes the address of the next word while the last bytes of this one are sent
    if s.address_bytes > together then
      put(p, take(take_item) or times(s.address_bytes - together) or number(word_done));
    end if;
    put(p, say(say_kept, from_word) or take(take_item) or times(together) or act(do_read) or counted);
    go_to(p, run_read);
    at(p, run_last);
    put(p, say(say_kept, from_word) or times(together));
    go_to(p, list_more);

    at(p, run_change);
    put(p, take(take_item) or times(s.address_bytes) or number(shape_mask), if_shape, run_mask);
    at(p, run_value);
    put(p, take(take_first) or times(s.data_bytes) or counted);
    put(p, number(shape_add), if_shape, run_operand);
    put(p, data(data_and) or number(word_mask) or times(3));
    at(p, run_operand);
    put(p, store(store_data, word_operand) or act(do_read));
    await;
    put(p, number(shape_add), if_shape, run_add);
    put(p, data(data_and_not) or number(word_mask) or times(3));
    at(p, run_add);
    put(p, data(data_add) or number(word_operand) or times(3) or act(do_write));
    await;
    put(p, nothing_done, if_some_left, run_change);
    go_to(p, list_more);
    at(p, run_mask);
    put(p, take(take_first) or times(s.data_bytes) or store(store_data, word_mask));
    go_to(p, run_value);

    at(p, run_once);
    put(p, take(take_address) or times(s.address_bytes));
    go_to(p, run_words);

    at(p, run_again);  -- nothing is written again
    put(p, number(shape_reads), if_shape, run_go);
    put(p, data(data_add) or store(store_data, word_done) or times(3));
    go_to(p, list_pass);

    at(p, list_executed);
    put(p, number(mark_posting), if_mark, post_end);
    go_to(p, finish_ok);
    at(p, post_end);
    put(p, store(store_next, word_posts) or times(2) or act(do_done));
    go_to(p, next_work);

    at(p, list_failed);
    put(p, number(mark_posting), if_mark, post_failed);
    go_to(p, failed);
    at(p, list_done);  -- the words that were done
    find_half(p, say_kept, word_done);
    go_to(p, end_failed);
  end procedure;

  procedure lists(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_form(p, request_kind_list_c);
    put(p, take(take_first), if_missing, invalid);
    put(p, number(frame_atomic_flag_c), if_above, invalid);
    at(p, list_start);
    load(p, word_zero);
    put(p, store(store_data, word_writes));
    put(p, store(store_data, word_reads));
    operation(p, s);
    execute(p, s);

    at_entry(p, request_kind_post_list_c mod 16);
    put(p, also(set_marks, mark_posting) or take(take_skip) or times(2), if_missing, drop_kind);
    go_to(p, list_start);
    at(p, post_formed);
    put(p, act(do_rewind));
    put(p, take(take_first) or times(2) or number(word_posts));
    put(p, nothing_done, if_half_not, post_other);
    bump(p, control_posts_c);
    if s.deadman then
      put(p, number(flag_tripped), if_flag, post_denied);
    end if;
    at(p, list_execute);
    load(p, word_ones);
    put(p, store(store_data, word_done));
    put(p, also(set_marks, mark_executing));
    go_to(p, list_op);

    at_check(p, request_kind_list_c);
    put(p, take(take_first));
    put(p, number(0), if_low, list_plain);
    put(p, also(hold_bus));
    at(p, list_plain);
    load(p, word_reads);
    if s.deadman then
      put(p, number(flag_tripped), if_flag, list_tripped);
    end if;
    at(p, list_free);
    put(p, number((s.reply_max - 6) / s.data_bytes), if_above, too_long);
    put(p, number(mark_fifo), if_mark, list_has_fifo);
    at(p, list_ok);
    put(p, data(data_add) or number(word_writes) or times(3));
    call(p, counted, store(store_data, word_total));
    find_half(p, say_kept, word_total);
    go_to(p, list_execute);
    at(p, list_has_fifo);
    put(p, number((s.cache_bytes - 2) / s.data_bytes), if_above, too_long);
    go_to(p, list_ok);
    if s.deadman then
      at(p, list_tripped);
      put(p, number(mark_repeated), if_mark, list_free);
      put(p, number(mark_writes), if_mark, denied);
      go_to(p, list_free);
    end if;
  end procedure;

end package body;
