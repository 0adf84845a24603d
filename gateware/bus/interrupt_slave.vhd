-- SPDX-License-Identifier: BSD-3-Clause
--
-- Events of the gateware become an interrupt of a processor: of an SoC, or of a PCIe core.
--
--   +0  pending: the events so far     write: clears the bits that are 1
--   +1  enable: a 1 lets the event interrupt
--
-- Event     A line sets its bit in each clock in which it is high, also in the clock in which that bit is cleared. So
--           no event is lost between a read of +0 and the write of what was read. `changed` of gpio and `arrival` of
--           fifo_slave are such lines.
-- interrupt is high while a bit is pending and enabled: a level, from a register.
-- Latency   2 clocks per access (register_slave). interrupt follows an event 2 clocks later.
-- Errors    err for addresses from 2 on, and for a write of less than a word.
-- Reset     Nothing is pending or enabled.

library ieee;
  use ieee.std_logic_1164.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity interrupt_slave is
  generic (
    lines : positive range 1 to 32 := 8
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    events       : in  std_ulogic_vector(lines - 1 downto 0);
    interrupt    : out std_ulogic := '0'
  );
end entity;

architecture rtl of interrupt_slave is

  subtype lines_t is std_ulogic_vector(lines - 1 downto 0);

  signal read_words, write_words : word_vector_t(0 to 1);
  signal written                 : std_ulogic_vector(0 to 1);
  signal pending                 : lines_t := (others => '0');

begin

  registers : entity work.register_slave
    generic map (writable => "11")
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  read_words <= (extended(pending), extended(write_words(1)(lines_t'range)));

  process (clock) is
    variable kept : lines_t;
  begin
    if rising_edge(clock) then
      kept := pending;
      if written(0) = '1' then
        kept := pending and not write_words(0)(lines_t'range);
      end if;
      pending   <= kept or events;
      interrupt <= or (pending and write_words(1)(lines_t'range));
      if reset = '1' then
        pending   <= (others => '0');
        interrupt <= '0';
      end if;
    end if;
  end process;

end architecture;
