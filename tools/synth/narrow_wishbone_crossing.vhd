-- SPDX-License-Identifier: BSD-3-Clause
-- wishbone_crossing with as many pins as a chip has: addresses of 8 bits, whole words only.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_wishbone_crossing is
  port (
    master_clock, master_reset : in std_ulogic;
    slave_clock, slave_reset   : in std_ulogic;
    master_cyc, master_stb, master_we : in std_ulogic;
    master_adr : in  std_ulogic_vector(7 downto 0);
    master_dat : in  std_ulogic_vector(31 downto 0);
    master_s2m : out wishbone_s2m_t;
    slave_cyc, slave_stb, slave_we : out std_ulogic;
    slave_adr  : out std_ulogic_vector(7 downto 0);
    slave_dat  : out std_ulogic_vector(31 downto 0);
    slave_s2m  : in  wishbone_s2m_t
  );
end entity;

architecture rtl of narrow_wishbone_crossing is
  signal m2s, wide : wishbone_m2s_t;
begin
  m2s <= (
    cyc => master_cyc, stb => master_stb, we => master_we, adr => x"000000" & master_adr, dat => master_dat,
    sel => "1111");
  slave_cyc <= wide.cyc;
  slave_stb <= wide.stb;
  slave_we  <= wide.we;
  slave_adr <= wide.adr(7 downto 0);
  slave_dat <= wide.dat;

  whole : entity unitylink.wishbone_crossing
    port map (
      master_clock => master_clock, master_reset => master_reset, master_m2s => m2s, master_s2m => master_s2m,
      slave_clock => slave_clock, slave_reset => slave_reset, slave_m2s => wide, slave_s2m => slave_s2m);
end architecture;
