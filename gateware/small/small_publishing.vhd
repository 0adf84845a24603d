-- SPDX-License-Identifier: BSD-3-Clause
--
-- What publishing needs beside the program of framed_small: the base strobe, and the event inputs.
--
-- While publishing is on, a strobe comes every clock_hz / base_hz clocks, the first one at once. Strobes are counted
-- until the program takes them. An event is kept until the program takes it.
--
-- Ports     events: one line for each group, synchronous to the clock. notes, given: the actions of byte_processor.
--           wants: bit 6 a strobe waits; bit g an event of group g waits. alert: the program must look. While
--           publishing is off, events alert nobody.
--           hold: keep the bus. is_publish: the reply that is being sent is a publish; `sent` ends this.
-- Latency   From an event input or a strobe to `alert`: 2 clocks.
-- Errors    15 strobes may wait. More are lost, and with them the publishes that they are for. The program is not away
--           for so long, unless an access to the bus ends very late.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;
use work.small_instruction_pkg.all;
use work.small_program_pkg.all;
use work.width_pkg.all;

entity small_publishing is
  generic (
    clock_hz    : positive := limits_clock_hz_default_c;
    base_hz     : positive := limits_base_hz_default_c;
    groups      : positive range 1 to small_groups_max := 2;
    edge_events : std_ulogic_vector(255 downto 0) := (others => '0')  -- bit g: the event of group g is an edge
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic;
    events     : in  std_ulogic_vector(groups - 1 downto 0);
    notes      : in  small_actions_t;
    given      : in  byte_t;
    sent       : in  std_ulogic;
    wants      : out std_ulogic_vector(6 downto 0);
    alert      : out std_ulogic := '0';
    hold       : out std_ulogic := '0';
    is_publish : out std_ulogic := '0'
  );
end entity;

architecture rtl of small_publishing is

  constant period : positive := maximum(1, clock_hz / base_hz);

  subtype flags_t is std_ulogic_vector(groups - 1 downto 0);

  signal publishing : std_ulogic := '0';
  -- Clocks until the next strobe, less two. Its highest bit says that they are over.
  signal divider    : unsigned(bits_for(period) downto 0) := (others => '1');
  signal strobe     : std_ulogic;
  signal strobes    : unsigned(3 downto 0) := (others => '0');  -- that wait
  signal enabled    : flags_t := (others => '0');  -- groups whose events count
  signal past       : flags_t := (others => '0');  -- the event inputs one clock ago
  signal waiting    : flags_t := (others => '0');  -- events
  signal due        : std_ulogic := '0';           -- the program has something to publish

begin

  assert period >= 3 report "small_publishing: at least 3 clocks must lie between two strobes; lower base_hz"
    severity failure;

  wants <= (or strobes) & std_ulogic_vector(resize(unsigned(waiting), 6));

  strobe <= publishing and divider(divider'left);

  divide : process (clock)
  begin
    if rising_edge(clock) then
      if publishing = '0' then
        divider <= (others => '1');
      elsif strobe = '1' then
        divider <= to_unsigned(period - 2, divider'length);
      else
        divider <= divider - 1;
      end if;
      if strobe = '1' and notes(note_strobe_taken) = '0' and nand strobes = '1' then
        strobes <= strobes + 1;
      elsif strobe = '0' and notes(note_strobe_taken) = '1' then
        strobes <= strobes - 1;
      end if;
      if notes(note_publishing) = '1' then
        publishing <= given(0);
      end if;
      if reset = '1' then
        publishing <= '0';
      end if;
      if publishing = '0' or reset = '1' then
        strobes <= (others => '0');
      end if;
    end if;
  end process;

  notice : process (clock)
  begin
    if rising_edge(clock) then
      past  <= events;
      alert <= or strobes or (publishing and (due or (or waiting)));
      if notes(note_enabled) = '1' then
        enabled <= given(groups - 1 downto 0);
      end if;
      if notes(note_due) = '1' then
        due <= or given;
      end if;
      for g in 0 to groups - 1 loop
        if notes(note_events_taken) = '1' and given(g) = '1' then
          waiting(g) <= '0';
        end if;
        if enabled(g) = '1' and events(g) = '1' and (past(g) = '0' or edge_events(g) = '0') then
          waiting(g) <= '1';
        end if;
      end loop;
      if reset = '1' then
        enabled <= (others => '0');
        past    <= (others => '0');
        waiting <= (others => '0');
        due     <= '0';
      end if;
    end if;
  end process;

  mark : process (clock)
  begin
    if rising_edge(clock) then
      if notes(note_hold) = '1' then
        hold <= given(0);
      end if;
      if notes(note_publish) = '1' then
        is_publish <= '1';
      elsif sent = '1' then
        is_publish <= '0';
      end if;
      if reset = '1' then
        hold       <= '0';
        is_publish <= '0';
      end if;
    end if;
  end process;

end architecture;
