-- SPDX-License-Identifier: BSD-3-Clause
-- hall as a current loop uses it: the wire of the angle is read, and only its 16 bits and that it is valid.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wire_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_hall is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    moved        : out std_ulogic;
    failed       : out std_ulogic;
    stopped      : out std_ulogic;
    angle        : out std_ulogic_vector(15 downto 0);
    valid        : out std_ulogic;
    lines        : in  std_ulogic_vector(2 downto 0)
  );
end entity;

architecture rtl of narrow_hall is
  signal angle_wire : wire_t;
begin
  angle <= std_ulogic_vector(value_of(angle_wire)(15 downto 0));
  valid <= is_valid(angle_wire);

  whole : entity unitylink.hall
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, moved => moved,
      failed => failed, stopped => stopped, position_wire => open, angle_wire => angle_wire, velocity_wire => open,
      lines => lines);
end architecture;
