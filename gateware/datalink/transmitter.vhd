-- SPDX-License-Identifier: BSD-3-Clause
--
-- Turns words into characters: digits, checksums and line ends of the classic protocol.
--
-- Ports     word: valid/ready, in the order head, then letters, marks and data, then tail. tx: valid/ready/data, one
--           byte per clock. tx_last marks the last byte of a message, and tx_publish the bytes of a publish. A physical
--           layer that collects bytes can use them to send at once (docs/gateware/ft245_async.md).
-- Latency   The first character of a word comes one clock after the word was valid (an output register).
-- Characters of a word: head, letter, mark, error 1; data 2, or 1 without digits; tail 1, or 4 with a checksum.
-- Checksum  Letters as sent, then data bytes. A message that ends with an error mark has none.
-- Pressure  word_ready waits for tx_ready. Nothing is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity transmitter is
  generic (
    digits     : boolean := true;   -- a byte is sent as two digits; false: as it is
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
    tx_data    : out byte_t;
    tx_last    : out std_ulogic;  -- with tx_data
    tx_publish : out std_ulogic   -- with tx_data
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

  signal place   : unsigned(1 downto 0) := "00";  -- number of the next character of the word
  signal summed  : std_ulogic := '0';  -- the message gets a checksum, and its line end is not next in the tail
  signal sum     : byte_t := crc8_initial_c;
  signal full    : std_ulogic := '0';

  signal free    : std_ulogic;  -- the output register can take a character
  signal several : std_ulogic;  -- the word may have several characters: a byte or a tail
  signal closes  : std_ulogic;  -- if it has several: the word is a tail
  signal last    : std_ulogic;  -- this is the last character of its word
  signal nibble  : std_ulogic_vector(3 downto 0);  -- the value of the digit, if it is one
  signal next_character : byte_t;

begin

  -- Kinds with two or more characters have the highest bit set. The lowest bit distinguishes them.
  several <= word_data(10);
  closes  <= word_data(8);

  free       <= not full or tx_ready;
  tx_valid   <= full;
  word_ready <= free and last;

  finish : process (all)
  begin
    last <= '1';
    if several = '1' and closes = '0' and digits and place(0) = '0' then
      last <= '0';
    elsif several = '1' and closes = '1' and summed = '1' then
      last <= '0';
    end if;
  end process;

  choose : process (all)
  begin
    nibble <= word_data(7 downto 4);
    if closes = '1' then
      nibble <= sum(7 downto 4);
      if place(1) = '1' then
        nibble <= sum(3 downto 0);
      end if;
    elsif place(0) = '1' then
      nibble <= word_data(3 downto 0);
    end if;

    next_character <= word_data(7 downto 0);
    if several = '1' and closes = '0' and digits then
      next_character <= digit(nibble);
    elsif several = '1' and closes = '1' then
      next_character <= digit(nibble);
      if summed = '0' then
        next_character <= byte_line_feed_c;
      elsif place = 0 then
        next_character <= byte_checksum_mark_c;
      end if;
    end if;
  end process;

  send : process (clock)
  begin
    if rising_edge(clock) then
      if free = '1' then
        full <= word_valid;
        if word_valid = '1' then
          tx_data <= next_character;
          tx_last <= several and closes and last;
          place   <= place + 1;
          if last = '1' then
            place <= "00";
          end if;
          case word_data(10 downto 8) is
            when word_head =>
              summed     <= '0';
              tx_publish <= '0';
              if word_data(7 downto 0) = byte_plain_publish_c or word_data(7 downto 0) = byte_checked_publish_c then
                tx_publish <= '1';
              end if;
              if checksum /= "none" and
                  (word_data(7 downto 0) = byte_checked_head_c or word_data(7 downto 0) = byte_checked_publish_c) then
                summed <= '1';
              end if;
              sum <= crc8_initial_c;
            when word_letter =>
              sum <= next_checksum(checksum, polynomial, sum, word_data(7 downto 0));
            when word_byte =>
              if place = 0 then
                sum <= next_checksum(checksum, polynomial, sum, word_data(7 downto 0));
              end if;
            when word_error =>
              summed <= '0';
            when word_tail =>
              if place = 2 then
                summed <= '0';
              end if;
            when others =>
              null;
          end case;
        end if;
      end if;
      if reset = '1' then
        full    <= '0';
        place   <= "00";
        summed  <= '0';
      end if;
    end if;
  end process;

end architecture;
