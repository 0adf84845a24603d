-- SPDX-License-Identifier: BSD-3-Clause
--
-- Turns characters into messages without a checksum, and without waiting for the end of the message. It is the receiver
-- of the datalinks "lite" and "none".
--
--   idle --#--> letters --:--> data --LF--> idle      lite: data are digits; another character: broken, until a head
--   idle --#--> letters --:--> data --message_end-->  none: data are plain bytes, as many as the command needs
--
-- Ports     receive: as from the receiver, but each byte is valid at once. `good` comes after it, and `bad` never comes
--           for a message that has begun. No character is taken while room is low.
--           message_end (only for "none"): high in the clock of a colon or byte that ends the message.
-- Latency   None. One character per clock.
-- Errors    lite: a head other than # between messages is reported as f1, and nothing else is reported. A wrong letter
--           drops the message. A wrong digit leaves the message open until the next head. That head ends the message,
--           and begins no other. none: no errors.

library ieee;
  use ieee.std_logic_1164.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity lite_receiver is
  generic (
    digits : boolean := true  -- data are pairs of digits ("lite"); false: plain bytes ("none")
  );
  port (
    clock           : in  std_ulogic;
    reset           : in  std_ulogic;
    character_valid : in  std_ulogic;
    character_ready : out std_ulogic;
    character_data  : in  character_t;
    room            : in  std_ulogic;
    message_end     : in  std_ulogic;
    receive         : out receive_t
  );
end entity;

architecture rtl of lite_receiver is

  type state_t is (
    idle,     -- between messages; ends with a head
    letters,  -- of the command; ends with colon or line end
    data,     -- ends with the line end
    broken    -- a character was not a digit; ends with a head
  );

  type record_t is record
    state : state_t;
    half  : std_ulogic;                     -- the first digit of a pair is in `digit`
    digit : std_ulogic_vector(3 downto 0);
  end record;

  constant initial : record_t := (state => idle, half => '0', digit => (others => '0'));

  signal r, r_next : record_t := initial;

begin

  character_ready <= room;

  judge : process (all)
    variable v    : record_t;
    variable c    : character_t;
    variable o    : receive_t;
    variable head : std_ulogic;
  begin
    v := r;
    c := character_data;
    o := (event => nothing, checked => '0', data => c.data);
    head := c.request or c.publish;

    if character_valid = '1' and room = '1' then
      case r.state is
        when idle | letters =>
          if c.request = '1' and c.checked = '0' then
            o.event := start;
            v.state := letters;
            v.half  := '0';
          elsif r.state = idle then
            if digits and head = '1' then
              o.event := bad;
              o.data  := datalink_error_format_c;
            end if;
          elsif c.line_end = '1' then
            o.event := good;
            v.state := idle;
          elsif c.colon = '1' then
            o.event := colon;
            v.state := data;
          elsif c.letter = '1' then
            o.event := letter;
          elsif c.separator = '0' then
            v.state := idle;
          end if;
        when data =>
          if not digits then
            o.event := byte;
          elsif c.line_end = '1' or head = '1' then
            o.event := good;
            v.state := idle;
          elsif c.digit = '1' then
            v.half  := not r.half;
            v.digit := c.value;
            if r.half = '1' then
              o.event := byte;
              o.data  := r.digit & c.value;
            end if;
          elsif c.separator = '0' then
            v.state := broken;
          end if;
        when broken =>
          if head = '1' then
            o.event := good;
            v.state := idle;
          end if;
      end case;
    end if;

    receive <= o;
    if not digits and message_end = '1' then
      v.state := idle;
    end if;
    r_next <= v;
  end process;

  step : process (clock)
  begin
    if rising_edge(clock) then
      r <= r_next;
      if reset = '1' then
        r <= initial;
      end if;
    end if;
  end process;

end architecture;
