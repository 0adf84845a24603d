-- SPDX-License-Identifier: BSD-3-Clause
--
-- Brings external pins into a clock domain: a synchroniser against metastability, and a filter. A new level counts only
-- when it has been stable for `stable_clocks` clocks.
--
-- Latency   2 + stable_clocks clocks.
-- Reset     Takes the levels of the pins at that time, so that the reset makes no edge.

library ieee;
  use ieee.std_logic_1164.all;

entity input_filter is
  generic (
    width         : positive := 1;
    stable_clocks : positive := 1 -- 1: no filter
  );
  port (
    clock  : in  std_ulogic;
    reset  : in  std_ulogic;
    pins   : in  std_ulogic_vector(width - 1 downto 0); -- asynchronous
    levels : out std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture rtl of input_filter is

  type counts_t is array (0 to width - 1) of natural range 0 to stable_clocks - 1;

  signal settled : std_ulogic_vector(width - 1 downto 0); -- pins, synchronous
  signal counts  : counts_t;                              -- clocks for which a pin has differed from its level

begin

  pin_synchroniser : entity work.synchroniser
    generic map (width => width)
    port map (clock => clock, asynchronous => pins, levels => settled);

  process (clock) is
  begin
    if rising_edge(clock) then
      for pin in 0 to width - 1 loop
        if settled(pin) = levels(pin) then
          counts(pin) <= 0;
        elsif counts(pin) = stable_clocks - 1 then
          levels(pin) <= settled(pin);
          counts(pin) <= 0;
        else
          counts(pin) <= counts(pin) + 1;
        end if;
        if reset = '1' or stable_clocks = 1 then
          levels(pin) <= settled(pin);
          counts(pin) <= 0;
        end if;
      end loop;
    end if;
  end process;

end architecture;
