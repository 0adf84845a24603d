-- SPDX-License-Identifier: BSD-3-Clause
-- sigma_delta_adc as a current loop uses it: the wires of both values are read, and only their 16 low bits and that
-- they are valid.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wire_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_sigma_delta_adc is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    tripped      : out std_ulogic;
    value_0      : out std_ulogic_vector(15 downto 0);
    value_1      : out std_ulogic_vector(15 downto 0);
    valid        : out std_ulogic_vector(1 downto 0);
    mclk         : out std_ulogic;
    trip         : out std_ulogic;
    data         : in  std_ulogic_vector(1 downto 0)
  );
end entity;

architecture rtl of narrow_sigma_delta_adc is
  signal value_0_wire, value_1_wire : wire_t;
begin
  value_0 <= std_ulogic_vector(value_of(value_0_wire)(15 downto 0));
  value_1 <= std_ulogic_vector(value_of(value_1_wire)(15 downto 0));
  valid   <= is_valid(value_1_wire) & is_valid(value_0_wire);

  whole : entity unitylink.sigma_delta_adc
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      sampled => sampled, tripped => tripped, value_0_wire => value_0_wire, value_1_wire => value_1_wire,
      value_2_wire => open, mclk => mclk, trip => trip, data => data);
end architecture;
