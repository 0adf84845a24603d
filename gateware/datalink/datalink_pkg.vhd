-- SPDX-License-Identifier: BSD-3-Clause
--
-- The signals of the classic datalink: classified characters, events of the receiver, words to send. Also the checksum.

library ieee;
  use ieee.std_logic_1164.all;

use work.protocol_pkg.all;

package datalink_pkg is

  -- A received character and its possible meanings. A letter may also be a hex digit. Every other character has one
  -- meaning.
  type character_t is record
    data      : byte_t;      -- the byte itself
    request   : std_ulogic;  -- head of a request: # or $
    checked   : std_ulogic;  -- with request: it is $
    publish   : std_ulogic;  -- head of a publish, which only a device may send
    colon     : std_ulogic;
    star      : std_ulogic;
    line_end  : std_ulogic;
    separator : std_ulogic;
    letter    : std_ulogic;
    digit     : std_ulogic;                     -- hex digit
    value     : std_ulogic_vector(3 downto 0);  -- with digit
  end record;

  -- The events that the receiver makes of the characters. At most one event per clock, to be taken at once.
  --   start, then letter* colon? byte*, then good or bad. A bad may also come outside a message.
  type receive_event_t is (nothing, start, letter, colon, byte, good, bad);

  type receive_t is record
    event   : receive_event_t;
    checked : std_ulogic;  -- with start: the message has a checksum
    data    : byte_t;      -- with letter: the letter as sent; with byte: the byte; with bad: the error code
  end record;

  -- A word to send: three bits for the kind, and one byte.
  subtype word_t is std_ulogic_vector(10 downto 0);

  constant word_head   : std_ulogic_vector(2 downto 0) := "000";  -- head; also says whether a checksum follows
  constant word_letter : std_ulogic_vector(2 downto 0) := "001";  -- a letter that the checksum covers
  constant word_mark   : std_ulogic_vector(2 downto 0) := "010";  -- a character that the checksum does not cover
  constant word_error  : std_ulogic_vector(2 downto 0) := "011";  -- error mark; a message that ends so has no checksum
  constant word_byte   : std_ulogic_vector(2 downto 0) := "100";  -- a byte, sent as two digits
  constant word_tail   : std_ulogic_vector(2 downto 0) := "101";  -- the checksum, if there is one, and the line's end

  -- The checksum after one more byte. `kind` is "crc8" (any polynomial, most significant bit first, no reflection),
  -- "xor", or "none" (then it is always zero).
  function next_checksum(kind : string; polynomial : natural; sum : byte_t; data : byte_t) return byte_t;

  -- The checksum that a variant of the datalink has when `checksum` is asked for. Only "full" has one.
  function checksum_of(datalink : string; checksum : string) return string;

end package;

package body datalink_pkg is

  function next_crc8(polynomial : natural; sum : byte_t; data : byte_t) return byte_t is
    variable rest : byte_t := sum xor data;
    variable bit7 : std_ulogic;
  begin
    for step in 0 to 7 loop
      bit7 := rest(7);
      rest := rest(6 downto 0) & '0';
      for place in 0 to 7 loop
        if (polynomial / 2 ** place) mod 2 = 1 then
          rest(place) := rest(place) xor bit7;
        end if;
      end loop;
    end loop;
    return rest;
  end function;

  function next_checksum(kind : string; polynomial : natural; sum : byte_t; data : byte_t) return byte_t is
  begin
    if kind = "crc8" then
      return next_crc8(polynomial, sum, data);
    elsif kind = "xor" then
      return sum xor data;
    end if;
    return crc8_initial_c;
  end function;

  function checksum_of(datalink : string; checksum : string) return string is
  begin
    if datalink = "full" then
      return checksum;
    end if;
    return "none";
  end function;

end package body;
