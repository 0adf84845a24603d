-- SPDX-License-Identifier: BSD-3-Clause
-- quadrature_encoder as it is in a design without wires: nothing reads them.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_quadrature_encoder is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    indexed      : out std_ulogic;
    failed       : out std_ulogic;
    stopped      : out std_ulogic;
    a            : in  std_ulogic;
    b            : in  std_ulogic
  );
end entity;

architecture rtl of narrow_quadrature_encoder is
begin
  whole : entity unitylink.quadrature_encoder
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, indexed => indexed,
      failed => failed, stopped => stopped, position_wire => open, velocity_wire => open, a => a, b => b);
end architecture;
