-- SPDX-License-Identifier: BSD-3-Clause
--
-- A stepper driver behind stepgen, for benches. It counts steps, and checks the times that a driver's datasheet
-- demands.
--
-- Ports     step, direction: the pins. position: rising edges of step, with their sign. edge: it has just changed.
-- Errors    An assertion fails if step is high for less than step_len, or low for less than step_space. It also fails
--           if direction changes less than dir_setup before a rise, while step is high, or less than dir_hold after a
--           fall.

library ieee;
  use ieee.std_logic_1164.all;

entity stepgen_driver_model is
  generic (
    step_len   : time;
    step_space : time;
    dir_setup  : time;
    dir_hold   : time
  );
  port (
    step      : in  std_ulogic;
    direction : in  std_ulogic; -- high is up
    position  : out integer := 0
  );
end entity;

architecture simulation of stepgen_driver_model is
begin

  process is
    variable rose, fell, turned : time := -1 sec;
    variable count : integer := 0;
  begin
    wait on step, direction;
    if direction'event then
      assert step = '0' and not rising_edge(step)
        report "direction changed while step is high" severity error;
      assert now - fell >= dir_hold
        report "direction changed " & time'image(now - fell) & " after step fell" severity error;
      turned := now;
    end if;
    if rising_edge(step) then
      assert now - fell >= step_space
        report "step was low for " & time'image(now - fell) severity error;
      assert now - turned >= dir_setup
        report "step rose " & time'image(now - turned) & " after direction changed" severity error;
      rose := now;
      if direction = '1' then
        count := count + 1;
      else
        count := count - 1;
      end if;
      position <= count;
    elsif falling_edge(step) then
      assert now - rose >= step_len
        report "step was high for " & time'image(now - rose) severity error;
      fell := now;
    end if;
  end process;

end architecture;
