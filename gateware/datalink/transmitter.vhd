-- SPDX-License-Identifier: BSD-3-Clause
--
-- Words to characters: digits, checksums and line ends of the classic protocol.
--
-- Ports     word: valid/ready, in the order head, letters and marks and data, tail. tx: valid/ready/data, one byte a clock.
-- Latency   The first character of a word stands one clock after the word was valid (an output register).
-- Characters of a word: head, letter, mark, error 1; data 2, without digits 1; tail 1, with a checksum 4.
-- Checksum  Letters as sent, then data bytes. A message that ends in an error mark has none.
-- Pressure  word_ready waits for tx_ready; nothing is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity transmitter is
  generic (
    digits     : boolean := true;   -- a byte goes as two digits; false: as it is
    checksum   : string := "crc8";  -- "crc8", "xor" or "none"
    polynomial : natural range 0 to 255 := to_integer(unsigned(crc8_polynomial_c))
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic;
    word_valid : in  std_ulogic;
    word_ready : out std_ulogic;
    word_data  : in  word_t;
    tx_valid   : out std_ulogic;
    tx_ready   : in  std_ulogic;
    tx_data    : out byte_t
  );
end entity;

architecture rtl of transmitter is

  function digit(value : std_ulogic_vector(3 downto 0)) return byte_t is
  begin
    if unsigned(value) < 10 then
      return "0011" & value;
    end if;
    return byte_t(unsigned(std_ulogic_vector'("0110" & value)) - 9);
  end function;

  signal place   : unsigned(1 downto 0) := "00";  -- which character of the word is next
  signal checked : std_ulogic := '0';
  signal sum     : byte_t := crc8_initial_c;
  signal full    : std_ulogic := '0';

  signal free : std_ulogic;  -- the output register takes a character
  signal next_character : byte_t;
  signal last : std_ulogic;  -- it is the last one of its word

begin

  free       <= not full or tx_ready;
  tx_valid   <= full;
  word_ready <= free and last;

  choose : process (all)
  begin
    last           <= '1';
    next_character <= word_data(7 downto 0);
    case word_data(10 downto 8) is
      when word_byte =>
        if not digits then
          null;
        elsif place = 0 then
          last           <= '0';
          next_character <= digit(word_data(7 downto 4));
        else
          next_character <= digit(word_data(3 downto 0));
        end if;
      when word_tail =>
        next_character <= byte_line_feed_c;
        if checked = '1' and checksum /= "none" then
          case place is
            when "00" =>
              last           <= '0';
              next_character <= byte_checksum_mark_c;
            when "01" =>
              last           <= '0';
              next_character <= digit(sum(7 downto 4));
            when "10" =>
              last           <= '0';
              next_character <= digit(sum(3 downto 0));
            when others =>
              null;
          end case;
        end if;
      when others =>
        null;
    end case;
  end process;

  send : process (clock)
  begin
    if rising_edge(clock) then
      if free = '1' then
        full <= word_valid;
        if word_valid = '1' then
          tx_data <= next_character;
          if last = '1' then
            place <= "00";
            case word_data(10 downto 8) is
              when word_head =>
                checked <= '0';
                if word_data(7 downto 0) = byte_checked_head_c or word_data(7 downto 0) = byte_checked_publish_c then
                  checked <= '1';
                end if;
                sum <= crc8_initial_c;
              when word_letter | word_byte =>
                sum <= next_checksum(checksum, polynomial, sum, word_data(7 downto 0));
              when word_error =>
                checked <= '0';
              when others =>
                null;
            end case;
          else
            place <= place + 1;
          end if;
        end if;
      end if;
      if reset = '1' then
        full    <= '0';
        place   <= "00";
        checked <= '0';
      end if;
    end if;
  end process;

end architecture;
