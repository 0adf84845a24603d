-- SPDX-License-Identifier: BSD-3-Clause
--
-- Checks that a slave keeps the rules of wishbone_pkg: it answers only when asked, never twice at once, and never with
-- undefined values.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_monitor is
  port (
    clock        : in std_ulogic;
    reset        : in std_ulogic;
    wishbone_m2s : in wishbone_m2s_t;
    wishbone_s2m : in wishbone_s2m_t
  );
end entity;

architecture test of wishbone_monitor is

begin

  process (clock) is
  begin
    if rising_edge(clock) and reset = '0' then
      check(not is_x(wishbone_s2m.ack & wishbone_s2m.err), "ack or err is undefined");
      check((wishbone_s2m.ack and wishbone_s2m.err) = '0', "ack and err at once");
      check((wishbone_s2m.ack or wishbone_s2m.err) = '0' or (wishbone_m2s.cyc and wishbone_m2s.stb) = '1',
            "an answer nobody asked for");
      check(wishbone_s2m.ack = '0' or wishbone_m2s.we = '1' or not is_x(wishbone_s2m.dat),
            "an undefined word was read");
    end if;
  end process;

end architecture;
