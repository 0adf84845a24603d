-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of what stands on a TosNet line, for all symbols, pairs of symbols, sums and bytes at once:
-- tosnet_code_pkg has functions without memory.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.protocol_pkg.all;
use work.tosnet_code_pkg.all;

entity tosnet_code_formal is
  port (
    clk                  : in std_ulogic;
    data, data_after     : in byte_t;
    control, control_after : in std_ulogic; -- the symbol is K28.5 or K28.1
    disparity            : in std_ulogic;
    scramble             : in byte_t;
    sum, other, change   : in byte_t
  );
end entity;

architecture properties of tosnet_code_formal is

  -- Division by x8 + x6 + x5 + x2 + 1, one bit after the other.
  function serial_sum(sum : byte_t; data : byte_t) return byte_t is
    variable rest : byte_t := sum;
    variable top  : std_ulogic;
  begin
    for place in 7 downto 0 loop
      top  := rest(7) xor data(place);
      rest := rest(6) & (rest(5) xor top) & (rest(4) xor top) & rest(3) & rest(2) & (rest(1) xor top) & rest(0) & top;
    end loop;
    return rest;
  end function;

  function ones_of(symbol : symbol_t) return unsigned is
    variable count : unsigned(3 downto 0) := "0000";
  begin
    for place in symbol'range loop
      if symbol(place) = '1' then
        count := count + 1;
      end if;
    end loop;
    return count;
  end function;

  signal one, two : encoded_t;                      -- two symbols on the line
  signal meaning  : decoded_t;
  signal line     : std_ulogic_vector(19 downto 0); -- both, the earlier in the low bits
  signal ones     : unsigned(3 downto 0);
  signal long_run : std_ulogic;                     -- six equal bits
  signal stray    : std_ulogic;                     -- a K28.5 that is part of both symbols
  signal both     : byte_t;                         -- difference of the sums of two different messages

begin

  default clock is rising_edge(clk);

  one     <= encode(data, control, disparity);
  two     <= encode(data_after, control_after, one.disparity);
  meaning <= decode(one.symbol);
  line    <= two.symbol & one.symbol;
  ones    <= ones_of(one.symbol);
  both    <= next_sum(sum, data) xor next_sum(other, data xor change);

  process (all) is
  begin
    long_run <= '0';
    stray    <= '0';
    for place in 0 to 14 loop
      if line(place + 5 downto place) = "000000" or line(place + 5 downto place) = "111111" then
        long_run <= '1';
      end if;
    end loop;
    for place in 1 to 9 loop
      if is_comma(line(place + 9 downto place)) then
        stray <= '1';
      end if;
    end loop;
  end process;

  -- The symbol of a byte means this byte, after each disparity.
  byte_comes_back : assert always control = '0' ->
                    meaning.data = data and meaning.control = '0' and meaning.wrong = '0';

  -- A control symbol means K28.5 or K28.1.
  control_comes_back : assert always control = '1' ->
                       meaning.data(7) = data(7) and meaning.data(6 downto 0) = "0111100" and meaning.control = '1'
                       and meaning.wrong = '0';

  -- After a negative disparity, a symbol has five ones and keeps it, or six and makes it positive.
  rises : assert always disparity = '0' -> (ones = 5 and one.disparity = '0') or (ones = 6 and one.disparity = '1');

  -- After a positive disparity, a symbol has five ones and keeps it, or four and makes it negative.
  falls : assert always disparity = '1' -> (ones = 5 and one.disparity = '1') or (ones = 4 and one.disparity = '0');

  -- In two symbols, at most five equal bits are in a row.
  edges_come : assert always long_run = '0';

  -- A K28.5 never consists of parts of two symbols.
  no_stray_comma : assert always stray = '0';

  -- Of the symbols, only K28.5 is taken for one.
  only_one_comma : assert always to_bit(is_comma(one.symbol)) = (control and data(7));

  -- What is scrambled twice is the byte again.
  unscrambled : assert always scrambled(scrambled(data, scramble), scramble) = data;

  -- The scrambler never stops, once it runs.
  never_stops : assert always scramble /= x"00" -> next_scramble(scramble) /= x"00";

  -- The parallel function of a byte gives the same sum as its bits one by one.
  parallel_is_serial : assert always next_sum(sum, data) = serial_sum(sum, data);

  -- The sum of a difference is the difference of the sums.
  linear : assert always both = next_sum(sum xor other, change);

  -- A message followed by its own sum has the sum zero.
  residue_is_zero : assert always next_sum(sum, sum) = x"00";

  -- A wrong sum stays wrong whatever byte follows, so no byte hides an earlier error.
  error_stays : assert always sum = other or change /= x"00" or both /= x"00";

  -- A wrong byte makes the sum wrong, for any number of wrong bits in any place.
  error_counts : assert always sum /= other or change = x"00" or both /= x"00";

  -- Five equal bits in a row exist.
  run_of_five : cover {line(6 downto 2) = "11111"};

end architecture;
