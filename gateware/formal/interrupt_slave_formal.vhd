-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the interrupt slave with two lines. A reference follows the events, and the writes that were
-- acknowledged.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity interrupt_slave_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    m2s    : in wishbone_m2s_t;
    events : in std_ulogic_vector(1 downto 0)
  );
end entity;

architecture properties of interrupt_slave_formal is

  subtype lines_t is std_ulogic_vector(1 downto 0);

  signal s2m       : wishbone_s2m_t;
  signal interrupt : std_ulogic;
  signal begun     : std_ulogic := '0';
  signal asked     : std_ulogic := '0';
  signal answered  : std_ulogic;
  signal whole     : std_ulogic;                       -- a write, if it is one, is of a whole word
  signal clears    : lines_t;                          -- bits that are cleared in this clock
  signal enable    : lines_t;
  signal enabled   : lines_t := "00";
  signal pending   : lines_t := "00";
  signal was       : lines_t := "00";                  -- pending in the clock before
  signal due       : std_ulogic := '0';                -- the interrupt of this clock

begin

  default clock is rising_edge(clk);

  dut : entity work.interrupt_slave
    generic map (lines => 2)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, events => events,
      interrupt => interrupt);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered <= s2m.ack or s2m.err;
  whole    <= '1' when m2s.we = '0' or m2s.sel = "1111" else '0';
  clears   <= m2s.dat(1 downto 0) when s2m.ack = '1' and m2s.we = '1' and unsigned(m2s.adr) = 0 else "00";
  enable   <= m2s.dat(1 downto 0) when s2m.ack = '1' and m2s.we = '1' and unsigned(m2s.adr) = 1 else enabled;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun   <= '1';
      asked   <= m2s.stb and not answered and not reset;
      pending <= (pending and not clears) or events;
      was     <= pending;
      enabled <= enable;
      due     <= or (pending and enable);
      if reset = '1' then
        pending <= "00";
        enabled <= "00";
        due     <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access during power-up.
  quiet_first : assume always begun = '1' or m2s.stb = '0';

  -- The master waits for the answer to each access.
  patient : assume always m2s.stb = '1' and answered = '0' and reset = '0' -> next (m2s.stb = '1');

  -- A read of +0 gives the events that came since they were cleared. An event in the clock of its clear is not lost.
  events_kept : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= 0 or
                s2m.dat = 30x"0" & was;

  -- A read of +1 gives what was written to it.
  enable_kept : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= 1 or
                s2m.dat = 30x"0" & enabled;

  -- The interrupt is high exactly if a bit was pending and enabled in the clock before.
  interrupt_of_these : assert always begun = '0' or interrupt = due;

  -- Words beyond +1 are refused, and so are writes of a part of a word.
  refused : assert always s2m.ack = '1' -> unsigned(m2s.adr) < 2 and whole = '1';

  -- Nothing else is refused.
  only_these_refused : assert always s2m.err = '1' -> unsigned(m2s.adr) >= 2 or whole = '0';

  -- An access takes two clocks.
  two_clocks : assert always asked = '0' or m2s.stb = '0' or answered = '1';

  -- An event comes in the clock in which its bit is cleared.
  event_at_its_clear : cover {begun = '1' and clears(0) = '1' and pending(0) = '1' and events(0) = '1'};

end architecture;
