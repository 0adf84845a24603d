-- SPDX-License-Identifier: BSD-3-Clause
--
-- Turns characters into messages, and checks the form, the length and the checksum of the classic protocol.
--
--   idle --#,$--> letters --:--> data --*--> checksum --LF--> idle       on any error: bad, and idle
--
-- Ports     `receive` says what each character was, in the clock in which it is taken. It has no ready, so it must be
--           taken at once. A message is valid only after `good`. After `bad` there was no message. `room` must be high
--           when a new message can be kept. Between messages the receiver waits for it.
-- Latency   None. One character per clock.
-- Errors    The codes of docs/classic-protocol.md section 4. An error drops only its own message: no buffer is flushed,
--           and everything up to the next head is skipped. Physical errors wait until they can be reported. Those that
--           come meanwhile are merged.
-- Checksum  Exactly one byte after a star. The empty message may have an empty checksum. With checksum "none" a checked
--           message is refused at its head (f1).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity receiver is
  generic (
    message_entries : positive;              -- head, letters, colon and data bytes together must be fewer
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

  -- The part of the message: one of these, or none between messages.
  signal in_letters : std_ulogic := '0';  -- letters of the command; ends with colon, star or line end
  signal in_data    : std_ulogic := '0';  -- digits of the data; ends with star or line end
  signal in_tail    : std_ulogic := '0';  -- digits of the checksum; ends with the line end

  signal checked        : std_ulogic := '0';
  signal half           : std_ulogic := '0';            -- the first digit of a pair is in `digit`
  signal digit          : std_ulogic_vector(3 downto 0) := (others => '0');
  signal sum            : byte_t := crc8_initial_c;
  signal entries        : natural range 0 to message_entries := 0;
  signal filled         : std_ulogic := '0';            -- there is room for no more entries
  signal some, several  : std_ulogic := '0';            -- entries after the head: any, more than one
  signal checksum_bytes : natural range 0 to 2 := 0;    -- 2 means too many
  signal physical       : std_ulogic_vector(2 downto 0) := "000";  -- errors not yet reported

  signal c         : character_t;
  signal inside    : std_ulogic;                     -- inside a message
  signal tells     : std_ulogic;                     -- a physical error is reported
  signal judges    : std_ulogic;                     -- a character of a message is checked
  signal starts    : std_ulogic;                     -- a message starts
  signal pairs     : std_ulogic;                     -- the character is the second digit of a byte
  signal keeps     : std_ulogic;                     -- the character makes an entry
  signal fails     : std_ulogic;                     -- the message fails with `code`
  signal code      : std_ulogic_vector(3 downto 0);  -- the low digit of the error code

begin

  assert checksum = "crc8" or checksum = "xor" or checksum = "none"
    report "receiver: checksum must be crc8, xor or none" severity failure;

  c      <= character_data;
  inside <= in_letters or in_data or in_tail;
  tells  <= or physical and (inside or room);
  judges <= character_valid and inside and nor physical;
  starts <= character_valid and c.request and not inside and room and nor physical and
            not (to_bit(checksum = "none") and c.checked);
  pairs  <= half and c.digit;
  keeps  <= (in_letters and (c.letter or c.colon)) or (in_data and pairs);

  character_ready <= nor physical and (inside or room);

  judge : process (all)
    variable odd, unsummed, stray, alien : std_ulogic;
  begin
    odd   := half and not c.digit;
    stray := c.request or c.publish or (c.colon and not in_letters) or (c.star and (not checked or in_tail));
    alien := not (c.line_end or c.separator or c.colon or c.star or (in_letters and c.letter) or
                  (not in_letters and c.digit));
    -- At most one entry, and a sum of zero. That is at most a colon, because one letter never has the sum zero.
    unsummed := checked and (not in_tail or or sum or
                             to_bit(checksum_bytes /= 1 and (checksum_bytes /= 0 or several = '1')));

    fails <= '0';
    code  <= datalink_error_message_too_long_c(3 downto 0);
    if or physical = '1' then
      fails <= tells;
      code  <= std_ulogic_vector(unsigned(datalink_error_physical_c(3 downto 0)) + unsigned(physical));
    elsif inside = '0' then
      fails <= character_valid and room and (c.publish or (to_bit(checksum = "none") and c.checked));
      code  <= datalink_error_format_c(3 downto 0);
    else
      fails <= character_valid and
               (odd or stray or alien or (c.line_end and unsummed) or (keeps and filled));
      if odd = '1' then
        code <= datalink_error_invalid_character_c(3 downto 0);
        if (c.request or c.publish or c.line_end or c.colon or c.star) = '1' then
          code <= datalink_error_odd_digits_c(3 downto 0);
        end if;
      elsif c.line_end = '1' then
        code <= datalink_error_checksum_c(3 downto 0);
      elsif stray = '1' then
        code <= datalink_error_format_c(3 downto 0);
      elsif alien = '1' then
        code <= datalink_error_invalid_character_c(3 downto 0);
      end if;
    end if;
  end process;

  tell : process (all)
  begin
    receive.event   <= nothing;
    receive.checked <= c.checked;
    receive.data    <= digit & c.value;
    if in_letters = '1' then
      receive.data <= c.data;
    end if;
    if fails = '1' then
      receive.event <= bad;
      receive.data  <= datalink_error_message_too_long_c(7 downto 4) & code;
    elsif starts = '1' then
      receive.event <= start;
    elsif judges = '1' then
      if c.line_end = '1' then
        receive.event <= good;
      elsif in_letters = '1' and c.colon = '1' then
        receive.event <= colon;
      elsif in_letters = '1' and c.letter = '1' then
        receive.event <= letter;
      elsif in_data = '1' and pairs = '1' then
        receive.event <= byte;
      end if;
    end if;
  end process;

  -- The counts and sums of a failed message are not used. So nothing here waits for the decision.
  count : process (clock)
  begin
    if rising_edge(clock) then
      if character_valid = '1' then
        digit <= c.value;
      end if;
      if inside = '0' then
        checked        <= c.checked;
        half           <= '0';
        sum            <= crc8_initial_c;
        entries        <= 1;
        filled         <= to_bit(message_entries = 2);
        some           <= '0';
        several        <= '0';
        checksum_bytes <= 0;
      elsif judges = '1' then
        half <= c.digit and not half and not in_letters;
        if in_letters = '1' and c.letter = '1' then
          sum <= next_checksum(checksum, polynomial, sum, c.data);  -- the letter as sent: upper and lower case differ
        elsif pairs = '1' then
          sum <= next_checksum(checksum, polynomial, sum, digit & c.value);
        end if;
        if keeps = '1' then
          entries <= entries + 1;
          filled  <= to_bit(entries = message_entries - 2);
          some    <= '1';
          several <= some;
        end if;
        if in_tail = '1' and pairs = '1' and checksum_bytes /= 2 then
          checksum_bytes <= checksum_bytes + 1;
        end if;
      end if;
    end if;
  end process;

  step : process (clock)
  begin
    if rising_edge(clock) then
      physical <= physical or rx_error;
      if tells = '1' then
        physical <= rx_error;
      end if;
      if starts = '1' then
        in_letters <= '1';
      elsif judges = '1' and c.colon = '1' then
        in_letters <= '0';
        in_data    <= '1';
      elsif judges = '1' and c.star = '1' then
        in_letters <= '0';
        in_data    <= '0';
        in_tail    <= '1';
      end if;
      if fails = '1' or (judges = '1' and c.line_end = '1') or reset = '1' then
        in_letters <= '0';
        in_data    <= '0';
        in_tail    <= '0';
      end if;
      if reset = '1' then
        physical <= "000";
      end if;
    end if;
  end process;

end architecture;
