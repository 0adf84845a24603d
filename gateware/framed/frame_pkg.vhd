-- SPDX-License-Identifier: BSD-3-Clause
--
-- The signals between the entities of the framed side: checked frames from the receiver, bytes for the transmitter.
-- Also the CRC.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package frame_pkg is

  subtype crc16_t is std_ulogic_vector(15 downto 0);
  subtype entry_t is std_ulogic_vector(4 downto 0);

  -- The entry: what came, in five bits. It is the low four bits of the kind for a request of a session, or one of
  -- these.
  constant entry_unknown   : natural := 14;  -- a request of an unknown kind
  constant entry_hello     : natural := 16;
  constant entry_open      : natural := 17;
  constant entry_check     : natural := 18;  -- dropped: the check or COBS is wrong, or there is no kind
  constant entry_long      : natural := 19;  -- dropped: longer than any request
  constant entry_session   : natural := 20;  -- dropped: no session is open
  constant entry_kind      : natural := 21;  -- dropped: not a kind that a host sends
  constant entry_trip      : natural := 22;  -- no frame: the dead-man has tripped
  constant entry_publish   : natural := 23;  -- no frame: a publish
  constant entry_half_turn : natural := 24;  -- no frame: the highest bit of the clock has changed
  constant entry_receive_overrun : natural := 25;
  constant entry_publish_overrun : natural := 26;

  -- A frame with a right check, or a dropped frame.
  type frame_request_t is record
    valid    : std_ulogic;            -- a frame waits
    entry    : entry_t;
    chained  : std_ulogic;
    barrier  : std_ulogic;
    length   : unsigned(7 downto 0);  -- of its payload
    left     : unsigned(7 downto 0);  -- bytes of the payload not yet taken
    missing  : std_ulogic;            -- fewer bytes are left than `take` would take
    data     : byte_t;                -- the next byte, from the second clock after rewind
  end record;

  -- To the transmitter. At most one of put, finish and restart is high at a time, and only while the transmitter is
  -- ready.
  type frame_reply_t is record
    put     : std_ulogic;  -- data is the next byte of the payload
    kind    : std_ulogic;  -- data is the kind; once for each frame, with finish or at any time before
    restart : std_ulogic;  -- drop the payload
    finish  : std_ulogic;  -- the payload is complete
    data    : byte_t;
  end record;

  constant frame_reply_idle : frame_reply_t := (data => (others => '0'), others => '0');

  -- The CRC after one more byte.
  function next_crc16(crc : crc16_t; data : byte_t) return crc16_t;

  -- Byte number `index` of the check, 0 to 2.
  function check_byte(crc : crc16_t; index : natural) return byte_t;

end package;

package body frame_pkg is

  function next_crc16(crc : crc16_t; data : byte_t) return crc16_t is
    variable mixed : byte_t := crc(7 downto 0) xor data;
  begin
    -- Eight steps of the polynomial 8408 at once, in the fewest gates. Synthesis does not find this form itself.
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
