-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pins of sonar, for benches: an HC-SR04. It checks the trigger, and answers it.
--
--   length   of the echo; 0 ns: it does not answer
--   spike    before the echo its line is high for so long

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity sonar_sensor_model is
  generic (
    burst_time  : time := 450 us; -- from the trigger to the echo
    cycle_least : time := 60 ms   -- from trigger to trigger
  );
  port (
    trigger  : in  std_ulogic;
    echo     : out std_ulogic := '0';

    length   : in  time;
    spike    : in  time;
    triggers : out natural := 0
  );
end entity;

architecture behaviour of sonar_sensor_model is
begin

  answer : process is
    variable begun : time := -1 sec;
    variable count : natural := 0;
  begin
    wait until rising_edge(trigger);
    check(now - begun >= cycle_least, "a trigger comes too soon, after " & time'image(now - begun));
    check(echo = '0', "a trigger comes while echo is high");
    begun := now;
    count := count + 1;
    wait until falling_edge(trigger);
    check(now - begun >= 10 us, "a trigger is at least 10 us long, not " & time'image(now - begun));
    triggers <= count;
    if length > 0 ns then
      wait for burst_time / 2;
      echo <= '1' when spike > 0 ns else '0';
      wait for spike;
      echo <= '0';
      wait for burst_time / 2;
      echo <= '1';
      wait for length;
      echo <= '0';
    end if;
  end process;

end architecture;
