-- SPDX-License-Identifier: BSD-3-Clause
--
-- The pins STEP and DIR of one axis. It makes one pulse for each step that it takes, and keeps all times of the driver.
--
--   step       ____/‾‾‾‾‾‾‾\_____________________________/‾‾‾‾‾‾‾\____
--   direction  ‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\__________________________
--                  |-length-|-space-|-hold--|-setup--|
--
-- Ports     ask: a step is wanted in this clock, in the direction `down`. taken: it will be made, and STEP rises with
--           the next clock. A step that is not taken must be asked for again. An untaken step in the other direction
--           begins the turn of DIR. direction is high for up.
--           late: it is not taken because the pulse before has not ended.
-- Latency   One clock from ask to STEP. A turn takes hold + setup clocks after the space.
-- Errors    None: too fast a request is not taken.
-- Reset     STEP falls at once. DIR keeps its level until the next turn, unless it had none: up.

library ieee;
  use ieee.std_logic_1164.all;

entity stepgen_pulse is
  generic (
    length_clocks : positive := 10;
    space_clocks  : positive := 10;
    setup_clocks  : positive := 10;
    hold_clocks   : positive := 10
  );
  port (
    clock     : in  std_ulogic;
    reset     : in  std_ulogic;
    ask       : in  std_ulogic;
    down      : in  std_ulogic;
    taken     : out std_ulogic;
    late      : out std_ulogic;
    step      : out std_ulogic := '0';
    direction : out std_ulogic := '1'
  );
end entity;

architecture rtl of stepgen_pulse is

  constant longest : positive := maximum(maximum(length_clocks, space_clocks), maximum(setup_clocks, hold_clocks));

  type state_t is (resting, holding, setting); -- what STEP waits for while it is low

  signal state : state_t := resting;
  signal timer : natural range 0 to longest - 1 := 0;
  signal ready : std_ulogic;

begin

  ready <= '1' when timer = 0 and step = '0' and state /= holding else '0';
  taken <= '1' when ask = '1' and ready = '1' and down /= direction else '0';
  late  <= '1' when ask = '1' and ready = '0' and state = resting and down /= direction else '0';

  process (clock) is
  begin
    if rising_edge(clock) then
      if timer > 0 then
        timer <= timer - 1;
      elsif step = '1' then
        step  <= '0';
        timer <= space_clocks - 1;
      elsif state = holding then
        direction <= not direction;
        timer     <= setup_clocks - 1;
        state     <= setting;
      elsif taken = '1' then
        step  <= '1';
        timer <= length_clocks - 1;
        state <= resting;
      elsif ask = '1' then
        timer <= hold_clocks - 1;
        state <= holding;
      end if;

      if reset = '1' then
        step  <= '0';
        timer <= longest - 1;
        state <= resting;
      end if;
    end if;
  end process;

end architecture;
