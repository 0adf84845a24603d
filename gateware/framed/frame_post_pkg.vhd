-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the framed application's program for posts: POST, and the handling of failed posts.

library ieee;
  use ieee.std_logic_1164.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_post_pkg is

  procedure posts(p : inout assembler_t; s : frame_settings_t);

end package;

package body frame_post_pkg is

  procedure posts(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_entry(p, request_kind_post_c mod 16);
    put(p, take(take_first) or times(2) or number(2 + s.address_bytes + s.data_bytes), if_left_not, drop_kind);
    put(p, take(take_address) or times(s.address_bytes) or number(word_posts));
    put(p, take(take_data) or times(s.data_bytes) or act(do_write), if_half_not, post_other);
    bump(p, control_posts_c);
    put(p, act(do_await) or act(do_done) or store(store_next, word_posts) or times(2), if_failed, post_failed);
    go_to(p, next_work);

    at(p, post_other);
    put(p, act(do_rewind));
    put(p, take(take_first) or times(2) or number(word_posts));
    put(p, nothing_done, if_half_lower, post_old);
    bump(p, control_posts_ahead_c, act(do_done));
    go_to(p, next_work);
    at(p, post_old);
    bump(p, control_posts_old_c, act(do_done));
    go_to(p, next_work);

    at(p, post_denied);
    put(p, store(store_next, word_posts) or times(2));
    at(p, post_stopped);
    bump(p, control_refused_c);
    load(p, word_four);
    go_to(p, post_note);
    at(p, post_failed);
    put(p, store(store_next, word_posts) or times(2));
    if s.deadman then
      put(p, nothing_done, if_denied, post_stopped);  -- the dead-man has tripped meanwhile
    end if;
    call(p, count_failure);
    at(p, post_note);
    bump(p, control_post_errors_c);
    put(p, number(flag_failed), if_flag, post_noted);
    put(p, store(store_data, word_status));
    put(p, also(set_flags, flag_failed) or act(do_rewind));
    put(p, take(take_first) or times(2) or store(store_data, word_first));
    at(p, post_noted);
    bump(p, word_failed, act(do_done));
    go_to(p, next_work);
  end procedure;

end package body;
