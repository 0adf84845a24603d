-- SPDX-License-Identifier: BSD-3-Clause
--
-- A sinc3 filter: three sums at the rate of the bits, and three differences at a rate that is osr times lower. A value
-- is a weighted count of the ones among the last 3 * osr bits: 0 to osr**3. The sums wrap, and the differences undo
-- that.
--
-- Latency   fresh is high for one clock, 4 clocks after the take of the last bit of a value. Three values after a reset
--           are not whole.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity sigma_delta_adc_sinc3 is
  generic (
    osr   : positive := 64;
    width : positive := 19 -- of osr**3
  );
  port (
    clock  : in  std_ulogic;
    reset  : in  std_ulogic; -- synchronous
    take   : in  std_ulogic; -- a bit is there
    bit_in : in  std_ulogic;
    value  : out unsigned(width - 1 downto 0);
    fresh  : out std_ulogic
  );
end entity;

architecture rtl of sigma_delta_adc_sinc3 is

  subtype sum_t is unsigned(width - 1 downto 0);
  type sums_t is array (1 to 3) of sum_t;

  signal sums   : sums_t := (others => (others => '0'));
  signal before : sums_t := (others => (others => '0')); -- of the last value
  signal left   : natural range 0 to osr - 1 := osr - 1; -- bits to come for this value
  signal steps  : std_ulogic_vector(1 to 3) := "000";

begin

  process (clock) is
  begin
    if rising_edge(clock) then
      fresh <= steps(3);
      steps <= '0' & steps(1 to 2);
      if take = '1' then
        sums(1) <= sums(1) + bit_in;
        sums(2) <= sums(2) + sums(1);
        sums(3) <= sums(3) + sums(2);
        if left = 0 then
          left     <= osr - 1;
          steps(1) <= '1';
        else
          left <= left - 1;
        end if;
      end if;

      if steps(1) = '1' then
        value     <= sums(3) - before(1);
        before(1) <= sums(3);
      end if;
      for number in 2 to 3 loop
        if steps(number) = '1' then
          value          <= value - before(number);
          before(number) <= value;
        end if;
      end loop;

      if reset = '1' then
        sums   <= (others => (others => '0'));
        before <= (others => (others => '0'));
        left   <= osr - 1;
        steps  <= "000";
        value  <= (others => '0');
        fresh  <= '0';
      end if;
    end if;
  end process;

end architecture;
