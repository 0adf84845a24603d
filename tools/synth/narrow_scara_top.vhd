-- SPDX-License-Identifier: BSD-3-Clause
-- scara_top with the pins that a board has. In place of the joints, each reports the set-points that it gets.

library ieee;
  use ieee.std_logic_1164.all;
use work.scara_user_pkg.all;

entity narrow_scara_top is
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic;
    rx_line : in  std_ulogic;
    tx_line : out std_ulogic
  );
end entity;

architecture rtl of narrow_scara_top is
  signal to_pc   : scara_to_pc_t;
  signal from_pc : scara_from_pc_t;
begin
  to_pc.j1.cpos <= from_pc.j1.pos_sp;
  to_pc.j1.spd  <= from_pc.j1.spd_sp;
  to_pc.j2.cpos <= from_pc.j2.pos_sp;
  to_pc.j2.spd  <= from_pc.j2.spd_sp;
  to_pc.j3.cpos <= from_pc.j3.pos_sp;
  to_pc.j3.spd  <= from_pc.j3.spd_sp;
  to_pc.j4.cpos <= from_pc.j4.pos_sp;
  to_pc.j4.spd  <= from_pc.j4.spd_sp;

  whole : entity work.scara_top
    port map (
      clock => clock, reset => reset, rx_line => rx_line, tx_line => tx_line, user_reset => open, to_pc => to_pc,
      from_pc => from_pc, written => open);
end architecture;
