-- SPDX-License-Identifier: BSD-3-Clause
--
-- What stands on a TosNet line: 8b10b symbols (Widmer and Franaszek, IBM J. Res. Dev. 27(5), 1983), the scrambler and
-- the checksum of a packet. Of the control symbols, only K28.1 and K28.5 exist here.
--
-- A symbol is a vector `j h g f i e d c b a`, with `a`, the first bit on the line, in bit 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_wire_pkg.all;

package tosnet_code_pkg is

  subtype symbol_t is std_ulogic_vector(9 downto 0);

  -- A symbol, and the running disparity after it: '1' if positive.
  type encoded_t is record
    symbol    : symbol_t;
    disparity : std_ulogic;
  end record;

  -- A byte, whether it is a control symbol, and whether its symbol does not exist.
  type decoded_t is record
    data    : byte_t;
    control : std_ulogic;
    wrong   : std_ulogic;
  end record;

  -- `disparity` is the running disparity before the symbol. A control symbol is K28.5 if `data` is that of `begin`, and
  -- K28.1 otherwise.
  function encode (data : byte_t; control : std_ulogic; disparity : std_ulogic) return encoded_t;

  -- The disparity is not looked at. A single bit that is wrong is found by it only later, and by the checksum anyway.
  function decode (symbol : symbol_t) return decoded_t;

  -- K28.5, which stands nowhere else on a line without errors.
  function is_comma (symbol : symbol_t) return boolean;

  -- The scrambler's register in the next byte time. It never leaves zero.
  function next_scramble (scramble : byte_t) return byte_t;

  -- A byte that is scrambled or descrambled by it.
  function scrambled (data : byte_t; scramble : byte_t) return byte_t;

  -- The checksum after one more byte, the most significant bit first. One of 8 bits has the published polynomial
  -- x^8 + x^6 + x^5 + x^2 + 1. It finds any two wrong bits in packets of up to 255 bits. One of 16 bits has
  -- x^16 + x^12 + x^5 + 1, and finds any three wrong bits in packets of up to 32767 bits, which is longer than any.
  function next_sum (sum : std_ulogic_vector; data : byte_t) return std_ulogic_vector;

end package;

