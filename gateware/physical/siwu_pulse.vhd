-- SPDX-License-Identifier: BSD-3-Clause
--
-- The SIWU# pin of an FTDI chip: a pulse after the end of each message that must be sent at once.
--
--   due     ___/‾\_____________/‾\___
--   siwu_n  ‾‾‾‾‾‾\_______/‾‾‾‾‾‾‾‾\___        low for pulse_ns, then high for two clocks at least
--
-- Latency  siwu_n falls one clock after `due`. If a pulse is under way, it falls after this pulse and its gap.
-- Errors   None. A `due` that comes while a pulse waits shares this pulse.

library ieee;
  use ieee.std_logic_1164.all;
  use work.rate_pkg.all;

entity siwu_pulse is
  generic (
    clock_hz : positive := 50_000_000;
    pulse_ns : positive := 250
  );
  port (
    clock  : in  std_ulogic;
    reset  : in  std_ulogic; -- synchronous
    due    : in  std_ulogic; -- one clock
    siwu_n : out std_ulogic := '1'
  );
end entity;

architecture rtl of siwu_pulse is

  constant gap_clocks   : positive := 2;
  constant pulse_clocks : positive := clocks_lasting(pulse_ns, clock_hz);

  signal waits : std_ulogic := '0';
  signal count : natural range 0 to pulse_clocks + gap_clocks - 1 := 0; -- clocks left of the pulse and the gap

begin

  process (clock) is
  begin
    if rising_edge(clock) then
      if count > 0 then
        count <= count - 1;
      end if;
      if count = gap_clocks then
        siwu_n <= '1';
      end if;
      waits <= waits or due;
      if (waits or due) = '1' and count = 0 then
        waits  <= '0';
        siwu_n <= '0';
        count  <= pulse_clocks + gap_clocks - 1;
      end if;
      if reset = '1' then
        waits  <= '0';
        siwu_n <= '1';
        count  <= 0;
      end if;
    end if;
  end process;

end architecture;
