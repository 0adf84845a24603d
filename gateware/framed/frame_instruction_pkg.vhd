-- SPDX-License-Identifier: BSD-3-Clause
--
-- An instruction of the framed application's program: what it does, all in one clock, and which instruction follows.
--
-- The next instruction is `following`, or `target` if the condition holds. A jump costs one clock more. An instruction
-- that sends waits for the transmitter. One that begins waits for work. One that awaits waits for the end of the
-- access. An instruction that jumps begins no access and stores nothing. One that awaits an access that failed only
-- goes on. `number` is the value that is compared, sent, set or used as an address. The word at that address comes two
-- clocks later.
--
-- An instruction may be executed several times. It sends, takes and rotates every time, and does everything else only
-- the last time, jumps too. So an instruction that loads a word is executed three times: the first time addresses the
-- word. One that counts a word up is executed twice, because the memory itself sees the word a clock earlier.
--
-- An instruction has two clocks at least. If it is executed once, that is in the second one. Only an instruction
-- with do_begin may have one clock.
--
-- A condition is judged in the first clock of its instruction. So it sees all that the instruction before has done, and
-- nothing of what its own instruction does.

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

  -- How many times, if not one to four times.
  constant times_size : std_ulogic_vector(2 downto 0) := "110";  -- `size`
  constant times_rest : std_ulogic_vector(2 downto 0) := "111";  -- 4 - `size`, 4 if it is 4: brings so many bytes up

  -- Conditions of a jump. The first ones are seen in the same clock, in every clock but the first.
  constant never           : natural := 0;
  constant if_missing      : natural := 1;   -- fewer bytes are left than are taken: one, or the number of take_many
  constant if_not_new      : natural := 2;   -- the id is the last one of its place, or older
  constant if_failed       : natural := 3;   -- the access failed

  -- All others are judged in the first clock. These are about `number`.
  constant if_left_not     : natural := 4;   -- not exactly `number` bytes are left
  constant if_not_plain    : natural := 5;   -- if_left_not, or the request is chained or has a barrier
  constant if_half_not     : natural := 6;   -- the lower half of `data` differs from that of the word
  constant if_half_lower   : natural := 7;   -- and is a lower number, modulo 2**16
  constant if_low          : natural := 8;   -- the lowest byte of `data` is `number`
  constant if_above        : natural := 9;   -- `data` is more than `number`
  constant if_pointer      : natural := 10;  -- `pointer` is `number`
  constant if_no_register  : natural := 11;  -- `pointer` is no control register
  constant if_flag         : natural := 12;  -- one of the flags in `number` is set
  constant if_mark         : natural := 13;  -- one of the marks in `number` is set
  constant if_shape        : natural := 14;  -- one of the shape bits in `number` is set

  constant if_chained      : natural := 16;
  constant if_barrier      : natural := 17;
  constant if_some_left    : natural := 18;  -- `count` is not zero
  constant if_left_other   : natural := 19;  -- the bytes left are not the lowest nine bits of `data`
  constant if_duplicate    : natural := 20;  -- the id is the last one of its place
  constant if_not_kept     : natural := 21;  -- the same, and its reply was not kept
  constant if_order        : natural := 22;  -- with do_before: the request before was not executed
  constant if_over         : natural := 23;  -- `count` is zero, or the access failed, which is seen in the same clock
  constant if_top          : natural := 26;  -- the highest bit of `data` is set
  constant if_silent       : natural := 28;  -- the access failed without an answer
  constant if_denied       : natural := 29;  -- the failed access is a write, and the dead-man has tripped
  constant if_busy         : natural := 30;  -- a frame is being sent
  constant if_half_turn    : natural := 31;  -- the clock's highest bit was one at the last look

  -- What is sent, and from where.
  constant say_nothing : std_ulogic_vector(2 downto 0) := "000";
  constant say_kind    : std_ulogic_vector(2 downto 0) := "001";
  constant say_byte    : std_ulogic_vector(2 downto 0) := "010";
  constant say_kept    : std_ulogic_vector(2 downto 0) := "011";  -- a byte, which the reply cache also keeps
  constant say_end     : std_ulogic_vector(2 downto 0) := "100";  -- the payload is complete
  constant say_last    : std_ulogic_vector(2 downto 0) := "101";  -- the payload is complete, and this is the kind
  constant say_again   : std_ulogic_vector(2 downto 0) := "110";  -- the payload starts again

  constant from_number : std_ulogic_vector(2 downto 0) := "000";
  constant from_top    : std_ulogic_vector(2 downto 0) := "001";  -- the highest byte of `data`, which rotates
  constant from_word   : std_ulogic_vector(2 downto 0) := "010";  -- the highest byte of the data word; it rotates
  constant from_half   : std_ulogic_vector(2 downto 0) := "011";  -- the word's lower half, in its last two times
  constant from_id     : std_ulogic_vector(2 downto 0) := "100";  -- the highest byte of `id`, which rotates
  constant from_cache  : std_ulogic_vector(2 downto 0) := "110";  -- the next byte of the cached reply
  constant from_other  : std_ulogic_vector(2 downto 0) := "111";  -- the group; for a kind: that of the cached reply,
                                                                      -- or with status_of_data in `number`: the kind of
                                                                      -- that status

  -- For a kind or place: the status is the lowest four bits of `data`.
  constant status_of_data : natural := 16#20#;

  -- Where a taken byte goes.
  constant take_nothing : std_ulogic_vector(2 downto 0) := "000";
  constant take_skip    : std_ulogic_vector(2 downto 0) := "001";
  constant take_data    : std_ulogic_vector(2 downto 0) := "010";
  constant take_first   : std_ulogic_vector(2 downto 0) := "011";  -- to `data`, whose other bytes become zero
  constant take_many    : std_ulogic_vector(2 downto 0) := "100";  -- nowhere; takes `count` bytes at once
  constant take_address : std_ulogic_vector(2 downto 0) := "101";
  constant take_id      : std_ulogic_vector(2 downto 0) := "110";
  constant take_item    : std_ulogic_vector(2 downto 0) := "111";  -- to the address, if each word has its own

  -- The new value of `data`.
  constant data_stays   : std_ulogic_vector(3 downto 0) := "0000";
  constant data_turn    : std_ulogic_vector(3 downto 0) := "0001";  -- rotate up by one byte
  constant data_word    : std_ulogic_vector(3 downto 0) := "0010";
  constant data_clock   : std_ulogic_vector(3 downto 0) := "0011";
  constant data_group   : std_ulogic_vector(3 downto 0) := "0100";  -- the word of the group at place `count`
  constant data_flags   : std_ulogic_vector(3 downto 0) := "0101";  -- the lowest three flags
  constant data_add     : std_ulogic_vector(3 downto 0) := "0110";  -- plus the word
  constant data_and     : std_ulogic_vector(3 downto 0) := "0111";
  constant data_and_not : std_ulogic_vector(3 downto 0) := "1000";

  -- What is stored at the addressed word.
  constant store_nothing : std_ulogic_vector(1 downto 0) := "00";
  constant store_data    : std_ulogic_vector(1 downto 0) := "01";  -- `data` after this instruction
  constant store_count   : std_ulogic_vector(1 downto 0) := "10";  -- the word plus one, with a limit of all ones
  constant store_next    : std_ulogic_vector(1 downto 0) := "11";  -- the word plus one

  -- Requests to the subscription manager. The word is `data`, and the place is `count`.
  constant manage_nothing : std_ulogic_vector(3 downto 0) := "0000";
  constant manage_word    : std_ulogic_vector(3 downto 0) := "0001";
  constant manage_fill    : std_ulogic_vector(3 downto 0) := "0010";
  constant manage_empty   : std_ulogic_vector(3 downto 0) := "0011";
  constant manage_rate    : std_ulogic_vector(3 downto 0) := "0100";  -- waits for its end
  constant manage_event   : std_ulogic_vector(3 downto 0) := "0101";
  constant manage_publish : std_ulogic_vector(3 downto 0) := "0110";  -- on or off by bit 0 of `data`; sets the flag
  constant manage_clear   : std_ulogic_vector(3 downto 0) := "1000";
  constant manage_take    : std_ulogic_vector(3 downto 0) := "1001";

  -- Other actions.
  constant set_flags    : std_ulogic_vector(4 downto 0) := "00001";  -- flags in `number`
  constant clear_flags  : std_ulogic_vector(4 downto 0) := "00010";
  constant set_marks    : std_ulogic_vector(4 downto 0) := "00011";  -- marks in `number`; do_begin clears all marks
  constant load_shape   : std_ulogic_vector(4 downto 0) := "01010";  -- of the operation in `data`; also sets its marks
  constant load_count   : std_ulogic_vector(4 downto 0) := "00101";  -- from the lowest byte of `data`
  constant load_kept    : std_ulogic_vector(4 downto 0) := "00100";  -- from the length of the cached reply
  constant load_group   : std_ulogic_vector(4 downto 0) := "01101";  -- from the lowest byte of `data`
  constant load_size    : std_ulogic_vector(4 downto 0) := "01110";  -- from the highest byte of the word
  constant load_epoch   : std_ulogic_vector(4 downto 0) := "00110";  -- from the lower half of `data`
  constant start_dead_man : std_ulogic_vector(4 downto 0) := "01001";  -- for `data` ticks; 0 stops it
  constant address_up   : std_ulogic_vector(4 downto 0) := "01011";  -- for an operation at rising addresses
  constant hold_bus     : std_ulogic_vector(4 downto 0) := "01100";
  constant half_turn    : std_ulogic_vector(4 downto 0) := "00111";  -- look at the clock's highest bit
  constant by_silence   : std_ulogic_vector(4 downto 0) := "01111";  -- address the word of an access without an answer,
                                                                     -- if it had none
  constant forget_place : std_ulogic_vector(4 downto 0) := "01000";  -- place `pointer` gets an id from before the start

  -- Actions with one bit each.
  constant do_begin        : natural := 58;  -- what follows is the next work; clears `count` and marks, frees the bus
  constant do_dispatch     : natural := 59;  -- continue at `following` plus the operation of the kind
  constant do_rewind       : natural := 60;  -- the next byte is the first one again
  constant do_done         : natural := 61;  -- the frame is done
  constant do_pointer      : natural := 62;  -- address the word by `pointer`, not by `number`
  constant do_point        : natural := 63;  -- set `pointer` to `far` and `target`
  constant do_point_group  : natural := 64;  -- with do_point: add the number of the group
  constant do_point_other  : natural := 65;  -- with do_point: add the place of the exchange group
  constant do_point_data   : natural := 66;  -- set `pointer` to the lowest byte of `data`
  constant do_point_up     : natural := 67;
  constant do_count        : natural := 68;  -- decrement `count`
  constant do_load_address : natural := 69;  -- from the word
  constant do_find_address : natural := 70;  -- from the word of the group
  constant do_read         : natural := 71;  -- begin an access
  constant do_write        : natural := 72;  -- begin an access
  constant do_await        : natural := 73;  -- wait for the end of the access
  constant do_before       : natural := 74;  -- look at the place of the id before this one
  constant do_call         : natural := 76;  -- remember `target`
  constant do_return       : natural := 77;  -- continue at the remembered `target`
  constant if_not          : natural := 78;  -- jump if the condition does not hold; for those judged by one look
  constant do_place        : natural := 75;  -- store the id in its place, with the status in `number`, unless
                                               -- mark_repeated is set

  constant nothing_done : frame_instruction_t := (others => '0');

  -- An instruction that does one action. Combine actions with `or`.
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
