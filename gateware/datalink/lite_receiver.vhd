-- SPDX-License-Identifier: BSD-3-Clause
--
-- Characters to messages without a check and without waiting for the end: the receiver of the datalinks "lite" and "none".
--
--   idle --#--> letters --:--> data --LF--> idle      lite: data are digits; a character that is none: broken, up to a head
--   idle --#--> letters --:--> data --message_end-->  none: data are bytes as they are, as many as the command needs
--
-- Ports     receive as of the receiver, but a byte stands for itself: what is told has to be believed, for `good` comes
--           behind it and `bad` never does for a message begun. room must be high for any character to be taken.
--           message_end (of "none" only) says in the clock of a colon or byte that the message is over.
-- Latency   None; one character a clock.
-- Errors    lite: a head other than # between messages is told as f1. Nothing else is: a letter that is none drops the
--           message, a digit that is none leaves it open until the next head, which ends it and is used up. none: no errors.

library ieee;
  use ieee.std_logic_1164.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity lite_receiver is
  generic (
    digits : boolean := true  -- data are pairs of digits ("lite"); false: bytes as they are ("none")
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
    idle,     -- between messages; leaves on a head
    letters,  -- of the command; leaves on colon or end
    data,     -- leaves on the end
    broken    -- a digit was none; leaves on a head
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
