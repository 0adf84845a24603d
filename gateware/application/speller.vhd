-- SPDX-License-Identifier: BSD-3-Clause
--
-- Spells the tokens of a reply as words for the datalink: a text token becomes its letters and marks.
--
-- Latency   None: the first word of a token stands in the same clock; one word a clock.
-- Pressure  valid/ready on both sides.
-- Errors    None; a reply text that does not exist cannot be asked for.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity speller is
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    token_valid : in  std_ulogic;
    token_ready : out std_ulogic;
    token_data  : in  token_t;
    word_valid  : out std_ulogic;
    word_ready  : in  std_ulogic;
    word_data   : out word_t
  );
end entity;

architecture rtl of speller is

  -- Eight places a text, the character in the low seven bits and the last one marked by bit 7.
  type letters_t is array (natural range <>) of byte_t;

  function spell(text : string) return letters_t is
    variable letters : letters_t(0 to 7) := (others => x"00");
  begin
    for place in 1 to text'length loop
      letters(place - 1) := byte_t(to_unsigned(character'pos(text(place)), 8));
    end loop;
    letters(text'length - 1)(7) := '1';
    return letters;
  end function;

  function spell_all return letters_t is
    variable letters : letters_t(0 to 8 * 32 - 1) := (others => x"00");
  begin
    for text in text_t loop
      letters(8 * text_t'pos(text) to 8 * text_t'pos(text) + 7) := spell(spelling(text));
    end loop;
    return letters;
  end function;

  constant letters : letters_t(0 to 8 * 32 - 1) := spell_all;

  signal place : unsigned(2 downto 0) := (others => '0');
  signal entry : byte_t;  -- of the letters

begin

  entry <= letters(to_integer(unsigned(token_data(4 downto 0)) & place));

  choose : process (all)
    variable letter : byte_t;
  begin
    word_data   <= (others => '0');
    letter      := (others => '0');
    token_ready <= word_ready;
    case token_data(9 downto 8) is
      when token_head =>
        word_data <= word_head & token_data(7 downto 0);
      when token_byte =>
        word_data <= word_byte & token_data(7 downto 0);
      when token_tail =>
        word_data <= word_tail & token_data(7 downto 0);
      when others =>
        letter      := '0' & entry(6 downto 0);
        token_ready <= word_ready and entry(7);
        if letter = byte_data_mark_c or letter = byte_field_separator_c then
          word_data <= word_mark & letter;
        elsif letter = byte_error_mark_c then
          word_data <= word_error & letter;
        else
          word_data <= word_letter & letter;
        end if;
    end case;
  end process;

  word_valid <= token_valid;

  step : process (clock)
  begin
    if rising_edge(clock) then
      if token_valid = '1' and word_ready = '1' and token_data(9 downto 8) = token_text then
        if entry(7) = '1' then
          place <= (others => '0');
        else
          place <= place + 1;
        end if;
      end if;
      if reset = '1' then
        place <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
