-- SPDX-License-Identifier: BSD-3-Clause
--
-- Brings bits into a clock domain: two flip-flops against metastability. Every single bit that crosses in the gateware
-- goes through this entity, so a tool that asks for the crossings finds all of them under this name.
--
--   asynchronous --> | first | --> | second | --> levels       both of `clock`, with nothing between them
--
-- Ports        asynchronous: from a pin or from another clock. Each bit is synchronised alone. So bits that belong
--              together may come one clock apart: send a Grey count, or a toggle beside data that stand still.
-- Latency      1 to 2 clocks.
-- Reset        Puts `idle` on all levels. reset may be left open.
-- Power-up     The flip-flops start with `idle`.
-- Constraints  `unitylink build` writes them: the path to `first` is no path of the clock. The attributes below
--              (crossing_pkg) say to each vendor's tool that the two belong together.

library ieee;
  use ieee.std_logic_1164.all;
  use work.crossing_pkg.all;

entity synchroniser is
  generic (
    width : positive   := 1;
    idle  : std_ulogic := '0'
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic := '0'; -- synchronous
    asynchronous : in  std_ulogic_vector(width - 1 downto 0);
    levels       : out std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture rtl of synchroniser is

  signal first, second : std_ulogic_vector(width - 1 downto 0) := (others => idle); -- first may be metastable

  attribute async_reg        of first, second : signal is "true";
  attribute shreg_extract    of first, second : signal is "no";
  attribute preserve         of first, second : signal is true;
  attribute altera_attribute of first, second : signal is altera_crossing_c;
  attribute syn_preserve     of first, second : signal is true;
  attribute syn_srlstyle     of first, second : signal is "registers";

begin

  process (clock) is
  begin
    if rising_edge(clock) then
      first  <= asynchronous;
      second <= first;
      if reset = '1' then
        first  <= (others => idle);
        second <= (others => idle);
      end if;
    end if;
  end process;

  levels <= second;

end architecture;
