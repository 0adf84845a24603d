-- SPDX-License-Identifier: BSD-3-Clause
--
-- The reset of a design: begins at any moment, ends with the clock, and comes by itself at power-up.
--
-- Ports     asynchronous_reset: a button or a "power good", active high, from any clock or none. reset: synchronous.
-- Latency   reset rises at once and falls `clocks` clocks after asynchronous_reset did, or after the first clock of all.
-- Power-up  Relies on flip-flops that start at zero, as they do in every FPGA that is configured.

library ieee;
  use ieee.std_logic_1164.all;

entity reset_synchroniser is
  generic (
    clocks : positive range 2 to 64 := 8 -- 5 is the least for quadrature_encoder to take its pins as they are
  );
  port (
    clock              : in  std_ulogic;
    asynchronous_reset : in  std_ulogic := '0';
    reset              : out std_ulogic
  );
end entity;

architecture rtl of reset_synchroniser is

  signal over : std_ulogic_vector(clocks - 1 downto 0) := (others => '0'); -- ones come in from the right

begin

  process (clock, asynchronous_reset) is
  begin
    if asynchronous_reset = '1' then
      over <= (others => '0');
    elsif rising_edge(clock) then
      over <= over(clocks - 2 downto 0) & '1';
    end if;
  end process;

  reset <= not over(clocks - 1);

end architecture;
