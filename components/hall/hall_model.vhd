-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pins of hall, for benches: a rotor with three Hall sensors, at `rate` electrical turns a
-- second. Each edge of a line bounces for `bounce`. `angle` is where the rotor is, 0 to 1.
--
--   fault  0 none, 1 all lines are low, 2 all are high

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.math_real.all;

entity hall_model is
  generic (
    period : time := 500 ns; -- of the clock
    bounce : time := 200 ns
  );
  port (
    clock : in  std_ulogic;
    rate  : in  real;
    fault : in  natural;
    lines : out std_ulogic_vector(2 downto 0);
    angle : out real := 0.05
  );
end entity;

architecture behaviour of hall_model is

  signal levels : std_ulogic_vector(2 downto 0);

  function high (angle : real) return std_ulogic is
  begin
    if angle - floor(angle) < 0.5 then
      return '1';
    end if;
    return '0';
  end function;

begin

  turn : process is
    constant step_s : real := real(period / 1 ns) * 1.0e-9;
    variable next_angle : real;
  begin
    levels <= high(angle - 2.0 / 3.0) & high(angle - 1.0 / 3.0) & high(angle);
    wait until rising_edge(clock);
    next_angle := angle + rate * step_s;
    angle <= next_angle - floor(next_angle);
  end process;

  each : for line in 0 to 2 generate
    chatter : process (levels(line), fault) is
    begin
      case fault is
        when 1 => lines(line) <= '0';
        when 2 => lines(line) <= '1';
        when others =>
          lines(line) <= levels(line);
          if levels(line)'event and now > 0 ns then
            lines(line) <= levels(line), not levels(line) after bounce / 2, levels(line) after bounce;
          end if;
      end case;
    end process;
  end generate;

end architecture;
