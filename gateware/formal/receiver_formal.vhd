-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the classic deframer, decoder and receiver together, on any bytes. They compare its events with the
-- bytes that came.

library ieee;
  use ieee.std_logic_1164.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity receiver_formal is
  generic (
    message_entries : positive := 5
  );
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    rx_valid : in std_ulogic;
    rx_data  : in byte_t;
    rx_error : in std_ulogic_vector(2 downto 0);
    room     : in std_ulogic
  );
end entity;

architecture properties of receiver_formal is

  signal rx_ready  : std_ulogic;
  signal valid     : std_ulogic;
  signal ready     : std_ulogic;
  signal c         : character_t;
  signal receive   : receive_t;
  signal told     : receive_event_t;
  signal begun     : std_ulogic := '0';
  signal taken     : std_ulogic;          -- a character was taken
  signal troubled  : std_ulogic := '0';   -- a physical error came and is not yet reported

  -- The message, rebuilt from the bytes and the events.
  signal underway     : std_ulogic := '0';   -- a message has begun and not ended
  signal colon_met : std_ulogic := '0';
  signal star_met  : std_ulogic := '0';
  signal checked   : std_ulogic := '0';
  signal half      : std_ulogic := '0';   -- the first digit of a pair has come
  signal digit     : std_ulogic_vector(3 downto 0) := "0000";
  signal sum       : byte_t := x"00";     -- of the letters and bytes reported
  signal entries   : natural range 0 to message_entries + 1 := 0;
  signal summed    : natural range 0 to 2 := 0;  -- checksum bytes so far; 2 means too many
  signal agrees    : std_ulogic := '0';   -- the checksum byte equals the sum

begin

  default clock is rising_edge(clk);

  classify : entity work.decoder
    port map (
      clock => clk, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => valid, character_ready => ready, character_data => c);

  dut : entity work.receiver
    generic map (message_entries => message_entries)
    port map (
      clock => clk, reset => reset, character_valid => valid, character_ready => ready, character_data => c,
      rx_error => rx_error, room => room, receive => receive);

  told <= receive.event;
  taken <= valid and ready;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if (or rx_error) = '1' then
        troubled <= '1';
      elsif told = bad then
        troubled <= '0';
      end if;

      if taken = '1' and underway = '1' then
        half  <= c.digit and not half and (colon_met or star_met);
        digit <= c.value;
        if c.star = '1' then
          star_met <= '1';
        end if;
        if star_met = '1' and half = '1' and c.digit = '1' then
          if sum = (digit & c.value) then
            agrees <= '1';
          else
            agrees <= '0';
          end if;
          if summed < 2 then
            summed <= summed + 1;
          end if;
        end if;
      end if;

      case told is
        when start =>
          underway     <= '1';
          colon_met <= '0';
          star_met  <= '0';
          half      <= '0';
          checked   <= receive.checked;
          sum       <= x"00";
          summed    <= 0;
          entries   <= 1;
        when letter | byte =>
          sum <= next_checksum("crc8", 7, sum, receive.data);
          if entries <= message_entries then
            entries <= entries + 1;
          end if;
        when colon =>
          colon_met <= '1';
          if entries <= message_entries then
            entries <= entries + 1;
          end if;
        when good | bad =>
          underway <= '0';
        when nothing =>
          null;
      end case;
      if reset = '1' then
        underway    <= '0';
        troubled <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A message is a start, letters, a colon, bytes, and one end. None of them comes outside a message.
  inside_a_message : assert always begun = '0' or
                     (told /= letter and told /= colon and told /= byte and told /= good) or underway = '1';

  -- A message begins only after the one before has ended.
  one_at_a_time : assert always begun = '0' or told /= start or underway = '0';

  -- Letters come before the colon, and bytes after it. Neither comes after the star.
  in_order : assert always begun = '0' or ((told /= letter and told /= colon) or
                      (colon_met = '0' and star_met = '0')) and
             (told /= byte or (colon_met = '1' and star_met = '0'));

  -- The end of a line ends the message in the same clock, whatever came before: it is good or bad.
  line_end_ends : assert always begun = '0' or underway = '0' or taken = '0' or c.line_end = '0' or
                  told = good or told = bad;

  -- A good checked message had a star and one checksum byte, the sum of its letters and bytes. Or it had nothing to
  -- sum, and no checksum.
  good_is_checked : assert always begun = '0' or told /= good or checked = '0' or
                    (star_met = '1' and ((summed = 1 and agrees = '1') or (summed = 0 and entries <= 2)));

  -- A good message ends with the end of a line, and has no half pair of digits.
  good_is_whole : assert always begun = '0' or told /= good or (taken = '1' and c.line_end = '1' and half = '0');

  -- A message has fewer entries than `message_entries`, also while it is under way.
  never_too_long : assert always begun = '0' or underway = '0' or entries < message_entries;

  -- A reported byte is the value of its two digits. A reported letter is the character itself.
  data_is_what_came : assert always begun = '0' or (told /= byte or (half = '1' and receive.data = digit & c.value)) and
                      (told /= letter or receive.data = c.data);

  -- Without room, no message begins, and no error is reported outside a message.
  needs_room : assert always begun = '0' or underway = '1' or (told /= start and told /= bad) or room = '1';

  -- An event comes only with a character or with a physical error.
  has_a_cause : assert always begun = '0' or told = nothing or taken = '1' or (told = bad and troubled = '1');

  -- A message with a physical error is never good.
  trouble_breaks : assert always begun = '0' or troubled = '0' or told /= good;

  -- Inside a message no character waits, except for the report of a physical error.
  no_waiting : assert always begun = '0' or underway = '0' or ready = '1' or troubled = '1';

  -- A checked message with a byte is good.
  good_seen : cover {told = good and checked = '1' and summed = 1};

  -- A message is bad because of its sum.
  sum_seen : cover {told = bad and receive.data = x"F4"};

  -- A message is too long.
  long_seen : cover {told = bad and receive.data = x"F0"};

end architecture;
