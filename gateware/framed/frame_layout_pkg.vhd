-- SPDX-License-Identifier: BSD-3-Clause
--
-- What the framed application is built for, and where its memory of 32-bit words has what.
--
--   0x00 description  0x20 counters  0x40 state: the control registers, at their own addresses (docs/protocol.md, section 6)
--   0x45 what the program keeps to itself  0x60 constants  0x70 sequences of up to 16 groups
--   from 0x80: those of more groups, exchange groups; 1024 words at most

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.width_pkg.all;

package frame_layout_pkg is

  subtype word32_t is std_ulogic_vector(31 downto 0);

  -- An output that the dead-man sets, and to what.
  type safe_value_t is record
    address : word32_t;
    value   : word32_t;
  end record;
  type safe_values_t is array (natural range <>) of safe_value_t;
  constant no_safe_values : safe_values_t(1 to 0) := (others => (address => (others => '0'), value => (others => '0')));

  -- What a description says, and which kinds there are: the settings of the core, and what follows from them.
  type frame_settings_t is record
    address_width    : positive;
    data_width       : positive;
    address_bytes    : positive;  -- that hold them
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

  constant ring_bytes : positive := 512;  -- of the receiver

  -- What the program keeps to itself; the first three, and the control registers before them, are zero in a new session.
  constant word_first    : natural := 16#45#;  -- the number of the first post that failed
  constant word_status   : natural := 16#46#;  -- and its status
  constant word_posts    : natural := 16#47#;  -- executed in this session, in the lower half
  constant word_session  : natural := 16#49#;  -- nonce and epoch of the session; no session: all ones
  constant word_failed   : natural := 16#4A#;  -- posts that failed, in the lower half; the upper half is all ones
  constant word_high     : natural := 16#4C#;  -- upper half of the clock
  constant word_barrier  : natural := 16#4F#;
  constant word_total    : natural := 16#50#;  -- of a list: words
  constant word_reads    : natural := 16#51#;  -- those read
  constant word_writes   : natural := 16#55#;  -- and those written
  constant word_done     : natural := 16#52#;  -- and those done, less one
  constant word_mask     : natural := 16#53#;
  constant word_answer   : natural := 16#59#;  -- the status of a list that failed
  constant word_operand  : natural := 16#54#;
  constant word_out_size : natural := 16#56#;  -- of an exchange group: bytes of its outputs, with bit 31 set
  constant word_in_size  : natural := 16#57#;  -- bytes of its inputs
  constant word_counts   : natural := 16#58#;  -- how many of both
  constant word_own_nonce : natural := 16#5A#; -- of the session, in the lower half
  constant word_nonce    : natural := 16#5B#;  -- of the last HELLO answer; outlives a reset, so that no late OPEN is in time
  constant word_zero     : natural := 16#60#;  -- constants
  constant word_ones     : natural := 16#61#;
  constant word_one      : natural := 16#62#;
  constant word_two      : natural := 16#63#;
  constant word_four     : natural := 16#64#;
  constant word_upper    : natural := 16#65#;  -- FFFF0000
  constant word_defined  : natural := 16#66#;  -- 80000000
  constant word_hello    : natural := 16#68#;  -- what HELLO tells of the device behind the epoch
  constant hello_words   : natural := 5;

  -- What is remembered from frame to frame; the first three are the register `arm`. The dead-man has three of them, to which
  -- setting and clearing are commands: setting flag_tripped trips it if it runs, clearing arms; clearing flag_tripped_now
  -- begins a session (dead_man_pkg).
  constant flag_tripped     : natural := 1;   -- the dead-man has, and nobody has armed since
  constant flag_running     : natural := 2;   -- the dead-man is
  constant flag_publishing  : natural := 4;
  constant flag_tripped_now : natural := 8;   -- in this session
  constant flag_offered     : natural := 16;  -- a HELLO answer that no OPEN has used
  constant flag_told        : natural := 32;  -- CLOSED, since the last HELLO
  constant flag_failed      : natural := 64;  -- a post has, in this session

  -- And of one frame.
  constant mark_repeated  : natural := 1;    -- executed before: nothing is written again
  constant mark_writes    : natural := 2;    -- the list does
  constant mark_fifo      : natural := 4;    -- the list has a read_fifo
  constant mark_posting   : natural := 16;   -- it is a post
  constant mark_executing : natural := 32;   -- list or group has been checked

  -- The status of a place whose id nothing has been executed for.
  constant no_status : natural := 15;

  -- And of one operation of a list.
  constant shape_once  : natural := 1;    -- one address for all words; else each has its own
  constant shape_reads : natural := 2;    -- words; else each has a value
  constant shape_mask  : natural := 4;    -- and a mask before it
  constant shape_add   : natural := 8;    -- which is added
  constant shape_up    : natural := 16;   -- the next word is at the next address
  constant shape_fifo  : natural := 32;   -- it is read_fifo
  constant shape_none  : natural := 128;  -- there is no such operation

  function shape_of(operation : byte_t) return byte_t;

  -- Of its frame: it writes, it has a read_fifo.
  function marks_of(shape : byte_t) return byte_t;

  -- An exchange group: its number of inputs in the lowest byte, of outputs in the next but one above; its word_out_size, 0
  -- if it is not defined; then of each word the bytes, in the highest byte, and the address, which takes a word of its own
  -- where it has four bytes.
  function exchange_stride(s : frame_settings_t) return positive;

  -- So many words one frame can define.
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
  constant few_groups  : natural := 16#70#;  -- where the sequences of `few_most` groups are
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
    return (s.request_max - 5) / (s.address_bytes + 1);  -- id, group and two counts stand before them
  end function;

  function sequence_base(s : frame_settings_t) return natural is
    constant size : positive := power_of_two(maximum(s.groups, 1));
  begin
    if s.groups <= few_most then
      return few_groups;
    end if;
    return (first_table + size - 1) / size * size;  -- so that a group's place is an `or`
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
    return power_of_two(maximum(256, words));  -- a register has a byte of address
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
    set(word_one, 1);
    set(word_two, 2);
    set(word_four, 4);
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
