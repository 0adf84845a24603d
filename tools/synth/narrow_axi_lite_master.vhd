-- SPDX-License-Identifier: BSD-3-Clause
-- axi_lite_master with as many pins as a chip has: addresses of 8 bits, whole words only.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.axi_lite_pkg.all;
  use unitylink.bii_pkg.all;

entity narrow_axi_lite_master is
  port (
    clock          : in  std_ulogic;
    reset          : in  std_ulogic;
    valid, write, block_hold : in std_ulogic;
    address        : in  std_ulogic_vector(7 downto 0);
    data           : in  std_ulogic_vector(31 downto 0);
    bii_response   : out bii_response_t;
    awvalid, wvalid, bready, arvalid, rready : out std_ulogic;
    awaddr, araddr : out std_ulogic_vector(9 downto 0);
    wdata          : out std_ulogic_vector(31 downto 0);
    axi_lite_s2m   : in  axi_lite_s2m_t;
    hold           : out std_ulogic
  );
end entity;

architecture rtl of narrow_axi_lite_master is
  signal request : bii_request_t;
  signal m2s     : axi_lite_m2s_t;
begin
  request <= (valid => valid, write => write, address => x"000000" & address, data => data, block_hold => block_hold);
  awvalid <= m2s.awvalid;
  awaddr  <= m2s.awaddr(9 downto 0);
  wvalid  <= m2s.wvalid;
  wdata   <= m2s.wdata;
  bready  <= m2s.bready;
  arvalid <= m2s.arvalid;
  araddr  <= m2s.araddr(9 downto 0);
  rready  <= m2s.rready;

  whole : entity unitylink.axi_lite_master
    port map (
      clock => clock, reset => reset, bii_request => request, bii_response => bii_response, axi_lite_m2s => m2s,
      axi_lite_s2m => axi_lite_s2m, hold => hold);
end architecture;
