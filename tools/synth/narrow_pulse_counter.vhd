-- SPDX-License-Identifier: BSD-3-Clause
-- pulse_counter as it is in a design without wires: nothing reads them.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wishbone_pkg.all;

entity narrow_pulse_counter is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    counted      : out std_ulogic;
    stopped      : out std_ulogic;
    line         : in  std_ulogic
  );
end entity;

architecture rtl of narrow_pulse_counter is
begin
  whole : entity unitylink.pulse_counter
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, counted => counted,
      stopped => stopped, count_wire => open, frequency_wire => open, line => line, gate => '1');
end architecture;
