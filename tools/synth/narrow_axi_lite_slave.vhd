-- SPDX-License-Identifier: BSD-3-Clause
-- axi_lite_slave with as many pins as a chip has: addresses of 8 bits, whole words only.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.axi_lite_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_axi_lite_slave is
  port (
    clock          : in  std_ulogic;
    reset          : in  std_ulogic;
    awvalid, wvalid, bready, arvalid, rready : in std_ulogic;
    awaddr, araddr : in  std_ulogic_vector(7 downto 0);
    wdata          : in  std_ulogic_vector(31 downto 0);
    axi_lite_s2m   : out axi_lite_s2m_t;
    cyc, stb, we   : out std_ulogic;
    adr            : out std_ulogic_vector(5 downto 0);
    dat            : out std_ulogic_vector(31 downto 0);
    wishbone_s2m   : in  wishbone_s2m_t
  );
end entity;

architecture rtl of narrow_axi_lite_slave is
  signal m2s  : axi_lite_m2s_t;
  signal wide : wishbone_m2s_t;
begin
  m2s <= (
    awvalid => awvalid, awaddr => x"000000" & awaddr, awprot => "000", wvalid => wvalid, wdata => wdata,
    wstrb => "1111", bready => bready, arvalid => arvalid, araddr => x"000000" & araddr, arprot => "000",
    rready => rready);
  cyc <= wide.cyc;
  stb <= wide.stb;
  we  <= wide.we;
  adr <= wide.adr(5 downto 0);
  dat <= wide.dat;

  whole : entity unitylink.axi_lite_slave
    port map (
      clock => clock, reset => reset, axi_lite_m2s => m2s, axi_lite_s2m => axi_lite_s2m, wishbone_m2s => wide,
      wishbone_s2m => wishbone_s2m);
end architecture;
