-- SPDX-License-Identifier: BSD-3-Clause
--
-- The settings of the framed application, and the layout of its memory of 32-bit words.
--
--   0x00 description  0x20 counters  0x40 state: the control registers, at their own addresses (docs/protocol.md,
--   section 6)
--   0x45 the program's own words  0x60 constants  0x70 sequences of up to 16 groups
--   from 0x80: sequences of more groups, exchange groups; at most 1024 words

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.width_pkg.all;

package frame_layout_pkg is

  subtype word32_t is std_ulogic_vector(31 downto 0);

  -- An output that the dead-man sets, and its safe value.
  type safe_value_t is record
    address : word32_t;
    value   : word32_t;
  end record;
  type safe_values_t is array (natural range <>) of safe_value_t;
  constant no_safe_values : safe_values_t(1 to 0) := (others => (address => (others => '0'), value => (others => '0')));

  -- The settings of the core that decide its description and its kinds, and values that follow from them.
  type frame_settings_t is record
    address_width    : positive;
    data_width       : positive;
    address_bytes    : positive;  -- bytes that hold these bits
    data_bytes       : positive;
    clock_hz         : positive;
    base_hz          : positive;
    groups           : natural;   -- 0: no publishing
    group_size       : natural;
    rate_bytes       : positive;
    exchanges        : natural;   -- 0: no exchange groups
    exchange_size    : natural;
    window           : positive;
    cache_bytes      : positive;
    request_max      : positive;
    reply_max        : positive;
    credit           : positive;
    classic          : boolean;
    lists            : boolean;
    deadman          : boolean;
    gateware_version : word32_t;
    build            : word32_t;
    spec_hash        : std_ulogic_vector(63 downto 0);
  end record;

  function frame_settings_of(settings : settings_t) return frame_settings_t;

  constant ring_bytes : positive := 512;  -- in the receiver

  -- The program's own words. The first three, and the control registers before them, are zero in a new session.
  constant word_first    : natural := 16#45#;  -- the number of the first post that failed
  constant word_status   : natural := 16#46#;  -- and its status
  constant word_posts    : natural := 16#47#;  -- posts executed in this session, in the lower half
  constant word_session  : natural := 16#49#;  -- nonce and epoch of the session; all ones without a session
  constant word_failed   : natural := 16#4A#;  -- failed posts in the lower half; the upper half is all ones
  constant word_high     : natural := 16#4C#;  -- upper half of the clock
  constant word_barrier  : natural := 16#4F#;
  constant word_total    : natural := 16#50#;  -- of a list: its words
  constant word_reads    : natural := 16#51#;  -- of a list: words to read
  constant word_writes   : natural := 16#55#;  -- of a list: words to write
  constant word_done     : natural := 16#52#;  -- of a list: words done, less one
  constant word_mask     : natural := 16#53#;
  constant word_answer   : natural := 16#59#;  -- the status of a failed list
  constant word_operand  : natural := 16#54#;
  constant word_out_size : natural := 16#56#;  -- of an exchange group: bytes of its outputs, with bit 31 set
  constant word_in_size  : natural := 16#57#;  -- of an exchange group: bytes of its inputs
  constant word_counts   : natural := 16#58#;  -- of an exchange group: both numbers of members
  constant word_own_nonce : natural := 16#5A#; -- nonce of the session, in the lower half
  constant word_nonce    : natural := 16#5B#;  -- nonce of the last HELLO answer; a reset keeps it, against a late OPEN
  constant word_zero     : natural := 16#60#;  -- constants
  constant word_one      : natural := 16#61#;  -- the status of an access that failed
  constant word_ones     : natural := 16#62#;
  constant word_defined  : natural := 16#63#;  -- 80000000
  constant word_four     : natural := 16#64#;
  constant word_upper    : natural := 16#65#;  -- FFFF0000
  constant word_two      : natural := 16#66#;  -- and of one that had no answer (by_silence)
  constant word_hello    : natural := 16#68#;  -- the part of the HELLO answer about the device, after the epoch
  constant hello_words   : natural := 5;

  -- Flags that last from frame to frame. The first three are the register `arm`. The dead-man holds three of them, and
  -- to set or clear these is a command (dead_man_pkg). Setting flag_tripped trips the dead-man if it runs, and clearing
  -- it arms. Clearing flag_tripped_now begins a session.
  constant flag_tripped     : natural := 1;   -- the dead-man has tripped, and nobody has armed it since
  constant flag_running     : natural := 2;   -- the dead-man is running
  constant flag_publishing  : natural := 4;
  constant flag_tripped_now : natural := 8;   -- the dead-man has tripped in this session
  constant flag_offered     : natural := 16;  -- a HELLO answer was sent that no OPEN has used
  constant flag_untold      : natural := 32;  -- CLOSED was not sent since the last HELLO
  constant flag_failed      : natural := 64;  -- a post failed in this session

  -- Marks of one frame.
  constant mark_repeated  : natural := 1;    -- it was executed before: nothing is written again
  constant mark_writes    : natural := 2;    -- the list writes
  constant mark_fifo      : natural := 4;    -- the list has a read_fifo
  constant mark_posting   : natural := 16;   -- it is a post
  constant mark_executing : natural := 32;   -- the list or group has been checked

  -- The status of a place without an executed id.
  constant no_status : natural := 15;

  -- Shape of one operation of a list.
  constant shape_once  : natural := 1;    -- one address for all words; otherwise each word has its own
  constant shape_reads : natural := 2;    -- it reads words; otherwise each word has a value
  constant shape_mask  : natural := 4;    -- each value has a mask before it
  constant shape_add   : natural := 8;    -- the value is added
  constant shape_up    : natural := 16;   -- the next word is at the next address
  constant shape_fifo  : natural := 32;   -- it is read_fifo
  constant shape_none  : natural := 128;  -- there is no such operation

  function shape_of(operation : byte_t) return byte_t;

  -- The marks that an operation gives to its frame: it writes, or it has a read_fifo.
  function marks_of(shape : byte_t) return byte_t;

  -- Words of an exchange group. The first word has the number of inputs in the lowest byte, and the number of outputs
  -- in the next byte. The second word is its word_out_size, or 0 if the group is not defined. Then each member has a
  -- word with the number of bytes in the highest byte, and the address. An address of four bytes takes a word of its
  -- own.
  function exchange_stride(s : frame_settings_t) return positive;

  -- The most words that one frame can define.
  function exchange_size_most(s : frame_settings_t) return natural;

  function sequence_base(s : frame_settings_t) return natural;
  function exchange_base(s : frame_settings_t) return natural;
  function memory_words(s : frame_settings_t) return positive;

  function features_of(s : frame_settings_t) return natural;

  type word_memory_t is array (natural range <>) of word32_t;
  function memory_content(s : frame_settings_t) return word_memory_t;

