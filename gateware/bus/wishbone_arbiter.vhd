-- SPDX-License-Identifier: BSD-3-Clause
--
-- Many Wishbone masters and one slave, or one interconnect: the masters take turns.
--
--   masters_m2s(0) -->|
--   masters_m2s(1) -->| one at a time, from cyc to cyc --> slave_m2s
--   masters_m2s(2) -->|
--
-- Turn      A master has the bus from the clock in which its cyc rises, if the bus is free, until its cyc falls. So a
--           block of accesses stays indivisible. Then it is the turn of the next one that waits, in the order of their
--           numbers, and behind the last comes the first. So a master waits for at most one turn of each other.
-- Latency   None: a master that finds the bus free has it in the same clock. Between two turns cyc is low for a clock,
--           because slaves that keep one moment, or that wait, must see that a block is over.
-- Errors    None of its own. A master that never lowers cyc keeps the bus: wishbone_master and axi_lite_slave have a
--           timeout.
-- Pressure  A master that waits has no answer.
-- Reset     The bus is free, and the first turn is that of master 0. Reset the masters too.

library ieee;
  use ieee.std_logic_1164.all;
  use work.wishbone_pkg.all;

entity wishbone_arbiter is
  generic (
    masters : positive := 2
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic; -- synchronous
    masters_m2s : in  wishbone_m2s_vector_t(0 to masters - 1);
    masters_s2m : out wishbone_s2m_vector_t(0 to masters - 1);
    slave_m2s   : out wishbone_m2s_t;
    slave_s2m   : in  wishbone_s2m_t
  );
end entity;

architecture rtl of wishbone_arbiter is

  signal last  : natural range 0 to masters - 1 := masters - 1; -- the one that has the bus, or had it
  signal taken : std_ulogic := '0';                             -- … has it
  signal now   : natural range 0 to masters - 1;                -- in this clock

begin

  choose : process (all) is
    variable candidate : natural range 0 to masters - 1;
    variable found     : boolean;
  begin
    now       <= last;
    candidate := last;
    found     := taken = '1'; -- also in the clock in which its cyc is low: the slave sees that the block is over
    for step in 1 to masters loop
      if candidate = masters - 1 then
        candidate := 0;
      else
        candidate := candidate + 1;
      end if;
      if not found and masters_m2s(candidate).cyc = '1' then
        now   <= candidate;
        found := true;
      end if;
    end loop;
  end process;

  connect : process (all) is
  begin
    slave_m2s <= masters_m2s(now);
    for master in 0 to masters - 1 loop
      masters_s2m(master)     <= slave_s2m;
      masters_s2m(master).ack <= '0';
      masters_s2m(master).err <= '0';
      if now = master then
        masters_s2m(master) <= slave_s2m;
      end if;
    end loop;
  end process;

  process (clock) is
  begin
    if rising_edge(clock) then
      last  <= now;
      taken <= masters_m2s(now).cyc;
      if reset = '1' then
        last  <= masters - 1;
        taken <= '0';
      end if;
    end if;
  end process;

end architecture;
