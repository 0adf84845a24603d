-- SPDX-License-Identifier: BSD-3-Clause
-- motion_profile as it is in a design: its wires lead to elements of 32 and 24 bits, and its address has 8 bits.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wire_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_motion_profile is
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic;
    cyc, stb, we  : in  std_ulogic;
    adr           : in  std_ulogic_vector(7 downto 0);
    dat           : in  std_ulogic_vector(31 downto 0);
    wishbone_s2m  : out wishbone_s2m_t;
    arrived       : out std_ulogic;
    feedback_wire : in  wire_t;
    position      : out std_ulogic_vector(31 downto 0);
    velocity      : out std_ulogic_vector(23 downto 0);
    acceleration  : out std_ulogic_vector(23 downto 0)
  );
end entity;

architecture rtl of narrow_motion_profile is
  signal wide : wishbone_m2s_t;
  signal position_wire, velocity_wire, acceleration_wire : wire_t;
begin
  wide <= (cyc => cyc, stb => stb, we => we, adr => (31 downto 8 => '0') & adr, dat => dat, sel => (others => '1'));

  position     <= position_wire(31 downto 0);
  velocity     <= velocity_wire(23 downto 0);
  acceleration <= acceleration_wire(23 downto 0);

  whole : entity unitylink.motion_profile
    port map (
      clock => clock, reset => reset, wishbone_m2s => wide, wishbone_s2m => wishbone_s2m, arrived => arrived,
      feedback_wire => feedback_wire, position_wire => position_wire, velocity_wire => velocity_wire,
      acceleration_wire => acceleration_wire);
end architecture;
