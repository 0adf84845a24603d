-- SPDX-License-Identifier: BSD-3-Clause
-- pid as it is in a design whose feedback is a wire, and whose target is a register.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.wire_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_pid is
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic;
    wishbone_m2s  : in  wishbone_m2s_t;
    wishbone_s2m  : out wishbone_s2m_t;
    tripped       : out std_ulogic;
    feedback_wire : in  wire_t;
    output_wire   : out wire_t
  );
end entity;

architecture rtl of narrow_pid is
begin
  whole : entity unitylink.pid
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, tripped => tripped,
      feedback_wire => feedback_wire, output_wire => output_wire);
end architecture;
