-- SPDX-License-Identifier: BSD-3-Clause
--
-- The part of the framed application's program for the device itself: control registers, time, dead-man.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_state_pkg is

  -- READ_CONTROL, WRITE_CONTROL, and the record of a trip.
  procedure registers(p : inout assembler_t; s : frame_settings_t);

end package;

package body frame_state_pkg is

  procedure read_control(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_form(p, request_kind_read_control_c);
    put(p, take(take_skip) or times(2) or number(3), if_left_not, invalid);
    put(p, take(take_first));
    put(p, number(0), if_low, invalid);
    go_to(p, places);

    at_check(p, request_kind_read_control_c);
    put(p, take(take_first) or times(2));
    put(p, take(take_data) or act(do_point_data) or number(16#FF#), if_above, bad_address);
    put(p, also(load_count));
    at(p, registers_next);
    put(p, act(do_point_up) or act(do_count), if_no_register, bad_address);
    put(p, nothing_done, if_some_left, registers_next);
    put(p, data(data_turn) or act(do_point_data) or times(4));  -- address and count are still in `data`
    call(p, answer, also(load_count));
    at(p, registers_word);
    put(p, number(control_time_low_c) or data(data_clock), if_pointer, registers_time);
    put(p, number(control_arm_c) or data(data_flags), if_pointer, registers_say);
    put(p, data(data_word) or act(do_pointer) or times(3));
    at(p, registers_say);
    put(p, say(say_kept, from_top) or times(4) or act(do_count) or act(do_point_up));
    at(p, registers_said);
    put(p, nothing_done, if_some_left, registers_word);
    go_to(p, end_ok);

    -- Counts a turn of the clock that nobody has looked at yet.
    at(p, registers_time);
    put(p, nothing_done, if_half_turn, registers_turn);
    at(p, registers_high);
    put(p, say(say_kept, from_top) or times(4) or act(do_count) or act(do_point_up));
    load(p, word_high);
    put(p, store(store_data, control_time_high_c));
    go_to(p, registers_said);
    at(p, registers_turn);
    put(p, nothing_done, if_top, registers_high);
    put(p, store(store_next, word_high) or also(half_turn, word_high) or times(2));
    go_to(p, registers_high);
  end procedure;

  procedure write_control(p : inout assembler_t; s : frame_settings_t) is
  begin
    at_check(p, request_kind_write_control_c);
    put(p, take(take_first) or times(2) or number(mark_repeated), if_mark, invalid);
    put(p, number(16#FF#) or act(do_point_data), if_above, bad_address);
    if s.groups > 0 then
      take_bytes(p, 4, if_pointer, write_publish);
      p.code(p.last)(number_f) := byte_t(to_unsigned(control_publish_c, 8));
    else
      take_bytes(p, 4);
    end if;
    if s.deadman then
      put(p, number(control_arm_c), if_pointer, write_arm);
      put(p, number(control_deadman_ticks_c), if_pointer, write_ticks);
    end if;
    go_to(p, bad_address);

    if s.groups > 0 then
      at(p, write_publish);
      put(p, number(1), if_above, invalid);
      put(p, manage(manage_publish) or store(store_data, control_publish_c));
      go_to(p, write_ok);
    end if;

    if s.deadman then
      at(p, write_arm);
      put(p, number(1), if_above, invalid);
      put(p, number(0), if_low, invalid);
      put(p, number(flag_tripped_now), if_flag, denied);
      put(p, also(clear_flags, flag_tripped));
        go_to(p, write_ok);

      at(p, write_ticks);
      put(p, also(start_dead_man) or number(flag_tripped), if_flag, denied);
      put(p, store(store_data, control_deadman_ticks_c));
        go_to(p, write_ok);
    end if;
  end procedure;

  procedure registers(p : inout assembler_t; s : frame_settings_t) is
  begin
    read_control(p, s);
    write_control(p, s);
    if s.deadman then
      at_entry(p, entry_trip);
      load(p, word_zero);
      put(p, store(store_data, control_deadman_ticks_c));
      bump(p, control_deadman_trips_c);
      go_to(p, next_work);
    end if;
  end procedure;

end package body;
