-- SPDX-License-Identifier: BSD-3-Clause
--
-- A multiplier that adds and shifts: 18 by 18 bits with a sign, a bit in each clock. It needs none of the chip's.
--
-- Latency   done is high for one clock, 18 clocks after start. product stands until the next start.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity foc_multiplier is
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    start   : in  std_ulogic;
    left    : in  signed(17 downto 0);
    right   : in  signed(17 downto 0);
    product : out signed(35 downto 0);
    done    : out std_ulogic
  );
end entity;

architecture rtl of foc_multiplier is

  signal factor : signed(17 downto 0) := (others => '0');
  signal high   : signed(17 downto 0) := (others => '0');
  signal low    : std_ulogic_vector(17 downto 0) := (others => '0'); -- of the product, and what is left of `right`
  signal count  : natural range 0 to 18 := 0;

begin

  product <= high & signed(low);

  process (clock) is
    variable sum : signed(18 downto 0);
  begin
    if rising_edge(clock) then
      done <= '0';
      if start = '1' then
        factor <= left;
        high   <= (others => '0');
        low    <= std_ulogic_vector(right);
        count  <= 18;
      elsif count /= 0 then
        sum := resize(high, 19);
        if low(0) = '1' then
          if count = 1 then -- the bit of the sign
            sum := sum - factor;
          else
            sum := sum + factor;
          end if;
        end if;
        high  <= sum(18 downto 1);
        low   <= sum(0) & low(17 downto 1);
        count <= count - 1;
        if count = 1 then
          done <= '1';
        end if;
      end if;
      if reset = '1' then
        count <= 0;
        done  <= '0';
      end if;
    end if;
  end process;

end architecture;
