-- SPDX-License-Identifier: BSD-3-Clause
--
-- Characters to messages: the form, the length and the checksum of the classic protocol.
--
--   idle --#,$--> letters --:--> data --*--> checksum --LF--> idle       anything wrong: bad, and idle
--
-- Ports     `receive` tells what each character was, in the clock it is taken (no ready: must be taken at once). Whoever
--           keeps a message may believe it after `good` only; after `bad` it was none. `room` must be high when a new
--           message can be kept; between messages the receiver waits for it.
-- Latency   None; one character a clock.
-- Errors    The codes of docs/classic-protocol.md section 4. An error drops its own message and nothing else: no buffer is
--           flushed, and all up to the next head is skipped. Physical errors are kept until they can be told; those that
--           come meanwhile join them.
-- Checksum  Exactly one byte behind a star; the empty message may have an empty one. With checksum "none" a checked
--           message is refused at its head (f1).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity receiver is
  generic (
    message_entries : positive;              -- head, letters, colon and data bytes must be fewer
    checksum        : string  := "crc8";     -- "crc8", "xor" or "none"
    polynomial      : natural range 0 to 255 := to_integer(unsigned(crc8_polynomial_c))
  );
  port (
    clock           : in  std_ulogic;
    reset           : in  std_ulogic;
    character_valid : in  std_ulogic;
    character_ready : out std_ulogic;
    character_data  : in  character_t;
    rx_error        : in  std_ulogic_vector(2 downto 0);  -- pulses of the physical layer: overrun, framing, parity
    room            : in  std_ulogic;
    receive         : out receive_t
  );
end entity;

architecture rtl of receiver is

  type state_t is (
    idle,     -- between messages; leaves on a head
    letters,  -- of the command; leaves on colon, star or end
    data,     -- digits of the data; leaves on star or end
    tail      -- digits of the checksum; leaves on end
  );

  type record_t is record
    state          : state_t;
    checked        : std_ulogic;
    half           : std_ulogic;              -- the first digit of a pair is in `digit`
    digit          : std_ulogic_vector(3 downto 0);
    sum            : byte_t;
    entries        : natural range 0 to message_entries;
    checksum_bytes : natural range 0 to 2;    -- 2: too many
    physical       : std_ulogic_vector(2 downto 0);  -- errors not told yet
  end record;

  constant initial : record_t := (
    state => idle, checked => '0', half => '0', digit => (others => '0'), sum => crc8_initial_c,
    entries => 0, checksum_bytes => 0, physical => (others => '0'));

  signal r, r_next : record_t := initial;

begin

  assert checksum = "crc8" or checksum = "xor" or checksum = "none"
    report "receiver: checksum must be crc8, xor or none" severity failure;

  judge : process (all)
    variable v    : record_t;
    variable c    : character_t;
    variable o    : receive_t;
    variable pair : byte_t;

    procedure fail(code : byte_t) is
    begin
      o.event := bad;
      o.data  := code;
      v.state := idle;
    end procedure;

    -- One more entry of the message; a message that has too many is refused.
    procedure keep(event : receive_event_t; content : byte_t) is
    begin
      if r.entries + 1 >= message_entries then
        fail(datalink_error_message_too_long_c);
      else
        v.entries := r.entries + 1;
        o.event   := event;
        o.data    := content;
      end if;
    end procedure;

  begin
    v := r;
    c := character_data;
    o := (event => nothing, checked => '0', data => (others => '0'));
    pair := r.digit & c.value;
    v.physical := r.physical or rx_error;
    character_ready <= '0';

    if r.physical /= "000" then
      if r.state /= idle or room = '1' then
        fail(byte_t(unsigned(datalink_error_physical_c) + unsigned(r.physical)));
        v.physical := rx_error;
      end if;
    elsif r.state = idle then
      character_ready <= room;
      if character_valid = '1' and room = '1' then
        if c.publish = '1' or (checksum = "none" and c.checked = '1') then
          fail(datalink_error_format_c);
        elsif c.request = '1' then
          o.event   := start;
          o.checked := c.checked;
          v.state   := letters;
          v.checked := c.checked;
          v.half    := '0';
          v.sum     := crc8_initial_c;
          v.entries := 1;
          v.checksum_bytes := 0;
        end if;
      end if;
    else
      character_ready <= '1';
      if character_valid = '1' then
        if r.half = '1' and c.digit = '0' then
          if c.request = '1' or c.publish = '1' or c.line_end = '1' or c.colon = '1' or c.star = '1' then
            fail(datalink_error_odd_digits_c);
          else
            fail(datalink_error_invalid_character_c);
          end if;
        elsif c.line_end = '1' then
          v.state := idle;
          o.event := good;
          -- Up to two entries and a sum of zero: head and at most a colon, for one letter never sums up to zero.
          if r.checked = '1' and (r.state /= tail or r.sum /= x"00" or
              (r.checksum_bytes /= 1 and not (r.checksum_bytes = 0 and r.entries <= 2))) then
            fail(datalink_error_checksum_c);
          end if;
        elsif c.separator = '1' then
          null;
        elsif c.request = '1' or c.publish = '1' or (c.colon = '1' and r.state /= letters) or
            (c.star = '1' and (r.checked = '0' or r.state = tail)) then
          fail(datalink_error_format_c);
        elsif c.star = '1' then
          v.state := tail;
        elsif c.colon = '1' then
          v.state := data;
          keep(colon, c.data);
        elsif r.state = letters then
          if c.letter = '1' then
            v.sum := next_checksum(checksum, polynomial, r.sum, c.data);  -- the letter as sent: case counts
            keep(letter, c.data);
          else
            fail(datalink_error_invalid_character_c);
          end if;
        elsif c.digit = '0' then
          fail(datalink_error_invalid_character_c);
        elsif r.half = '0' then
          v.half  := '1';
          v.digit := c.value;
        else
          v.half := '0';
          v.sum  := next_checksum(checksum, polynomial, r.sum, pair);
          if r.state = tail then
            if r.checksum_bytes /= 2 then
              v.checksum_bytes := r.checksum_bytes + 1;
            end if;
          else
            keep(byte, pair);
          end if;
        end if;
      end if;
    end if;

    receive <= o;
    r_next  <= v;
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
