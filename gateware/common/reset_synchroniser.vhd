-- SPDX-License-Identifier: BSD-3-Clause
--
-- The reset of a design. It begins at any moment, ends with the clock, and comes by itself at power-up.
--
-- Ports     asynchronous_reset: a button or a "power good", active high, from any clock or none. reset: synchronous.
-- Latency   reset rises at once. It falls `clocks` clocks after asynchronous_reset fell, or after the first clock.
-- Power-up  The flip-flops must start at zero. They do so in every FPGA that is configured.

library ieee;
  use ieee.std_logic_1164.all;
  use work.crossing_pkg.all;

entity reset_synchroniser is
  generic (
    clocks : positive range 2 to 64 := 8 -- quadrature_encoder needs at least 5 to see its pins right
  );
  port (
    clock              : in  std_ulogic;
    asynchronous_reset : in  std_ulogic := '0';
    reset              : out std_ulogic
  );
end entity;

architecture rtl of reset_synchroniser is

  signal reset_over : std_ulogic_vector(clocks - 1 downto 0) := (others => '0'); -- ones come in from the right

  attribute async_reg        of reset_over : signal is "true";
  attribute shreg_extract    of reset_over : signal is "no";
  attribute preserve         of reset_over : signal is true;
  attribute altera_attribute of reset_over : signal is altera_crossing_c;
  attribute syn_preserve     of reset_over : signal is true;
  attribute syn_srlstyle     of reset_over : signal is "registers";

begin

  process (clock, asynchronous_reset) is
  begin
    if asynchronous_reset = '1' then
      reset_over <= (others => '0');
    elsif rising_edge(clock) then
      reset_over <= reset_over(clocks - 2 downto 0) & '1';
    end if;
  end process;

  reset <= not reset_over(clocks - 1);

end architecture;