end package;

package body frame_layout_pkg is

  function frame_settings_of(settings : settings_t) return frame_settings_t is
    variable s : frame_settings_t;
  begin
    s := (
      address_width => settings.address_bits, data_width => settings.data_bits,
      address_bytes => bytes_for(settings.address_bits), data_bytes => bytes_for(settings.data_bits),
      clock_hz => settings.clock_hz, base_hz => settings.base_hz, groups => settings.groups,
      group_size => settings.group_size, rate_bytes => settings.rate_bytes, exchanges => settings.exchanges,
      exchange_size => settings.exchange_size, window => settings.window,
      cache_bytes => frame_cache_bytes_default_c, request_max => frame_short_payload_max_c,
      reply_max => frame_short_payload_max_c, credit => ring_bytes, classic => settings.protocol = protocol_both,
      lists => settings.lists, deadman => settings.deadman,
      gateware_version => settings.gateware_version, build => settings.build, spec_hash => settings.spec_hash);
    if settings.publish_mode = 0 then
      s.groups     := 0;
      s.group_size := 0;
    end if;
    return s;
  end function;

  function shape_of(operation : byte_t) return byte_t is
    variable shape : natural;
  begin
    case to_integer(unsigned(operation)) is
      when list_operation_read_c         => shape := shape_reads;
      when list_operation_read_up_c      => shape := shape_reads + shape_once + shape_up;
      when list_operation_read_fifo_c    => shape := shape_reads + shape_once + shape_fifo;
      when list_operation_write_c        => shape := 0;
      when list_operation_write_up_c     => shape := shape_once + shape_up;
      when list_operation_write_fifo_c   => shape := shape_once;
      when list_operation_write_masked_c => shape := shape_mask;
      when list_operation_add_c          => shape := shape_add;
      when others                        => shape := shape_none;
    end case;
    return byte_t(to_unsigned(shape, 8));
  end function;

  function marks_of(shape : byte_t) return byte_t is
    constant reads : std_ulogic := or (shape and byte_t(to_unsigned(shape_reads, 8)));
    constant fifo  : std_ulogic := or (shape and byte_t(to_unsigned(shape_fifo, 8)));
  begin
    return (byte_t(to_unsigned(mark_writes, 8)) and (7 downto 0 => not reads)) or
           (byte_t(to_unsigned(mark_fifo, 8)) and (7 downto 0 => fifo));
  end function;

  constant first_table : natural := 16#80#;
  constant few_groups  : natural := 16#70#;  -- place of the sequences of up to `few_most` groups
  constant few_most    : natural := 16;

  function power_of_two(least : positive) return positive is
    variable power : positive := 1;
  begin
    while power < least loop
      power := 2 * power;
    end loop;
    return power;
  end function;

  function exchange_stride(s : frame_settings_t) return positive is
  begin
    if s.address_bytes = 4 then
      return power_of_two(2 + 2 * s.exchange_size);
    end if;
    return power_of_two(2 + s.exchange_size);
  end function;

  function exchange_size_most(s : frame_settings_t) return natural is
  begin
    return (s.request_max - 5) / (s.address_bytes + 1);  -- before them are id, group and two counts
  end function;

  function sequence_base(s : frame_settings_t) return natural is
    constant size : positive := power_of_two(maximum(s.groups, 1));
  begin
    if s.groups <= few_most then
      return few_groups;
    end if;
    return (first_table + size - 1) / size * size;  -- so an `or` gives the place of a group
  end function;

  function tables_end(s : frame_settings_t) return natural is
  begin
    if s.groups <= few_most then
      return first_table;
    end if;
    return sequence_base(s) + s.groups;
  end function;

  function exchange_base(s : frame_settings_t) return natural is
    constant size  : positive := power_of_two(maximum(s.exchanges, 1)) * exchange_stride(s);
    constant start : natural  := tables_end(s);
  begin
    return (start + size - 1) / size * size;
  end function;

  function memory_words(s : frame_settings_t) return positive is
    variable words : natural := tables_end(s);
  begin
    if s.exchanges > 0 then
      words := exchange_base(s) + s.exchanges * exchange_stride(s);
    end if;
    return power_of_two(maximum(256, words));  -- the address of a register has one byte
  end function;

  function features_of(s : frame_settings_t) return natural is
    variable bits : natural := 0;
  begin
    if s.classic then
      bits := bits + control_value_feature_classic_c;
    end if;
    if s.groups > 0 then
      bits := bits + control_value_feature_publishing_c;
    end if;
    if s.lists then
      bits := bits + control_value_feature_lists_c;
    end if;
    if s.exchanges > 0 then
      bits := bits + control_value_feature_exchanges_c;
    end if;
    if s.deadman then
      bits := bits + control_value_feature_deadman_c;
    end if;
    return bits;
  end function;

  function memory_content(s : frame_settings_t) return word_memory_t is
    variable words : word_memory_t(0 to memory_words(s) - 1) := (others => (others => '0'));

    procedure set(place : natural; value : natural) is
    begin
      words(place) := std_ulogic_vector(to_unsigned(value, 32));
    end procedure;

    function bytes(first, second, third, fourth : natural) return word32_t is
    begin
      return std_ulogic_vector(to_unsigned(first, 8) & to_unsigned(second, 8) & to_unsigned(third, 8) &
                               to_unsigned(fourth, 8));
    end function;

    procedure set_halves(place, upper, lower : natural) is
    begin
      words(place) := std_ulogic_vector(to_unsigned(upper, 16) & to_unsigned(lower, 16));
    end procedure;
  begin
    set(control_magic_c, control_value_magic_c);
    set_halves(control_version_c, frame_version_c, 0);
    words(control_gateware_version_c) := s.gateware_version;
    words(control_build_c)            := s.build;
    set_halves(control_widths_c, 8 * s.address_bytes, 8 * s.data_bytes);
    set(control_clock_hz_c, s.clock_hz);
    set(control_base_hz_c, s.base_hz);
    set(control_features_c, features_of(s));
    set(control_request_credit_c, s.credit);
    set_halves(control_frame_limits_c, s.request_max, s.reply_max);
    set_halves(control_window_c, s.window, s.cache_bytes);
    set_halves(control_groups_c, s.groups, s.group_size);
    set_halves(control_exchanges_c, s.exchanges, s.exchange_size);
    words(control_spec_hash_high_c) := s.spec_hash(63 downto 32);
    words(control_spec_hash_low_c)  := s.spec_hash(31 downto 0);
    words(word_ones)    := (others => '1');
    set(word_one, 16#01000001#);  -- a status, also in the highest byte
    set(word_two, 16#02000002#);
    set(word_four, 16#04000004#);
    words(word_upper)   := x"FFFF0000";
    words(word_defined) := x"80000000";
    words(word_hello)     := bytes(s.address_bytes, s.data_bytes, s.credit / 256, s.credit mod 256);
    words(word_hello + 1) := words(control_frame_limits_c);
    words(word_hello + 2) := bytes(s.window, s.cache_bytes, features_of(s) / 256, features_of(s) mod 256);
    words(word_hello + 3) := s.spec_hash(63 downto 32);
    words(word_hello + 4) := s.spec_hash(31 downto 0);
    return words;
  end function;

end package body;
