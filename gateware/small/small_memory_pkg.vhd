-- SPDX-License-Identifier: BSD-3-Clause
--
-- What the data memory of framed_small has at power-up: the description of the device, and what the program needs to
-- know of the settings. small_program_pkg has the addresses.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.small_program_pkg.all;

package small_memory_pkg is

  type small_memory_t is array (natural range <>) of byte_t;

  -- Bytes of the memory: publishing needs twice as many.
  function memory_size(settings : settings_t) return positive;

  -- The settings of the framed protocol with the sizes of this engine.
  function small_settings_of(settings : settings_t) return frame_settings_t;

  -- The most words of a group: its record has room for them, and so has a publish.
  function group_size_most(s : frame_settings_t) return natural;

  function memory_content(settings : settings_t) return small_memory_t;

end package;

package body small_memory_pkg is

  function small_settings_of(settings : settings_t) return frame_settings_t is
    variable s : frame_settings_t := frame_settings_of(settings);
  begin
    s.request_max := small_request_max;
    s.reply_max   := small_reply_max;
    s.credit      := small_credit;
    s.cache_bytes := small_cache_bytes;
    return s;
  end function;

  function memory_size(settings : settings_t) return positive is
  begin
    if settings.publish_mode > 0 then
      return 1024;
    end if;
    return 512;
  end function;

  function group_size_most(s : frame_settings_t) return natural is
  begin
    return minimum(small_address_bytes_max / s.address_bytes, (small_reply_max - 7) / s.data_bytes);
  end function;

  function memory_content(settings : settings_t) return small_memory_t is
    constant s        : frame_settings_t := small_settings_of(settings);
    constant words    : word_memory_t := memory_content(s);
    variable content  : small_memory_t(0 to memory_size(settings) - 1) := (others => (others => '0'));

    procedure set(place : natural; value : natural) is
    begin
      content(place) := byte_t(to_unsigned(value, 8));
    end procedure;
  begin
    for number in control_magic_c to control_spec_hash_low_c loop
      for index in 0 to 3 loop
        content(small_description + 4 * number + index) := words(number)(31 - 8 * index downto 24 - 8 * index);
      end loop;
    end loop;
    set(small_a_bytes, s.address_bytes);
    set(small_d_bytes, s.data_bytes);
    set(small_window, s.window);
    set(small_window_mask, s.window - 1);
    set(small_post_size, 8 + s.address_bytes + s.data_bytes);
    set(small_write_bytes, s.address_bytes + s.data_bytes);
    if s.groups > 0 then
      set(small_last_group, small_group_bytes * (s.groups - 1));
      for g in 0 to minimum(s.groups, small_groups_max) - 1 loop
        set(small_groups + small_group_bytes * g, 2 ** g);  -- its bit
      end loop;
    end if;
    return content;
  end function;

end package body;
