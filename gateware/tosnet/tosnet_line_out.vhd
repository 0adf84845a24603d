-- SPDX-License-Identifier: BSD-3-Clause
--
-- The transmitter of a TosNet line: bytes to symbols, and symbols to bits.
--
--   data/control, taken with `take` --> 8b10b, with its running disparity --> bit `a` first --> line
--
-- Use       A symbol is always on the line. `take` is high in the clock in which `data` and `control` are those of the
--           next one.
-- Cut       `cut` is high, and data and control are those of a symbol that begins at once: the one on the line ends
--           early. Its first bit is on the line two clocks later.
-- Latency   The first bit of the symbol is on the line 2 * clocks_per_bit clocks after that of `take`. A symbol is
--           10 * clocks_per_bit clocks long.
-- Reset     The line sends the symbol of zero bits, which does not exist, for at most a symbol's time.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;

entity tosnet_line_out is
  generic (
    clocks_per_bit : positive := 4
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    take    : out std_ulogic;
    data    : in  byte_t;
    control : in  std_ulogic;
    cut     : in  std_ulogic := '0';
    line    : out std_ulogic
  );
end entity;

architecture rtl of tosnet_line_out is

  -- All symbols, for a byte or a control symbol: the one after a negative disparity, the bits that differ from it
  -- after a positive one (`j` and `f`, `h` and `g`, all others), and whether it changes the disparity. This becomes
  -- block RAM.
  subtype code_t is std_ulogic_vector(13 downto 0);
  type codes_t is array (0 to 511) of code_t;

  function all_codes return codes_t is
    variable index      : unsigned(8 downto 0);
    variable minus, plus : encoded_t;
    variable differ     : symbol_t;
    variable codes      : codes_t;
  begin
    for number in codes'range loop
      index  := to_unsigned(number, 9);
      minus  := encode(byte_t(index(7 downto 0)), index(8), '0');
      plus   := encode(byte_t(index(7 downto 0)), index(8), '1');
      differ := minus.symbol xor plus.symbol;
      codes(number) := minus.symbol & differ(6) & differ(7) & differ(0) & minus.disparity;
    end loop;
    return codes;
  end function;

  constant codes : codes_t := all_codes;

  signal passed    : natural range 0 to maximum(1, clocks_per_bit - 1) := 0; -- GHDL needs a bit of it to synthesise
  signal place     : natural range 0 to 9 := 0;
  signal bit_ends  : std_ulogic;
  signal shift     : symbol_t;
  signal disparity : std_ulogic;
  signal code      : code_t; -- of the next symbol
  signal differ    : symbol_t;

begin

  bit_ends <= to_bit(passed = clocks_per_bit - 1);
  take     <= bit_ends and to_bit(place = 7);
  line     <= shift(0);
  differ   <= (9 => code(3), 8 => code(2), 7 => code(2), 6 => code(3), 5 downto 0 => code(1));

  process (clock) is
  begin
    if rising_edge(clock) then
      if bit_ends = '0' then
        passed <= passed + 1;
      else
        passed <= 0;
        if place < 9 then
          place <= place + 1;
          shift <= '0' & shift(9 downto 1);
        else
          place     <= 0;
          shift     <= code(13 downto 4) xor (differ and (9 downto 0 => disparity));
          disparity <= disparity xor code(0);
        end if;
      end if;
      if (take or cut) = '1' then
        code <= codes(to_integer(unsigned(control & data)));
      end if;
      if cut = '1' then
        passed <= clocks_per_bit - 1;
        place  <= 9;
      end if;
      if reset = '1' then
        passed    <= 0;
        place     <= 0;
        shift     <= (others => '0');
        disparity <= '0';
      end if;
    end if;
  end process;

end architecture;
