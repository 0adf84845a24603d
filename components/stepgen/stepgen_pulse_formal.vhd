-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the pins STEP and DIR of one axis: 3 clocks high, 2 clocks low, DIR 4 clocks before a rise and 2 clocks
-- after a fall. Steps may be asked for at any clock, in any direction.

library ieee;
  use ieee.std_logic_1164.all;

entity stepgen_pulse_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    ask   : in std_ulogic;
    down  : in std_ulogic
  );
end entity;

architecture properties of stepgen_pulse_formal is

  constant length_clocks : positive := 3;
  constant space_clocks  : positive := 2;
  constant setup_clocks  : positive := 4;
  constant hold_clocks   : positive := 2;
  constant most          : positive := 8;

  signal taken, late, step, direction : std_ulogic;
  signal begun            : std_ulogic := '0';
  signal step_before      : std_ulogic := '0';
  signal direction_before : std_ulogic := '1';
  signal taken_before     : std_ulogic := '0';
  signal reset_before     : std_ulogic := '0';
  signal down_before      : std_ulogic := '0';
  signal high, low, stays : natural range 0 to most := most; -- clocks of this level, before this clock

begin

  default clock is rising_edge(clk);

  dut : entity work.stepgen_pulse
    generic map (
      length_clocks => length_clocks, space_clocks => space_clocks, setup_clocks => setup_clocks,
      hold_clocks => hold_clocks)
    port map (
      clock => clk, reset => reset, ask => ask, down => down, taken => taken, late => late, step => step,
      direction => direction);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun            <= '1';
      step_before      <= step;
      direction_before <= direction;
      taken_before     <= taken and not reset;
      down_before      <= down;
      reset_before     <= reset;
      if step = '1' then
        low <= 0;
        if high < most then
          high <= high + 1;
        end if;
      else
        high <= 0;
        if low < most then
          low <= low + 1;
        end if;
      end if;
      if direction /= direction_before then
        stays <= 1;
      elsif stays < most then
        stays <= stays + 1;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A step that was taken is a rise of STEP in the next clock.
  taken_is_a_rise : assert always begun = '1' and taken_before = '1' -> step = '1' and step_before = '0';

  -- There is no rise of STEP without a step that was taken.
  rise_is_taken : assert always begun = '1' and step = '1' and step_before = '0' -> taken_before = '1';

  -- The level of DIR at a rise is the direction that was asked for.
  rise_goes_right : assert always begun = '1' and step = '1' and step_before = '0' -> direction = not down_before;

  -- STEP is high long enough, unless a reset ends it.
  long_enough : assert always begun = '1' and step = '0' and step_before = '1' and reset_before = '0' ->
                high >= length_clocks;

  -- STEP is low long enough.
  space_enough : assert always begun = '1' and step = '1' and step_before = '0' -> low >= space_clocks;

  -- DIR is stable for the set-up time when STEP rises.
  set_up : assert always begun = '1' and step = '1' and step_before = '0' -> stays >= setup_clocks;

  -- DIR does not change while STEP is high, nor within the space and the hold time after its fall.
  held : assert always begun = '1' and direction /= direction_before -> low >= space_clocks + hold_clocks;

  -- A step that is late is not taken.
  late_is_not_taken : assert always late = '1' -> taken = '0';

  -- There is a step up after a step down.
  turn_seen : cover {begun = '1' and taken_before = '1' and direction = '1' and stays = setup_clocks + 1};

  -- Two steps follow each other as closely as possible.
  close_seen : cover {begun = '1' and taken_before = '1' and low = space_clocks + 1};

end architecture;
