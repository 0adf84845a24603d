-- SPDX-License-Identifier: BSD-3-Clause
-- three_phase_pwm without wires: the PC writes its duties.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_three_phase_pwm is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sample       : out std_ulogic;
    tripped      : out std_ulogic;
    fault        : in  std_ulogic;
    high         : out std_ulogic_vector(2 downto 0);
    low          : out std_ulogic_vector(2 downto 0)
  );
end entity;

architecture rtl of narrow_three_phase_pwm is
begin
  whole : entity unitylink.three_phase_pwm
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, sample => sample,
      tripped => tripped, fault => fault, high => high, low => low);
end architecture;
