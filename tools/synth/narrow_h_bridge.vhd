-- SPDX-License-Identifier: BSD-3-Clause
-- h_bridge as it is in a design without wires: its duty is that of the register.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_h_bridge is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    tripped      : out std_ulogic;
    fault        : in  std_ulogic;
    pins         : out std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of narrow_h_bridge is
begin
  whole : entity unitylink.h_bridge
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, tripped => tripped,
      fault => fault, pins => pins);
end architecture;
