-- SPDX-License-Identifier: BSD-3-Clause
--
-- The transmitter of a TosNet line: bytes to symbols, and symbols to bits.
--
--   data/control, taken with `take` --> 8b10b, with its running disparity --> bit `a` first --> line
--
-- Use       A symbol is always on the line. `take` is high in the clock in which `data` and `control` are those of the
--           next one. They may come from a long path: they are registered before they are encoded.
-- Latency   The first bit of the symbol is on the line 2 * clocks_per_bit clocks after that of `take`. A symbol is
--           10 * clocks_per_bit clocks long.
-- Reset     The line sends the symbol of zero bits, which does not exist, for at most a symbol's time.

library ieee;
  use ieee.std_logic_1164.all;
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
    line    : out std_ulogic
  );
end entity;

architecture rtl of tosnet_line_out is

  signal passed      : natural range 0 to clocks_per_bit - 1 := 0;
  signal place       : natural range 0 to 9 := 0;
  signal bit_ends    : std_ulogic;
  signal shift       : symbol_t;
  signal disparity   : std_ulogic;
  signal now_data    : byte_t;
  signal now_control : std_ulogic;
  signal encoded     : encoded_t; -- the next symbol

begin

  bit_ends <= to_bit(passed = clocks_per_bit - 1);
  take     <= bit_ends and to_bit(place = 7);
  line     <= shift(0);

  process (clock) is
  begin
    if rising_edge(clock) then
      if bit_ends = '0' then
        passed <= passed + 1;
      else
        passed <= 0;
        if place = 8 then
          encoded <= encode(now_data, now_control, disparity);
        end if;
        if place < 9 then
          place <= place + 1;
          shift <= '0' & shift(9 downto 1);
        else
          place     <= 0;
          shift     <= encoded.symbol;
          disparity <= encoded.disparity;
        end if;
      end if;
      if take = '1' then
        now_data    <= data;
        now_control <= control;
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
