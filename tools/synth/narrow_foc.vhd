-- SPDX-License-Identifier: BSD-3-Clause
-- foc as it is in a design: currents of 18 bits, a position of 14 bits, duties of 13 bits, and a target that is a
-- register.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.wire_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_foc is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    cyc, stb, we : in  std_ulogic;
    adr          : in  std_ulogic_vector(4 downto 0);
    dat          : in  std_ulogic_vector(31 downto 0);
    wishbone_s2m : out wishbone_s2m_t;
    tripped      : out std_ulogic;
    current_a    : in  std_ulogic_vector(17 downto 0);
    current_b    : in  std_ulogic_vector(17 downto 0);
    position     : in  std_ulogic_vector(13 downto 0);
    valid        : in  std_ulogic;
    duty_0       : out std_ulogic_vector(12 downto 0);
    duty_1       : out std_ulogic_vector(12 downto 0);
    duty_2       : out std_ulogic_vector(12 downto 0);
    duties_valid : out std_ulogic
  );
end entity;

architecture rtl of narrow_foc is
  signal wide : wishbone_m2s_t;
  signal a, b, angle, first, second, third : wire_t;
begin
  wide  <= (cyc => cyc, stb => stb, we => we, adr => (31 downto 5 => '0') & adr, dat => dat, sel => (others => '1'));
  a     <= valid & std_ulogic_vector(resize(signed(current_a), 32));
  b     <= valid & std_ulogic_vector(resize(signed(current_b), 32));
  angle <= valid & std_ulogic_vector(resize(unsigned(position), 32));

  whole : entity unitylink.foc
    port map (
      clock => clock, reset => reset, wishbone_m2s => wide, wishbone_s2m => wishbone_s2m, tripped => tripped,
      current_a_wire => a, current_b_wire => b, position_wire => angle,
      duty_0_wire => first, duty_1_wire => second, duty_2_wire => third);

  duty_0       <= first(12 downto 0);
  duty_1       <= second(12 downto 0);
  duty_2       <= third(12 downto 0);
  duties_valid <= first(32);
end architecture;
