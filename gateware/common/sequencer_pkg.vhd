-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of a program of bus_sequencer, and what it asks of a bus. The program is a text of hexadecimal digits, four
-- for each word.
--
--   bits 15:14  00 a byte, 01 a byte whose reply must be equal to it, 10 a byte of an output, 11 an operation
--   a byte      bit 13 begins a frame before it, 12 ends the frame after it, 11 the device sends it, 10 keep the reply,
--               9:8 at this byte of the value, 7:0 the byte. The last byte of a value goes on to the next value: it is
--               at byte 0, or, if the device sends it, has bit 0 set.
--   an output   bits 13 and 12 as above, 9:8 the byte of the output, 2:0 which one. Bit 10 takes the output at once;
--               the bytes without it are of the one that was taken. So all bytes are of one write.
--   operation   bits 13:11 say which one:
--               0 wait until the timer is zero, then start it: 7:0 the time in us, with bit 10 in 256 us
--               1 a sample begins    2 it ends; go on at the word 7:0    3 the set-up ends
--               4 go on at the word 7:0 if the output 10:8 was never written

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package sequencer_pkg is

  subtype program_word_t is std_ulogic_vector(15 downto 0);
  subtype byte_t is std_ulogic_vector(7 downto 0);
  type program_t is array (natural range <>) of program_word_t;

  constant operation_wait   : std_ulogic_vector(2 downto 0) := "000";
  constant operation_sample : std_ulogic_vector(2 downto 0) := "001";
  constant operation_commit : std_ulogic_vector(2 downto 0) := "010";
  constant operation_ready  : std_ulogic_vector(2 downto 0) := "011";
  constant operation_skip   : std_ulogic_vector(2 downto 0) := "100";

  -- Why a byte failed.
  subtype failure_t is std_ulogic_vector(1 downto 0);
  constant failure_no_answer   : failure_t := "01";
  constant failure_wrong_reply : failure_t := "10";
  constant failure_refused     : failure_t := "11"; -- the device says so, and the data say why

  -- A byte that is to be exchanged. `go` is high for one clock. `last` and `receive` stand until `done`.
  type bus_request_t is record
    go      : std_ulogic;
    first   : std_ulogic; -- begin a frame before it
    last    : std_ulogic; -- end the frame after it
    receive : std_ulogic; -- the device sends it
    data    : byte_t;
  end record;

  -- What came back. `done` is high for one clock.
  type bus_reply_t is record
    done   : std_ulogic;
    failed : std_ulogic; -- the frame has ended, and `reason` is why
    reason : failure_t;
    data   : byte_t;
  end record;

  -- 256 words; those behind the text are zero.
  function program_of (text : string) return program_t;

end package;

package body sequencer_pkg is

  function digit (letter : character) return natural is
  begin
    case letter is
      when '0' to '9' => return character'pos(letter) - character'pos('0');
      when 'A' to 'F' => return character'pos(letter) - character'pos('A') + 10;
      when others =>
        assert false report "sequencer_pkg: a program has the digits 0 to 9 and A to F" severity failure;
        return 0;
    end case;
  end function;

  function program_of (text : string) return program_t is
    variable found : program_t(0 to 255) := (others => (others => '0'));
    variable value : unsigned(15 downto 0);
  begin
    for word in 0 to text'length / 4 - 1 loop
      value := (others => '0');
      for place in 0 to 3 loop
        value := value(11 downto 0) & to_unsigned(digit(text(text'low + 4 * word + place)), 4);
      end loop;
      found(word) := std_ulogic_vector(value);
    end loop;
    return found;
  end function;

end package body;
