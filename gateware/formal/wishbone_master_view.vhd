-- SPDX-License-Identifier: BSD-3-Clause
--
-- Wishbone as a master sees it: what it owes is asserted, what it may expect of a slave is assumed. The mirror image is
-- wishbone_slave_view; whatever has this bus is proven with one of them at each of its ends, and so fits every other.

library ieee;
  use ieee.std_logic_1164.all;
  use work.wishbone_pkg.all;

entity wishbone_master_view is
  port (
    late_answers : in std_ulogic := '0';  -- slaves may answer after the access was given up; wishbone_master bears it
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    s2m   : in wishbone_s2m_t
  );
end entity;

architecture properties of wishbone_master_view is
begin

  default clock is rising_edge(clk);

  -- A strobe comes within a bus cycle.
  strobe_in_cycle : assert always m2s.stb = '0' or m2s.cyc = '1';

  -- An access stands with all that belongs to it until its answer, or the cycle ends.
  access_stands : assert always m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and reset = '0' ->
                  next (m2s.cyc = '0' or (m2s.stb = '1' and m2s.we = prev(m2s.we) and m2s.adr = prev(m2s.adr) and
                                          m2s.sel = prev(m2s.sel) and (m2s.we = '0' or m2s.dat = prev(m2s.dat))));

  -- A slave answers once: it does not accept and refuse.
  one_answer : assume always s2m.ack = '0' or s2m.err = '0';

  -- A slave answers only when it is asked.
  when_asked : assume always late_answers = '1' or (s2m.ack = '0' and s2m.err = '0') or (m2s.cyc = '1' and m2s.stb = '1');

end architecture;
