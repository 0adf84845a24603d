-- SPDX-License-Identifier: BSD-3-Clause
--
-- Wishbone as a master sees it. The duties of the master are asserted, and those of a slave are assumed. The mirror
-- image is wishbone_slave_view. Each end of a Wishbone in the gateware is proven with one of the two, so they fit
-- together.

library ieee;
  use ieee.std_logic_1164.all;
  use work.wishbone_pkg.all;

entity wishbone_master_view is
  port (
    late_answers : in std_ulogic := '0';  -- slaves may answer after a timeout; wishbone_master allows this
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

  -- An access stays the same until its answer, or until the cycle ends.
  access_stands : assert always m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and reset = '0' ->
                  next (m2s.cyc = '0' or (m2s.stb = '1' and m2s.we = prev(m2s.we) and m2s.adr = prev(m2s.adr) and
                                          m2s.sel = prev(m2s.sel) and (m2s.we = '0' or m2s.dat = prev(m2s.dat))));

  -- A slave gives one answer: it does not accept and refuse at once.
  one_answer : assume always s2m.ack = '0' or s2m.err = '0';

  -- A slave answers only an access.
  when_asked : assume always late_answers = '1' or (s2m.ack = '0' and s2m.err = '0') or
               (m2s.cyc = '1' and m2s.stb = '1');

end architecture;
