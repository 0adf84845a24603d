-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the classic transmitter with CRC-8, on any words. A model says which characters a word has. It computes
-- the checksum when a word begins. The function of the checksum has its own proof (crc8).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity transmitter_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    word_valid : in std_ulogic;
    word_data  : in word_t;
    tx_ready   : in std_ulogic
  );
end entity;

architecture properties of transmitter_formal is

  subtype kind_t is std_ulogic_vector(2 downto 0);

  signal word_ready, tx_valid, tx_last, tx_publish : std_ulogic;
  signal tx_data : byte_t;

  signal begun      : std_ulogic := '0';
  signal word_before  : word_t;
  signal held_up    : std_ulogic := '0';             -- a word waited in the clock before

  -- The model.
  signal kind       : kind_t;
  signal data       : byte_t;
  signal number     : natural range 0 to 4 := 0;     -- of the next character of the word
  signal has_sum    : std_ulogic := '0';             -- the message ends with a checksum
  signal publishes  : std_ulogic := '0';
  signal headed     : std_ulogic := '0';             -- a head has been sent since power-up
  signal sum        : byte_t := crc8_initial_c;
  signal count      : natural range 1 to 4;          -- characters of the word
  signal goes_out   : std_ulogic;                    -- a character of the word enters the output register
  signal expected   : byte_t;                        -- that character
  signal promised   : std_ulogic := '0';             -- the output register has a character …
  signal character_out : byte_t;                     -- … this one
  signal is_last    : std_ulogic := '0';
  signal is_publish : std_ulogic := '0';

  -- The ASCII character of a hexadecimal digit.
  function hexadecimal(value : std_ulogic_vector(3 downto 0)) return byte_t is
    variable number : natural range 0 to 15;
  begin
    number := to_integer(unsigned(value));
    if number <= 9 then
      return std_ulogic_vector(to_unsigned(character'pos('0') + number, 8));
    end if;
    return std_ulogic_vector(to_unsigned(character'pos('a') + number - 10, 8));
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.transmitter
    port map (
      clock => clk, reset => reset, word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  kind     <= word_data(10 downto 8);
  data     <= word_data(7 downto 0);
  goes_out <= word_valid and (not promised or tx_ready);

  spell : process (all) is
  begin
    count    <= 1;
    expected <= data;
    if kind = word_byte then
      count    <= 2;
      expected <= hexadecimal(data(7 downto 4));
      if number = 1 then
        expected <= hexadecimal(data(3 downto 0));
      end if;
    elsif kind = word_tail then
      expected <= x"0A";
      if has_sum = '1' then
        count <= 4;
        case number is
          when 0 => expected <= std_ulogic_vector(to_unsigned(character'pos('*'), 8));
          when 1 => expected <= hexadecimal(sum(7 downto 4));
          when 2 => expected <= hexadecimal(sum(3 downto 0));
          when others => null;
        end case;
      end if;
    end if;
  end process;

  model : process (clk) is
  begin
    if rising_edge(clk) then
      begun       <= '1';
      word_before <= word_data;
      held_up     <= word_valid and not word_ready;
      if tx_ready = '1' then
        promised <= '0';
      end if;
      if goes_out = '1' then
        promised      <= '1';
        character_out <= expected;
        is_last       <= to_bit(kind = word_tail and number = count - 1);
        is_publish    <= publishes;
        number        <= number + 1;
        if number = count - 1 then
          number <= 0;
        end if;
        if number = 0 then
          case kind is
            when word_head =>
              headed     <= '1';
              has_sum    <= to_bit(data = x"24" or data = x"26");
              publishes  <= to_bit(data = x"25" or data = x"26");
              is_publish <= to_bit(data = x"25" or data = x"26");
              sum        <= x"00";
            when word_letter | word_byte =>
              sum <= next_checksum("crc8", 7, sum, data);
            when word_error =>
              has_sum <= '0';
            when others =>
              null;
          end case;
        end if;
        if kind = word_tail and number = count - 1 then
          has_sum <= '0';
        end if;
      end if;
      if reset = '1' then
        promised <= '0';
        number   <= 0;
        has_sum  <= '0';
        held_up  <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A word has one of the six kinds.
  kind_is_one : assume always kind /= "110" and kind /= "111";

  -- A word stays the same until it is taken.
  word_stands : assume always held_up = '1' -> word_valid = '1' and word_data = word_before;

  -- A character is on offer exactly if a word has one to send: one per clock, and none is lost, doubled or invented.
  valid_in_time : assert always begun = '1' -> tx_valid = promised;

  -- The character is the one that the word has at this place: itself, a digit, the checksum or the end of the line.
  character_is_right : assert always begun = '1' and tx_valid = '1' -> tx_data = character_out;

  -- A word is taken with its last character, and at no other time.
  taken_with_its_last : assert always begun = '1' and word_valid = '1' ->
                               (word_ready = '1') = (goes_out = '1' and number = count - 1);

  -- The end of a line is marked as the last byte, and no other byte is.
  last_is_marked : assert always begun = '1' and tx_valid = '1' -> tx_last = is_last;

  -- All bytes of a publish are marked, and no others. It is not said before the first head.
  publish_is_marked : assert always begun = '1' and tx_valid = '1' and headed = '1' -> tx_publish = is_publish;

  -- A reset drops the character that waits.
  reset_is_empty : assert always reset = '1' -> next (tx_valid = '0');

  -- A checksum that is not zero is sent.
  sum_seen : cover {tx_valid = '1' and kind = word_tail and number = 3 and sum /= x"00"};

end architecture;
