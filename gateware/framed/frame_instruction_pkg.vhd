-- SPDX-License-Identifier: BSD-3-Clause
--
-- An instruction of the framed application's program: what it does, all in a clock, and where it goes on.
--
-- It goes on at `following`; where its condition holds, at `target`. Saying waits for the transmitter, beginning for work,
-- awaiting for the end of the access. One that begins an access and jumps does not begin it; one that awaits an access
-- that failed does nothing but go on.
-- `number` is what is compared, said, set or addressed; the word at its address stands in the next clock.
--
-- An instruction may be done several times. What it says, takes and turns is done every time, all else the last time, and then
-- only it jumps, but for if_missing, which jumps any time. So loading a word is done twice: the first time looks at it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package frame_instruction_pkg is

  subtype frame_instruction_t is std_ulogic_vector(79 downto 0);

  subtype following_f is natural range 8 downto 0;
  subtype target_f    is natural range 17 downto 9;
  subtype far_f       is natural range 79 downto 79;  -- of do_point: the highest bit of a place, above `target`
  subtype number_f    is natural range 25 downto 18;
  subtype condition_f is natural range 30 downto 26;
  subtype source_f    is natural range 33 downto 31;
  subtype say_f       is natural range 36 downto 34;
  subtype take_f      is natural range 39 downto 37;
  subtype data_f      is natural range 43 downto 40;
  subtype store_f     is natural range 45 downto 44;
  subtype manage_f    is natural range 49 downto 46;
  subtype special_f   is natural range 54 downto 50;

  subtype times_f     is natural range 57 downto 55;

  -- How many times, if not once to four times.
  constant times_size : std_ulogic_vector(2 downto 0) := "100";  -- `size`
  constant times_rest : std_ulogic_vector(2 downto 0) := "101";  -- 8 - `size`: turns that bring so many low bytes to the top

  -- What makes it jump.
  constant never           : natural := 0;
  constant if_missing      : natural := 1;   -- fewer bytes of the frame are left than one, or take_many takes
  constant if_left_not     : natural := 2;   -- so many are not left: `number`
  constant if_left_other   : natural := 3;   -- so many are not left: lowest nine bits of `data`
  constant if_not_plain    : natural := 4;   -- if_left_not, or the request is chained or has a barrier
  constant if_chained      : natural := 5;
  constant if_barrier      : natural := 6;
  constant if_some_left    : natural := 7;   -- `count` is not zero
  constant if_not_new      : natural := 8;   -- the id is the one of its place, or older
  constant if_duplicate    : natural := 9;   -- it is the one of its place
  constant if_not_kept     : natural := 10;  -- and its reply was not kept
  constant if_order        : natural := 11;  -- with do_before: the request before has not been executed
  constant if_half_not     : natural := 12;  -- lower half of `data`: not that of the word
  constant if_half_lower   : natural := 13;  -- and a lower number, of those that go around
  constant if_flag         : natural := 14;  -- one of those in `number`
  constant if_mark         : natural := 15;  -- one of those in `number`
  constant if_shape        : natural := 16;  -- one of those in `number`
  constant if_low          : natural := 17;  -- lowest byte of `data` is `number`
  constant if_low_not      : natural := 18;
  constant if_above        : natural := 19;  -- `data` is more than `number`
  constant if_top          : natural := 22;  -- highest bit of `data`
  constant if_no_register  : natural := 24;  -- `pointer` is no control register
  constant if_pointer      : natural := 25;  -- it is `number`
  constant if_failed       : natural := 26;  -- the access
  constant if_silent       : natural := 27;  -- the access that failed: nobody answered
  constant if_denied       : natural := 23;  -- the access that failed: a write, and the dead-man has tripped
  constant if_busy         : natural := 28;  -- a frame is on its way out
  constant if_rate_pending : natural := 29;
  constant if_half_turn    : natural := 30;  -- the clock's highest bit was one when last looked at

  constant always          : natural := 31;

  -- What is said, and from where.
  constant say_nothing : std_ulogic_vector(2 downto 0) := "000";
  constant say_kind    : std_ulogic_vector(2 downto 0) := "001";
  constant say_byte    : std_ulogic_vector(2 downto 0) := "010";
  constant say_kept    : std_ulogic_vector(2 downto 0) := "011";  -- a byte, and the reply cache keeps it
  constant say_end     : std_ulogic_vector(2 downto 0) := "100";  -- the payload is whole
  constant say_last    : std_ulogic_vector(2 downto 0) := "101";  -- so it is, and this is the kind
  constant say_again   : std_ulogic_vector(2 downto 0) := "110";  -- the payload begins anew

  constant from_number : std_ulogic_vector(2 downto 0) := "000";
  constant from_top    : std_ulogic_vector(2 downto 0) := "001";  -- highest byte of `data`, which turns
  constant from_word   : std_ulogic_vector(2 downto 0) := "010";  -- highest byte of a data word in it; likewise
  constant from_half   : std_ulogic_vector(2 downto 0) := "011";  -- the word's lower half, in two times
  constant from_id     : std_ulogic_vector(2 downto 0) := "100";  -- highest byte of `id`, which turns
  constant from_cache  : std_ulogic_vector(2 downto 0) := "110";  -- the next byte of the reply that was kept
  constant from_other  : std_ulogic_vector(2 downto 0) := "111";  -- the group; a kind: of the reply that was kept,
                                                                      -- with status_of_data in `number` of that status

  -- Of a kind or place: its status is the lowest four bits of `data`.
  constant status_of_data : natural := 16#20#;

  -- Where the byte that is taken goes.
  constant take_nothing : std_ulogic_vector(2 downto 0) := "000";
  constant take_skip    : std_ulogic_vector(2 downto 0) := "001";
  constant take_data    : std_ulogic_vector(2 downto 0) := "010";
  constant take_first   : std_ulogic_vector(2 downto 0) := "011";  -- to `data`, whose other bytes become zero
  constant take_many    : std_ulogic_vector(2 downto 0) := "100";  -- nowhere, and `count` bytes at once
  constant take_address : std_ulogic_vector(2 downto 0) := "101";
  constant take_id      : std_ulogic_vector(2 downto 0) := "110";
  constant take_item    : std_ulogic_vector(2 downto 0) := "111";  -- to the address, where each word of the operation has its own

  -- What `data` becomes.
  constant data_stays   : std_ulogic_vector(3 downto 0) := "0000";
  constant data_turn    : std_ulogic_vector(3 downto 0) := "0001";  -- up a byte, the highest one down
  constant data_word    : std_ulogic_vector(3 downto 0) := "0010";
  constant data_clock   : std_ulogic_vector(3 downto 0) := "0011";
  constant data_group   : std_ulogic_vector(3 downto 0) := "0100";  -- the word of the group at place `count`
  constant data_flags   : std_ulogic_vector(3 downto 0) := "0101";  -- the lowest three
  constant data_add     : std_ulogic_vector(3 downto 0) := "0110";  -- the word
  constant data_and     : std_ulogic_vector(3 downto 0) := "0111";
  constant data_and_not : std_ulogic_vector(3 downto 0) := "1000";

  -- What is stored where the word is looked at.
  constant store_nothing : std_ulogic_vector(1 downto 0) := "00";
  constant store_data    : std_ulogic_vector(1 downto 0) := "01";
  constant store_count   : std_ulogic_vector(1 downto 0) := "10";  -- the word plus one, but not beyond all ones
  constant store_next    : std_ulogic_vector(1 downto 0) := "11";  -- the word plus one

  -- What is asked of the subscription manager; the word is `data`, the place `count`.
  constant manage_nothing : std_ulogic_vector(3 downto 0) := "0000";
  constant manage_word    : std_ulogic_vector(3 downto 0) := "0001";
  constant manage_fill    : std_ulogic_vector(3 downto 0) := "0010";
  constant manage_empty   : std_ulogic_vector(3 downto 0) := "0011";
  constant manage_rate    : std_ulogic_vector(3 downto 0) := "0100";
  constant manage_event   : std_ulogic_vector(3 downto 0) := "0101";
  constant manage_publish : std_ulogic_vector(3 downto 0) := "0110";  -- on or off: lowest bit of `data`; the flag, too
  constant manage_clear   : std_ulogic_vector(3 downto 0) := "1000";
  constant manage_take    : std_ulogic_vector(3 downto 0) := "1001";

  -- One more thing.
  constant set_flags    : std_ulogic_vector(4 downto 0) := "00001";  -- those in `number`
  constant clear_flags  : std_ulogic_vector(4 downto 0) := "00010";
  constant set_marks    : std_ulogic_vector(4 downto 0) := "00011";  -- likewise; beginning clears them all
  constant load_shape   : std_ulogic_vector(4 downto 0) := "00100";  -- of the operation in `data`; its marks, too
  constant load_count   : std_ulogic_vector(4 downto 0) := "00101";  -- from the lowest byte of `data`
  constant load_kept    : std_ulogic_vector(4 downto 0) := "00110";  -- from the length of the reply that was kept
  constant load_group   : std_ulogic_vector(4 downto 0) := "01000";  -- from the lowest byte of `data`
  constant load_size    : std_ulogic_vector(4 downto 0) := "01001";  -- from the highest byte of the word
  constant load_epoch   : std_ulogic_vector(4 downto 0) := "01010";  -- from the lower half of `data`
  constant start_dead_man : std_ulogic_vector(4 downto 0) := "01011";  -- for `data` ticks, 0: stop
  constant address_up   : std_ulogic_vector(4 downto 0) := "01110";  -- of an operation at rising addresses
  constant hold_bus     : std_ulogic_vector(4 downto 0) := "01111";
  constant half_turn    : std_ulogic_vector(4 downto 0) := "10000";  -- look at the clock's highest bit
  constant forget_place : std_ulogic_vector(4 downto 0) := "10001";  -- place number `pointer` holds its id of before the start

  -- What is done, a bit each.
  constant do_begin        : natural := 58;  -- go on where the work in hand says, `count` and marks zero, the bus free
  constant do_dispatch     : natural := 59;  -- go on at `following` plus the kind's operation
  constant do_rewind       : natural := 60;  -- the next byte is the first one again
  constant do_done         : natural := 61;  -- with the frame
  constant do_pointer      : natural := 62;  -- the word is the one at `pointer`, not at `number`
  constant do_point        : natural := 63;  -- `pointer` to `far` and `target`
  constant do_point_group  : natural := 64;  -- with do_point: plus the number of the group
  constant do_point_other  : natural := 65;  -- with do_point: plus the place of the exchange group
  constant do_point_data   : natural := 66;  -- `pointer` to the lowest byte of `data`
  constant do_point_up     : natural := 67;
  constant do_count        : natural := 68;  -- `count` one less
  constant do_load_address : natural := 69;  -- from the word
  constant do_find_address : natural := 70;  -- from the word of the group
  constant do_read         : natural := 71;  -- begin an access
  constant do_write        : natural := 72;  -- begin an access
  constant do_await        : natural := 73;  -- wait for the end of the access
  constant do_before       : natural := 74;  -- look at the place of the id before
  constant do_call         : natural := 76;  -- where it jumps, remember `following`
  constant do_return       : natural := 77;  -- go on there
  constant if_any_time     : natural := 78;  -- its condition counts not only the last time
  constant do_place        : natural := 75;  -- the id takes its place, with the status in `number`

  constant nothing_done : frame_instruction_t := (others => '0');

  -- An instruction that does one thing; join them with `or`.
  function act(action : natural) return frame_instruction_t;
  function times(count : positive range 1 to 4) return frame_instruction_t;
  function for_size(what : std_ulogic_vector(2 downto 0)) return frame_instruction_t;
  function number(value : natural) return frame_instruction_t;
  function say(what : std_ulogic_vector(2 downto 0); source : std_ulogic_vector(2 downto 0) := from_number)
    return frame_instruction_t;
  function take(where : std_ulogic_vector(2 downto 0)) return frame_instruction_t;
  function data(what : std_ulogic_vector(3 downto 0)) return frame_instruction_t;
  function store(what : std_ulogic_vector(1 downto 0); place : natural) return frame_instruction_t;
  function manage(what : std_ulogic_vector(3 downto 0)) return frame_instruction_t;
  function also(what : std_ulogic_vector(4 downto 0); value : natural := 0) return frame_instruction_t;

