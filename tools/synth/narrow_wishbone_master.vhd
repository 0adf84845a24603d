-- SPDX-License-Identifier: BSD-3-Clause
-- wishbone_master with as many pins as a chip has: addresses of 8 bits, whole words only.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.bii_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_wishbone_master is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    valid, write, block_hold : in std_ulogic;
    address      : in  std_ulogic_vector(7 downto 0);
    data         : in  std_ulogic_vector(31 downto 0);
    bii_response : out bii_response_t;
    cyc, stb, we : out std_ulogic;
    adr          : out std_ulogic_vector(7 downto 0);
    dat          : out std_ulogic_vector(31 downto 0);
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of narrow_wishbone_master is
  signal request : bii_request_t;
  signal wide    : wishbone_m2s_t;
begin
  request <= (valid => valid, write => write, address => x"000000" & address, data => data, block_hold => block_hold);
  cyc     <= wide.cyc;
  stb     <= wide.stb;
  we      <= wide.we;
  adr     <= wide.adr(7 downto 0);
  dat     <= wide.dat;

  whole : entity unitylink.wishbone_master
    port map (
      clock => clock, reset => reset, bii_request => request, bii_response => bii_response, wishbone_m2s => wide,
      wishbone_s2m => wishbone_s2m);
end architecture;
