-- SPDX-License-Identifier: BSD-3-Clause
-- Everything GHDL 2.0 prints wrongly, in a few lines.
library ieee;
  use ieee.std_logic_1164.all;

entity small is
  generic (other : std_ulogic := '1');
  port (
    clock  : in  std_ulogic;
    choice : in  std_ulogic_vector(1 downto 0);
    word   : in  std_ulogic_vector(7 downto 0);
    chosen : out std_ulogic_vector(7 downto 0);
    wide   : out std_ulogic_vector(39 downto 0));
end entity;

architecture rtl of small is
begin

  work_on : process (clock)
  begin
    if rising_edge(clock) then
      case choice is
        when "00"   => chosen <= x"01"; wide <= x"123456789A";
        when "01"   => chosen <= x"02";
        when others => chosen <= word; wide <= x"FEDCBA9876";
      end case;
    end if;
  end process;

end architecture;