end package;

package body frame_instruction_pkg is

  function act(action : natural) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(action) := '1';
    return i;
  end function;

  function times(count : positive range 1 to 4) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(times_f) := std_ulogic_vector(to_unsigned(count - 1, 3));
    return i;
  end function;

  function for_size(what : std_ulogic_vector(2 downto 0)) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(times_f) := what;
    return i;
  end function;

  function number(value : natural) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(number_f) := std_ulogic_vector(to_unsigned(value, 8));
    return i;
  end function;

  function say(what : std_ulogic_vector(2 downto 0); source : std_ulogic_vector(2 downto 0) := from_number)
    return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(say_f)    := what;
    i(source_f) := source;
    return i;
  end function;

  function take(where : std_ulogic_vector(2 downto 0)) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(take_f) := where;
    return i;
  end function;

  function data(what : std_ulogic_vector(3 downto 0)) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(data_f) := what;
    return i;
  end function;

  function store(what : std_ulogic_vector(1 downto 0); place : natural) return frame_instruction_t is
    variable i : frame_instruction_t := number(place);
  begin
    i(store_f) := what;
    return i;
  end function;

  function manage(what : std_ulogic_vector(3 downto 0)) return frame_instruction_t is
    variable i : frame_instruction_t := nothing_done;
  begin
    i(manage_f) := what;
    return i;
  end function;

  function also(what : std_ulogic_vector(4 downto 0); value : natural := 0) return frame_instruction_t is
    variable i : frame_instruction_t := number(value);
  begin
    i(special_f) := what;
    return i;
  end function;

end package body;