package body tosnet_code_pkg is

  subtype six_t  is std_ulogic_vector(5 downto 0); -- i e d c b a
  subtype four_t is std_ulogic_vector(3 downto 0); -- j h g f
  type sixes_t is array (0 to 31) of six_t;
  type fours_t is array (0 to 7) of four_t;

  -- The symbols after a negative disparity. After a positive one, those that are not balanced are inverted.
  constant sixes : sixes_t := (
    "111001", "101110", "101101", "100011", "101011", "100101", "100110", "000111",
    "100111", "101001", "101010", "001011", "101100", "001101", "001110", "111010",
    "110110", "110001", "110010", "010011", "110100", "010101", "010110", "010111",
    "110011", "011001", "011010", "011011", "011100", "011101", "011110", "110101");
  constant six_of_28 : six_t   := "111100"; -- in a control symbol
  constant fours     : fours_t := ("1101", "1001", "1010", "0011", "1011", "0101", "0110", "0111");
  constant other_seven : four_t := "1110"; -- where "0111" would make a run of five
  constant comma     : symbol_t := "0101111100";

  function balanced (bits : std_ulogic_vector) return boolean is
    variable ones : natural range 0 to bits'length := 0;
  begin
    for place in bits'range loop
      if bits(place) = '1' then
        ones := ones + 1;
      end if;
    end loop;
    return 2 * ones = bits'length;
  end function;

  function encode (data : byte_t; control : std_ulogic; disparity : std_ulogic) return encoded_t is
    constant five  : natural range 0 to 31 := to_integer(unsigned(data(4 downto 0)));
    constant three : natural range 0 to 7  := to_integer(unsigned(data(7 downto 5)));
    variable six   : six_t;
    variable four  : four_t;
    variable swap  : boolean;
    variable so_far : std_ulogic := disparity;
  begin
    six  := sixes(five);
    four := fours(three);
    if control = '1' then
      six  := six_of_28;
      four := "1001";
      if data(7) = '1' then
        four := "0101";
      end if;
    end if;

    swap := not balanced(six);
    if disparity = '1' and (swap or (five = 7 and control = '0')) then
      six := not six;
    end if;
    so_far := disparity xor to_bit(swap);

    if three = 7 and control = '0' and ((so_far = '0' and (five = 17 or five = 18 or five = 20))
                                        or (so_far = '1' and (five = 11 or five = 13 or five = 14))) then
      four := other_seven;
    end if;
    swap := not balanced(four);
    if so_far = '1' and (swap or (three = 3 and control = '0')) then
      four := not four;
    elsif so_far = '0' and control = '1' then
      four := not four; -- both are balanced, and belong to a six that was positive
    end if;
    return (symbol => four & six, disparity => so_far xor to_bit(swap));
  end function;

  function is_comma (symbol : symbol_t) return boolean is
  begin
    return symbol = comma or symbol = not comma;
  end function;

  function decode (symbol : symbol_t) return decoded_t is
    constant six    : six_t  := symbol(5 downto 0);
    constant four   : four_t := symbol(9 downto 6);
    variable known  : boolean := false;
    variable result : decoded_t;
  begin
    result := (data => (others => '0'), control => '0', wrong => '1');
    for value in sixes'range loop
      if six = sixes(value) or (six = not sixes(value) and (value = 7 or not balanced(sixes(value)))) then
        result.data(4 downto 0) := std_logic_vector(to_unsigned(value, 5));
        known := true;
      end if;
    end loop;
    if known then
      for value in fours'range loop
        if four = fours(value) or (four = not fours(value) and (value = 3 or not balanced(fours(value)))) then
          result.data(7 downto 5) := std_logic_vector(to_unsigned(value, 3));
          result.wrong := '0';
        end if;
      end loop;
      if four = other_seven or four = not other_seven then
        result.data(7 downto 5) := "111";
        result.wrong := '0';
      end if;
    end if;

    if is_comma(symbol) then
      result := (data => byte_t(to_unsigned(tosnet_wire_begin_c, 8)), control => '1', wrong => '0');
    elsif (six = six_of_28 and four = "1001") or (six = not six_of_28 and four = "0110") then
      result := (data => byte_t(to_unsigned(tosnet_wire_idle_c, 8)), control => '1', wrong => '0');
    end if;
    return result;
  end function;

  function next_scramble (scramble : byte_t) return byte_t is
  begin
    return (scramble(1) xor scramble(0)) & scramble(7 downto 1);
  end function;

  function scrambled (data : byte_t; scramble : byte_t) return byte_t is
  begin
    if scramble = x"00" then
      return not data;
    end if;
    return data xor scramble;
  end function;

  function polynomial (bits : positive) return std_ulogic_vector is
  begin
    if bits = 8 then
      return std_ulogic_vector(to_unsigned(tosnet_wire_crc_polynomial_c, 8));
    end if;
    return std_ulogic_vector(to_unsigned(tosnet_wire_wide_crc_polynomial_c, 16));
  end function;

  function next_sum (sum : std_ulogic_vector; data : byte_t) return std_ulogic_vector is
    constant top      : natural := sum'length - 1;
    constant feedback : std_ulogic_vector(top downto 0) := polynomial(sum'length);
    variable rest     : std_ulogic_vector(top downto 0) := sum;
  begin
    rest(top downto top - 7) := rest(top downto top - 7) xor data;
    for step in 0 to 7 loop
      if rest(top) = '1' then
        rest := (rest(top - 1 downto 0) & '0') xor feedback;
      else
        rest := rest(top - 1 downto 0) & '0';
      end if;
    end loop;
    return rest;
  end function;

end package body;
