-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pins of sigma_delta_adc, for benches: a modulator of second order. `level` is its input over
-- the full scale, -1 to 1. It checks that mclk is within what an AMC1306 takes.
--
--   fault  0 none, 1 the line is low, 2 it is high

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;

entity sigma_delta_adc_model is
  port (
    mclk  : in  std_ulogic;
    level : in  real;
    fault : in  natural;
    data  : out std_ulogic
  );
end entity;

architecture behaviour of sigma_delta_adc_model is
begin

  play : process is
    variable first, second, back : real := 0.0;
    variable since : time := 0 ns;
  begin
    data <= '0';
    loop
      wait until rising_edge(mclk);
      check(since = 0 ns or (now - since >= 47 ns and now - since <= 200 ns), "mclk is from 5 to 21 MHz");
      since  := now;
      back   := 1.0 when second >= 0.0 else -1.0;
      first  := first + 0.5 * (level - back);
      second := second + 0.5 * (first - back);
      case fault is
        when 1 => data <= '0' after 10 ns;
        when 2 => data <= '1' after 10 ns;
        when others =>
          if back > 0.0 then
            data <= '1' after 10 ns;
          else
            data <= '0' after 10 ns;
          end if;
      end case;
    end loop;
  end process;

end architecture;
