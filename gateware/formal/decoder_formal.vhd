-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the decoder of the classic datalink, on any bytes. The meanings are stated by the numbers of the ASCII
-- characters, not as the design finds them.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity decoder_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    rx_valid : in std_ulogic;
    rx_data  : in byte_t;
    ready    : in std_ulogic;
    mark     : in std_ulogic  -- follow the byte that comes
  );
end entity;

architecture properties of decoder_formal is

  signal rx_ready : std_ulogic;
  signal valid    : std_ulogic;
  signal comes    : std_ulogic;
  signal goes     : std_ulogic;
  signal c        : character_t;
  signal code     : natural range 0 to 255;
  signal capital  : natural range 0 to 255;  -- a small letter counts as its capital
  signal meanings : unsigned(2 downto 0);    -- a digit that is a letter counts once
  signal begun    : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  dut : entity work.decoder
    port map (
      clock => clk, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => valid, character_ready => ready, character_data => c);

  comes <= rx_valid and rx_ready;
  goes  <= valid and ready;
  code  <= to_integer(unsigned(c.data));

  bytes : entity work.order_view
    generic map (width => 8, most => 1)
    port map (
      clk => clk, reset => reset, comes => comes, came => rx_data, mark => mark, offered => valid, goes => goes,
      word => c.data);

  read : process (all) is
    variable count : unsigned(2 downto 0);
  begin
    capital <= code;
    if code >= 97 and code <= 122 then
      capital <= code - 32;
    end if;
    count := (others => '0');
    for number in 0 to 5 loop
      if (number = 0 and c.request = '1') or (number = 1 and c.publish = '1') or (number = 2 and c.colon = '1') or
          (number = 3 and c.star = '1') or (number = 4 and c.line_end = '1') or (number = 5 and c.separator = '1') then
        count := count + 1;
      end if;
    end loop;
    if (c.letter or c.digit) = '1' then
      count := count + 1;
    end if;
    meanings <= count;
  end process;

  start : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A byte comes in whenever the one before can leave: one byte per clock.
  never_idle : assert always begun = '1' and valid = '0' -> rx_ready = '1';

  -- While the character waits, no byte is taken.
  holds_one : assert always begun = '1' and valid = '1' and ready = '0' -> rx_ready = '0';

  -- # and $ begin a request, and $ one with a checksum. % and & begin a publish.
  heads_known : assert always valid = '1' ->
                       ((c.request = '1') = (code = character'pos('#') or code = character'pos('$'))) and
                       ((c.checked = '1') = (code = character'pos('$'))) and
                       ((c.publish = '1') = (code = character'pos('%') or code = character'pos('&')));

  -- A colon stands before data, and a star before a checksum.
  marks_known : assert always valid = '1' ->
                       ((c.colon = '1') = (code = character'pos(':'))) and
                       ((c.star = '1') = (code = character'pos('*')));

  -- A letter is A to Z, small or capital.
  letters_known : assert always valid = '1' -> (c.letter = '1') = (capital >= 65 and capital <= 90);

  -- A digit is 0 to 9 or A to F, small or capital.
  digits_known : assert always valid = '1' ->
                        (c.digit = '1') = ((code >= 48 and code <= 57) or (capital >= 65 and capital <= 70));

  -- The value of a digit is the one that it stands for.
  values_known : assert always valid = '1' and c.digit = '1' ->
                        to_integer(unsigned(c.value)) = (code - 48) mod 256 or
                        (capital >= 65 and to_integer(unsigned(c.value)) = capital - 55);

  -- A line ends with a line feed or a carriage return. Tab, blank, comma and point separate.
  gaps_known : assert always valid = '1' ->
                      ((c.line_end = '1') = (code = 10 or code = 13)) and
                      ((c.separator = '1') = (code = 9 or code = 32 or code = 44 or code = 46));

  -- A byte has one meaning, or none. Only a letter may be a digit, too.
  one_meaning : assert always valid = '1' -> meanings <= 1;

  -- A reset drops the character.
  reset_is_empty : assert always reset = '1' -> next (valid = '0');

  -- Two characters come in two clocks.
  flows : cover {comes = '1' and goes = '1'};

end architecture;
