-- SPDX-License-Identifier: BSD-3-Clause
--
-- What passes between the pieces of the framed side: frames judged by the receiver, bytes for the transmitter; and the CRC.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package frame_pkg is

  subtype crc16_t is std_ulogic_vector(15 downto 0);
  subtype entry_t is std_ulogic_vector(4 downto 0);

  -- What came, as a number of five bits: the low four bits of its kind for a request of a session, or one of these.
  constant entry_unknown   : natural := 14;  -- a request, but of no kind there is
  constant entry_hello     : natural := 16;
  constant entry_open      : natural := 17;
  constant entry_check     : natural := 18;  -- dropped: check or COBS is wrong, or there is no kind
  constant entry_long      : natural := 19;  -- dropped: longer than any request
  constant entry_session   : natural := 20;  -- dropped: no session is open
  constant entry_kind      : natural := 21;  -- dropped: no kind of a host
  constant entry_trip      : natural := 22;  -- no frame but the dead-man, which has tripped
  constant entry_publish   : natural := 23;  -- nor that, but a publish
  constant entry_half_turn : natural := 24;  -- nor that: the clock has come half around
  constant entry_receive_overrun : natural := 25;
  constant entry_publish_overrun : natural := 26;

  -- A frame whose check was right, or in its place what was dropped.
  type frame_request_t is record
    valid    : std_ulogic;            -- one stands
    entry    : entry_t;
    chained  : std_ulogic;
    barrier  : std_ulogic;
    length   : unsigned(7 downto 0);  -- of its payload
    left     : unsigned(7 downto 0);  -- bytes of it not taken yet
    missing  : std_ulogic;            -- fewer are left than would be taken
    data     : byte_t;                -- the next one, a clock after rewind
  end record;

  -- To the transmitter: at most one of put, finish, restart at a time, and only while it is ready.
  type frame_reply_t is record
    put     : std_ulogic;  -- data is the next byte of the payload
    kind    : std_ulogic;  -- data is the kind; once a frame, at any time before finish or with it
    restart : std_ulogic;  -- forget the payload
    finish  : std_ulogic;  -- the payload is whole
    data    : byte_t;
  end record;

  constant frame_reply_idle : frame_reply_t := (data => (others => '0'), others => '0');

  -- The CRC after one more byte.
  function next_crc16(crc : crc16_t; data : byte_t) return crc16_t;

  -- The check's byte number `index`, 0 to 2.
  function check_byte(crc : crc16_t; index : natural) return byte_t;

end package;

package body frame_pkg is

  function next_crc16(crc : crc16_t; data : byte_t) return crc16_t is
    variable mixed : byte_t := crc(7 downto 0) xor data;
  begin
    -- Eight steps of 8408 at once, in as few gates as there are: synthesis does not find them itself.
    mixed(7 downto 4) := mixed(7 downto 4) xor mixed(3 downto 0);
    return (mixed & crc(15 downto 8)) xor (x"000" & mixed(7 downto 4)) xor ("00000" & mixed & "000");
  end function;

  function check_byte(crc : crc16_t; index : natural) return byte_t is
  begin
    if index = 0 then
      return '1' & crc(6 downto 0);
    elsif index = 1 then
      return '1' & crc(13 downto 7);
    end if;
    return "100000" & crc(15 downto 14);
  end function;

end package body;
