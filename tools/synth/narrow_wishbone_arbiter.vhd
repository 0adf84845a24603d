-- SPDX-License-Identifier: BSD-3-Clause
-- wishbone_arbiter for two masters with as many pins as a chip has: addresses of 8 bits, whole words only. Both masters
-- have the same pins for the word that they write, inverted for the second one.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_wishbone_arbiter is
  port (
    clock          : in  std_ulogic;
    reset          : in  std_ulogic;
    cycs, stbs, wes : in std_ulogic_vector(0 to 1);
    first_adr, second_adr : in std_ulogic_vector(7 downto 0);
    given          : in  std_ulogic_vector(31 downto 0);
    acks, errs     : out std_ulogic_vector(0 to 1);
    word           : out std_ulogic_vector(31 downto 0);
    cyc, stb, we   : out std_ulogic;
    adr            : out std_ulogic_vector(7 downto 0);
    dat            : out std_ulogic_vector(31 downto 0);
    slave_s2m      : in  wishbone_s2m_t
  );
end entity;

architecture rtl of narrow_wishbone_arbiter is
  signal m2s  : wishbone_m2s_vector_t(0 to 1);
  signal s2m  : wishbone_s2m_vector_t(0 to 1);
  signal wide : wishbone_m2s_t;
begin
  m2s <= (
    0 => (cyc => cycs(0), stb => stbs(0), we => wes(0), adr => x"000000" & first_adr, dat => given, sel => "1111"),
    1 => (
      cyc => cycs(1), stb => stbs(1), we => wes(1), adr => x"000000" & second_adr, dat => not given, sel => "1111"));
  acks <= s2m(0).ack & s2m(1).ack;
  errs <= s2m(0).err & s2m(1).err;
  word <= s2m(0).dat;
  cyc  <= wide.cyc;
  stb  <= wide.stb;
  we   <= wide.we;
  adr  <= wide.adr(7 downto 0);
  dat  <= wide.dat;

  whole : entity unitylink.wishbone_arbiter
    generic map (masters => 2)
    port map (
      clock => clock, reset => reset, masters_m2s => m2s, masters_s2m => s2m, slave_m2s => wide,
      slave_s2m => slave_s2m);
end architecture;
